#include "control/servo_checks.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "control/value_checks.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

constexpr const char* kFeatureNames[kNumServoFeatures] = {"center_x",   "center_y", "center_across", "total_force",
                                                          "edge_angle", "tilt_x",   "tilt_y"};

void checkLoop(const FeatureLoop& loop, std::size_t feature) {
  const std::string name = std::string("controller: ") + kFeatureNames[feature];
  const char* object = name.c_str();
  if (loop.reference) requireValue(std::isfinite(*loop.reference), object, "reference", *loop.reference, "a finite number");
  requireValue(isAtLeastZero(loop.kp), object, "kp", loop.kp, "a number >= 0");
  requireValue(isAtLeastZero(loop.ki), object, "ki", loop.ki, "a number >= 0");
  requireValue(loop.kd >= 0 && loop.kd < 1, object, "kd", loop.kd, "a number >= 0 and < 1");
  requireValue(loop.error_limit > 0, object, "error_limit", loop.error_limit, "a number > 0");
  requireValue(loop.integral_limit > 0, object, "integral_limit", loop.integral_limit, "a number > 0");
  requireValue(loop.derivative_limit > 0, object, "derivative_limit", loop.derivative_limit, "a number > 0");
  const bool can_roll =
      feature == static_cast<std::size_t>(ServoFeature::kCenterX) || feature == static_cast<std::size_t>(ServoFeature::kCenterY);
  requireValue(can_roll ? isAtLeastZero(loop.rolling_radius) : loop.rolling_radius == 0, object, "rolling_radius", loop.rolling_radius,
               can_roll ? "a number >= 0" : "0: only center_x and center_y can be controlled by rolling");
}

}  // namespace

void checkServo(const TactileServo& servo) {
  bool any = false;
  for (std::size_t f = 0; f < servo.loops.size(); ++f) {
    if (servo.loops[f].selected) checkLoop(servo.loops[f], f);
    any = any || servo.loops[f].selected;
  }
  if (!any) throw Error(ErrorKind::kInput, "controller: no feature is selected");
  if (servo[ServoFeature::kCenterAcross].selected && (servo[ServoFeature::kCenterX].selected || servo[ServoFeature::kCenterY].selected)) {
    throw Error(ErrorKind::kInput,
                "controller: center_across and center_x or center_y are selected; they control the same contact position");
  }
  if (servo.jacobian == TactileJacobianSource::kMeasured && servo.contact != ServoContact::kWhole) {
    throw Error(ErrorKind::kInput, "controller: the measured Jacobian is that of the whole contact, but contact is largest_region");
  }
  requireValue(std::isfinite(servo.exploration_velocity), "controller", "exploration_velocity", servo.exploration_velocity,
               "a finite velocity");
  requireValue(std::isfinite(servo.exploration_direction), "controller", "exploration_direction", servo.exploration_direction,
               "a finite angle");
  requireValue(isPositive(servo.max_angular_velocity), "controller", "max_angular_velocity", servo.max_angular_velocity, "a number > 0");
  requireValue(isPositive(servo.max_linear_velocity), "controller", "max_linear_velocity", servo.max_linear_velocity, "a number > 0");
  requireValue(servo.min_confidence >= 0 && servo.min_confidence <= 1, "controller", "min_confidence", servo.min_confidence, "0 to 1");
}

}  // namespace taxelsim
