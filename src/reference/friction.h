// Shear of the reference: stick-slip friction with memory at every sample.
//
// A tangential spring of stiffness k_t joins each sample to the object that touches it. Its traction q is limited by Coulomb's cone,
// |q| <= mu p: elastic-perfectly plastic slip, integrated by backward Euler with return mapping (J. C. Simo and T. J. R. Hughes,
// Computational Inelasticity, Springer 1998, section 3.3, there called radial return).
//
//      q_y ^
//          |        * trial      1. Trial traction q + k_t u, with u the tangential displacement of the object's material point in this
//        . | .    /                 step (for new contact: its part after touch).
//     .    |   o q'              2. Outside the cone: scaled back to its rim, q' = mu p trial / |trial|.
//    .     +----.---> q_x        3. Loss of contact resets q to 0.
//     .       .
//        ' '  radius mu p        Rate-independent: the result depends on the path, not on dt.
//
// Law `lugre` replaces the spring by the bristles of lugre.h, which depend on velocity.
#pragma once

#include <array>
#include <functional>
#include <span>
#include <vector>

#include "reference/area_depth.h"
#include "reference/depth.h"
#include "reference/lugre.h"
#include "taxelsim/sensor.h"

namespace taxelsim::reference {

inline constexpr int kNoContact = -1;  // object index of a point that nothing touches
inline constexpr int kNoTaxel = -1;    // taxel index of a point in the margin of the skin

// Friction state between frames. contactShear() makes it; a default-constructed state precedes the first frame.
struct FrictionState {
  std::vector<PlacedObject> objects{};  // with the poses of that frame
  std::vector<int> touching{};          // (num_points): index into objects, or kNoContact
  std::vector<Shear> history{};         // (num_points), history variable: traction, Pa; with law lugre the bristle deflection, m
};

// Points at which shear is computed: the samples, two points of each cell with DepthSampling::kArea, or the nodes of an elastic layer.
struct PressedSkin {
  std::vector<Sample> points;    // taxel kNoTaxel in the margin
  std::vector<int> touching;     // (num_points): index of the touching object, or kNoContact
  std::vector<double> d;         // (num_points), m: penetration; negative where the skin bulges to meet the object
  std::vector<double> pressure;  // (num_points), Pa
  std::vector<double> share{};   // (num_points): of its cell that the object covers; empty: all
};

// The samples with penetration d (m) and pressure (Pa), both (num_taxels x s x s). A sample is touched where d > 0, by the object with the
// lowest surface there. With DepthSampling::kArea: the points of the cells (cell_points.h), touched by the object with the largest mean
// depth over the cell, whose springs act on the share that it covers. `cells`: with DepthSampling::kArea.
PressedSkin pressedSamples(const Sensor& sensor, std::span<const PlacedObject> objects, const AreaDepths& cells, std::span<const double> d,
                           std::span<const double> pressure);

// Index of the object with the lowest surface over each point, kNoContact where there is none. Heights are clamped to -thickness (m) before
// the comparison; ties go to the lower index. heightsUnder(objects) returns the heights (m) over all points.
std::vector<int> lowestObjects(std::span<const PlacedObject> objects, double thickness,
                               const std::function<std::vector<double>(std::span<const PlacedObject>)>& heightsUnder);

struct ContactShear {
  std::vector<Shear> taxel_force;  // (num_taxels), N, on the sensor: positive along x for an object that slides along +x
  std::array<double, 6> wrench{};  // force (N) and torque (N m) on the sensor at the origin of S, in S; margin included
  FrictionState state;             // for the next frame
};

// Shear after the objects have moved from their poses in `before` to those in `objects` in dt (s; used by law lugre only, 0 is infinitely
// slow). Objects are matched by index; a different object at the same index counts as new contact. All zero for a skin without friction.
ContactShear contactShear(const Sensor& sensor, std::span<const PlacedObject> objects, const PressedSkin& skin, const FrictionState& before,
                          double dt);

}  // namespace taxelsim::reference
