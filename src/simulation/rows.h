// A pose as the device reads it: three rows (R | p).
#pragma once

#include <array>
#include <cstddef>
#include <glm/glm.hpp>

#include "taxelsim/pose.h"

namespace taxelsim {

inline glm::vec4 row(const std::array<double, 9>& rotation, const Vector3& position, std::size_t i) {
  return {static_cast<float>(rotation[3 * i]), static_cast<float>(rotation[3 * i + 1]), static_cast<float>(rotation[3 * i + 2]),
          static_cast<float>(position[i])};
}

}  // namespace taxelsim
