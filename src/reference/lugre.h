// LuGre friction at one sample (C. Canudas de Wit, H. Olsson, K. J. Astrom and P. Lischinsky, "A new model for control of systems with
// friction", IEEE Trans. Automatic Control 40(3), 1995; equations in include/taxelsim/sensor.h, LuGre). The bristle deflection z is
// integrated exactly for constant velocity over a step: explicit Euler would need dt < 2 g / (sigma_0 |v|).
#pragma once

#include <array>

#include "taxelsim/sensor.h"

namespace taxelsim::reference {

// Components along x and y of a patch.
using Shear = std::array<double, 2>;

struct Bristles {
  Shear deflection{0, 0};      // z, m
  Shear traction_ratio{0, 0};  // shear traction over pressure
};

// State after the object has slid by u (m) in dt (s), starting from `deflection`. `touch` (0 to 1): fraction of the step, at its end,
// during which the sample was in contact. dt = 0 means infinitely slow sliding. |traction_ratio| <= static_friction.
Bristles updateBristles(const LuGre& law, const Shear& deflection, const Shear& u, double touch, double dt);

// g(|v|): friction coefficient of steady sliding at `speed` (m/s) without the viscous term.
double stribeckFriction(const LuGre& law, double speed);

}  // namespace taxelsim::reference
