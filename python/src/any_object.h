// What functions accept as an object: an Object, or a shape that becomes one.
#pragma once

#include <nanobind/stl/variant.h>

#include <variant>

#include "taxelsim/object.h"

namespace taxelsim::python {

using AnyObject = std::variant<Object, Mesh, Sphere, Cylinder, Capsule, Box, HalfSpace, Cone, Torus>;

inline Object objectOf(const AnyObject& object) {
  return std::visit([](const auto& kind) { return Object(kind); }, object);
}

}  // namespace taxelsim::python
