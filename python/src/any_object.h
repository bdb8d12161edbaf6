// What functions accept as an object: an Object, a shape that becomes one, or the text of parseObject(), a mesh file among others.
#pragma once

#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/variant.h>

#include <concepts>
#include <filesystem>
#include <variant>

#include "taxelsim/object.h"

namespace taxelsim::python {

using AnyObject = std::variant<Object, Mesh, Sphere, Cylinder, Capsule, Box, HalfSpace, Cone, Torus, std::filesystem::path>;

inline Object objectOf(const AnyObject& object) {
  return std::visit(
      []<typename Kind>(const Kind& kind) {
        if constexpr (std::same_as<Kind, std::filesystem::path>) {
          return parseObject(kind.native());
        } else {
          return Object(kind);
        }
      },
      object);
}

}  // namespace taxelsim::python
