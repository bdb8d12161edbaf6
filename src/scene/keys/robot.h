// The keys of robots (scene/keys/block.h).
#pragma once

#include <array>
#include <string_view>

#include "scene/keys/block.h"

namespace taxelsim {

// Components of a twist, as in Manipulator::selection.
inline constexpr std::array<std::string_view, 6> kCoordinateNames{"vx", "vy", "vz", "wx", "wy", "wz"};

const Block& robotKeys();  // a robot in place has the same keys but format_version
const Block& mountKeys();

}  // namespace taxelsim
