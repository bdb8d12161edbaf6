#include "reference/lugre.h"

#include <cmath>

namespace taxelsim::reference {

double stribeckFriction(const LuGre& law, double speed) {
  return law.coulomb_friction + (law.static_friction - law.coulomb_friction) * std::exp(-std::pow(speed / law.stribeck_velocity, 2));
}

Bristles updateBristles(const LuGre& law, const Shear& deflection, const Shear& u, double touch, double dt) {
  const double distance = std::hypot(u[0], u[1]);
  const double speed = dt > 0 ? distance / dt : 0;
  const double g = stribeckFriction(law, speed);
  const double converged = -std::expm1(-law.bristle_stiffness * distance * touch / g);  // fraction of the way to the steady state
  Bristles after;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const double direction = distance > 0 ? u[axis] / distance : 0;
    const double velocity = speed * direction;
    const double to_steady_state = g / law.bristle_stiffness * direction - deflection[axis];
    after.deflection[axis] = deflection[axis] + (distance > 0 ? converged * to_steady_state : 0);
    // z' = v - sigma_0 |v| z / g at the end of the step.
    const double rate = law.bristle_stiffness * speed / g * (1 - converged) * to_steady_state;
    after.traction_ratio[axis] =
        law.bristle_stiffness * after.deflection[axis] + law.bristle_damping * rate + law.viscous_friction * velocity;
  }
  // Not part of LuGre: after a jump of the velocity the damping term alone would violate Coulomb's bound.
  const double size = std::hypot(after.traction_ratio[0], after.traction_ratio[1]);
  if (size > law.static_friction) {
    for (double& component : after.traction_ratio) component *= law.static_friction / size;
  }
  return after;
}

}  // namespace taxelsim::reference
