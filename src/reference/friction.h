// Shear of the reference: a tangential spring at every sample, held by the object that touches it and capped by Coulomb's cone
// (include/taxelsim/sensor.h, Friction). The elastic-perfectly plastic slip that contact mechanics integrates along a path, by the
// backward Euler step known as radial return (J. C. Simo and T. J. R. Hughes, Computational Inelasticity, Springer 1998, section 3.3).
// Of the law lugre the bristles of lugre.h instead.
#pragma once

#include <array>
#include <functional>
#include <span>
#include <vector>

#include "reference/depth.h"
#include "reference/lugre.h"
#include "taxelsim/sensor.h"

namespace taxelsim::reference {

inline constexpr int kNoContact = -1;  // number of the object where nothing touches
inline constexpr int kNoTaxel = -1;    // of a point in the skin's margin

// What lasts from one frame to the next. Made by contactShear(); without objects it is the state before the first frame.
struct FrictionState {
  std::vector<PlacedObject> objects{};  // where they were
  std::vector<int> touching{};          // (points), number of the object there, or kNoContact
  std::vector<Shear> held{};            // (points): traction, Pa; of the law lugre the bristles' deflection, m
};

// The skin under objects, point by point: samples, or the nodes of an elastic layer.
struct PressedSkin {
  std::vector<Sample> points;    // those of a margin with taxel kNoTaxel
  std::vector<int> touching;     // (points), number of the object that touches, or kNoContact
  std::vector<double> d;         // (points), m: penetration, below 0 where skin has bulged to meet the object
  std::vector<double> pressure;  // (points), Pa
};

// The samples, each touched where its d (m) is positive, by the lowest of the objects.
PressedSkin pressedSamples(const Sensor& sensor, std::span<const PlacedObject> objects, std::span<const double> d,
                           std::span<const double> pressure);

// Number of the object whose surface is lowest over each point, of heights as `heightsUnder` tells them; the first of equals, as all are
// that lie deeper than the skin is thick; kNoContact where there is none.
std::vector<int> lowestObjects(std::span<const PlacedObject> objects, double thickness,
                               const std::function<std::vector<double>(std::span<const PlacedObject>)>& heightsUnder);

struct ContactShear {
  std::vector<Shear> taxel_force;  // (num_taxels), N, on the sensor: an object that moves along +x pushes along +x
  std::array<double, 6> wrench{};  // force (N) and torque (N m) on the sensor at S's origin, in S; margin included
  FrictionState state;             // for the next frame
};

// Shear after the objects have moved from where `before` saw them to `objects`. Number n of one list is number n of the other; another
// object in its place is a new one, which sticks where it touches. No friction gives no shear. `dt` (s): how long they took, for the law
// lugre; 0 is infinitely slow.
ContactShear contactShear(const Sensor& sensor, std::span<const PlacedObject> objects, const PressedSkin& skin, const FrictionState& before,
                          double dt);

}  // namespace taxelsim::reference
