// Closed forms of shear on a foundation of tangential springs with Coulomb friction. The twin and the device run the same cases, which
// check with GoogleTest's expectations.
//
// Partial slip: the springs of a Winkler foundation stick until k_t s = mu p, so that with P(delta) the normal force at depth delta a
// tangential displacement s carries Q(s) = mu [P(delta) - P(delta - k_t s / (mu k))], for any indenter (J. Jaeger, Arch. Appl. Mech. 65,
// 1995). The other forms integrate the same springs over the contact and are derived next to their tests.
#pragma once

#include "support/test.h"
#include "taxelsim/object.h"
#include "taxelsim/sensor.h"

namespace taxelsim::support {

// Force and wrench on the sensor in one frame.
struct Push {
  double normal = 0;               // N, sum over the taxels
  std::array<double, 6> wrench{};  // N, N m, at the origin of S
};

// Simulates a frame per pose of one object after a reset, for several paths of the same length.
using Path = std::vector<Pose>;
using Simulate = std::function<std::vector<std::vector<Push>>(const Sensor& sensor, const Object& object, const std::vector<Path>& paths)>;

// `rounding`: relative error of a force that is not due to the grid.
struct FrictionCases {
  Simulate simulate;
  double rounding = 0;

  void discTwist() const;
  void sphereTwist() const;
  void partialSlipOfAFlat() const;
  void partialSlipOfASphere() const;
  void partialSlipOfACylinder() const;
  void loopAreas() const;
  void slantedPress() const;
  void rollingCylinder() const;
  void rollingSphere() const;
  void slideStopSlideBack() const;
  void slipTurnsTowardsTheMotion() const;
  void elasticLayerSticksAndSlips() const;
};

// A case by name, for INSTANTIATE_TEST_SUITE_P.
struct FrictionCase {
  const char* name;
  void (FrictionCases::*check)() const;
};

inline constexpr FrictionCase kFrictionCases[] = {
    {"DiscTwist", &FrictionCases::discTwist},
    {"SphereTwist", &FrictionCases::sphereTwist},
    {"PartialSlipOfAFlat", &FrictionCases::partialSlipOfAFlat},
    {"PartialSlipOfASphere", &FrictionCases::partialSlipOfASphere},
    {"PartialSlipOfACylinder", &FrictionCases::partialSlipOfACylinder},
    {"LoopAreas", &FrictionCases::loopAreas},
    {"SlantedPress", &FrictionCases::slantedPress},
    {"RollingCylinder", &FrictionCases::rollingCylinder},
    {"RollingSphere", &FrictionCases::rollingSphere},
    {"SlideStopSlideBack", &FrictionCases::slideStopSlideBack},
    {"SlipTurnsTowardsTheMotion", &FrictionCases::slipTurnsTowardsTheMotion},
    {"ElasticLayerSticksAndSlips", &FrictionCases::elasticLayerSticksAndSlips},
};

}  // namespace taxelsim::support
