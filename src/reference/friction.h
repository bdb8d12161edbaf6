// Shear of the reference: a tangential spring at every sample, held by the object that touches it and capped by Coulomb's cone
// (include/taxelsim/sensor.h, Friction). The elastic-perfectly plastic slip that contact mechanics integrates along a path, by the
// backward Euler step known as radial return (J. C. Simo and T. J. R. Hughes, Computational Inelasticity, Springer 1998, section 3.3).
// Of the law lugre the bristles of lugre.h instead.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "reference/depth.h"
#include "reference/lugre.h"
#include "taxelsim/sensor.h"

namespace taxelsim::reference {

inline constexpr int kApart = -1;  // number of the object where nothing touches

// What lasts from one frame to the next. Made by contactShear(); without objects it is the state before the first frame.
struct FrictionState {
  std::vector<PlacedObject> objects{};  // where they were
  std::vector<int> touching{};          // (num_taxels x s x s), number of the object at the sample, or kApart
  std::vector<Shear> held{};            // (num_taxels x s x s): traction, Pa; of the law lugre the bristles' deflection, m
};

struct ContactShear {
  std::vector<Shear> taxel_force;  // (num_taxels), N, on the sensor: an object that moves along +x pushes along +x
  std::array<double, 6> wrench{};  // force (N) and torque (N m) on the sensor at S's origin, in S
  FrictionState state;             // for the next frame
};

// Shear at the penetration d (m) and pressure (Pa) of the samples, (num_taxels x s x s), after the objects have moved from where `before`
// saw them to `objects`. Number n of one list is number n of the other; another object in its place is a new one, which sticks where it
// touches. No friction gives no shear. `dt` (s): how long they took, for the law lugre; 0 is infinitely slow.
ContactShear contactShear(const Sensor& sensor, std::span<const PlacedObject> objects, std::span<const double> d,
                          std::span<const double> pressure, const FrictionState& before, double dt);

}  // namespace taxelsim::reference
