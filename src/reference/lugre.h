// Bristles of the reference: the friction of LuGre (include/taxelsim/sensor.h), one sample at a time.
#pragma once

#include <array>

#include "taxelsim/sensor.h"

namespace taxelsim::reference {

// Along x and y of a patch.
using Shear = std::array<double, 2>;

struct Bristles {
  Shear bend{0, 0};   // their deflection z, m
  Shear share{0, 0};  // shear traction over pressure
};

// Bristles bent by `bend` after the object has moved by `u` (m) in `dt` (s), the last part `touch` (0 to 1) of it in touch: the exact
// solution for a constant velocity. dt = 0 is a motion so slow that only its way counts.
Bristles moveBristles(const LuGre& law, const Shear& bend, const Shear& u, double touch, double dt);

// g(|v|) of LuGre: the friction of steady sliding at so many m/s but for the viscous part.
double stribeckFriction(const LuGre& law, double speed);

}  // namespace taxelsim::reference
