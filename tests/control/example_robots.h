// Robots and constants shared by the tests of robots.h.
#pragma once

#include "base/vector3.h"
#include "control/robots.h"
#include "support/test.h"
#include "urdf_text.h"

namespace taxelsim {

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kRounding = 1e-13;  // a few hundred rounding errors of numbers of order 1
inline constexpr double kTick = 0.01;       // s
inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// KUKA LWR with a sensor on its palm, in a pose far from singularities and limits.
inline Manipulator lwr() {
  Manipulator robot =
      loadUrdf(kRobots / "lwr_palm.urdf", {.base_link = "", .sensors = {{"palm", {{0, -0.011, 0.045}, axisAngle({1, 0, 0}, kPi / 2)}}}});
  robot.joints[1].initial_position = 0.5;
  robot.joints[3].initial_position = -1.5;
  robot.joints[5].initial_position = 1;
  return robot;
}

inline Twist scaled(const Twist& twist, double factor) {
  return {scale(factor, twist.v), scale(factor, twist.w)};
}

}  // namespace taxelsim
