// Keyword of each shape in scenes and on the command line.
#pragma once

#include <array>
#include <variant>

#include "taxelsim/object.h"

namespace taxelsim {

inline const char* shapeKind(const Shape& shape) {
  constexpr std::array<const char*, std::variant_size_v<Shape>> kKeywords{"mesh", "sphere",     "cylinder", "capsule",
                                                                          "box",  "half_space", "cone",     "torus"};
  return kKeywords.at(shape.index());
}

}  // namespace taxelsim
