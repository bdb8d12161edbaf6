#include "reference/lugre.h"

#include <cmath>

namespace taxelsim::reference {

double stribeckFriction(const LuGre& law, double speed) {
  return law.coulomb_friction + (law.static_friction - law.coulomb_friction) * std::exp(-std::pow(speed / law.stribeck_velocity, 2));
}

Bristles moveBristles(const LuGre& law, const Shear& bend, const Shear& u, double touch, double dt) {
  const double way = std::hypot(u[0], u[1]);
  const double speed = dt > 0 ? way / dt : 0;
  const double g = stribeckFriction(law, speed);
  const double gone = -std::expm1(-law.bristle_stiffness * way * touch / g);
  Bristles after;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const double along = way > 0 ? u[axis] / way : 0;
    const double velocity = speed * along;
    const double off = g / law.bristle_stiffness * along - bend[axis];
    after.bend[axis] = bend[axis] + (way > 0 ? gone * off : 0);
    // z' = v - sigma_0 |v| z / g, of what is left of `off`.
    const double rate = law.bristle_stiffness * speed / g * (1 - gone) * off;
    after.share[axis] = law.bristle_stiffness * after.bend[axis] + law.bristle_damping * rate + law.viscous_friction * velocity;
  }
  const double size = std::hypot(after.share[0], after.share[1]);
  if (size > law.static_friction) {
    for (double& component : after.share) component *= law.static_friction / size;
  }
  return after;
}

}  // namespace taxelsim::reference
