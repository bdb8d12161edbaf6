

#include "servo_fixtures.h"
#include "support/test.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

TEST(CheckServo, RejectsGainsReferencesAndLimitsOutOfRange) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<TactileServo> bad{TactileServo{}};
  for (const FeatureLoop& loop :
       {FeatureLoop{.kp = -1}, FeatureLoop{.kp = nan}, FeatureLoop{.ki = 1 / 0.0}, FeatureLoop{.kd = 1}, FeatureLoop{.reference = nan},
        FeatureLoop{.error_limit = 0}, FeatureLoop{.integral_limit = nan}, FeatureLoop{.derivative_limit = -1}}) {
    bad.push_back(servoOf({{kForce, loop}}));
  }
  bad.push_back(servoOf({{kAcross, {.kp = 1}}, {kX, {.kp = 1}}}));
  for (const auto& change :
       std::initializer_list<void (*)(TactileServo&, double)>{[](TactileServo&servo, double value) { servo.exploration_velocity = value; },
                                                              [](TactileServo&servo, double value) { servo.max_angular_velocity = value; },
                                                              [](TactileServo&servo, double value) { servo.max_linear_velocity = value; },
                                                              [](TactileServo&servo, double value) { servo.min_confidence = value; }}) {
    change(bad.emplace_back(edgeServo()), nan);
  }
  for (const TactileServo& servo : bad) EXPECT_THROW(TactileServoController(servo, gridSensor(), 1), Error);
  EXPECT_NO_THROW(TactileServoController(edgeServo(), gridSensor(), 1));
}

TEST(CheckServo, RejectsRollingForOtherFeaturesThanCenters) {
  TactileServo servo = servoOf({});
  servo[ServoFeature::kTotalForce] = {.selected = true, .kp = 1, .rolling_radius = 0.01};
  EXPECT_THROW(TactileServoController(servo, gridSensor(), 1), Error);
  servo = servoOf({});
  servo[ServoFeature::kCenterX] = {.selected = true, .kp = 1, .rolling_radius = -0.01};
  EXPECT_THROW(TactileServoController(servo, gridSensor(), 1), Error);
}

}  // namespace
}  // namespace taxelsim
