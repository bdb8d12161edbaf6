// The word for each kind of shape: in names, on the command line and in scenes.
#pragma once

#include <array>
#include <variant>

#include "taxelsim/object.h"

namespace taxelsim {

inline const char* shapeKind(const Shape& shape) {
  constexpr std::array<const char*, std::variant_size_v<Shape>> kWords{"mesh", "sphere",     "cylinder", "capsule",
                                                                       "box",  "half_space", "cone",     "torus"};
  return kWords.at(shape.index());
}

}  // namespace taxelsim
