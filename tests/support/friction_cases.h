// Closed forms of shear on a foundation of tangential springs under Coulomb's law, for whatever simulates it: the twin and the device run
// the same cases. Each checks with GoogleTest's expectations.
//
// Partial slip: the springs of a Winkler foundation stick until k_t s = mu p, so that with P(delta) the normal force at depth delta a
// tangential displacement s carries Q(s) = mu [P(delta) - P(delta - k_t s / (mu k))], for any indenter (J. Jaeger, Arch. Appl. Mech. 65,
// 1995). The other forms integrate the same springs over the contact and are derived where they stand.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "taxelsim/object.h"
#include "taxelsim/sensor.h"

namespace taxelsim::support {

// What acts on the sensor in one frame.
struct Push {
  double normal = 0;               // N, sum over the taxels
  std::array<double, 6> wrench{};  // N, N m, at the origin of S
};

// A frame per pose of the one object, after a reset; for each of several paths of one length.
using Path = std::vector<Pose>;
using Simulate = std::function<std::vector<std::vector<Push>>(const Sensor& sensor, const Object& object, const std::vector<Path>& paths)>;

// `rounding`: relative error of a force that is no grid's fault.
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

}  // namespace taxelsim::support
