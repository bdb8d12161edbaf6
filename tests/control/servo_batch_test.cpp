// Batches of tactile servos: reset, instances that are not due or invalid, independence, limits.
// After gtest.h, whose macros it uses.
#include "servo_fixtures.h"
#include "support/test.h"

namespace taxelsim {
namespace {

TEST(ServoBatch, ResetClearsOneInstance) {
  TactileServoController controller(servoOf({{kAngle, {.kp = 1, .ki = 10}}}), gridSensor(), 2);
  const std::vector<float> angle{0.5f, 0.5f}, one{1, 1}, area{1e-4f, 1e-4f}, center(6, 0.0f);
  const std::vector<std::uint8_t> due{1, 1};
  std::vector<Twist> first(2), second(2);
  controller.command(inputOf(angle, one, one, center, area, one, due), kPeriod, first);
  controller.reset(1);
  controller.command(inputOf(angle, one, one, center, area, one, due), kPeriod, second);
  EXPECT_NE(second[0], first[0]);
  EXPECT_EQ(second[1], first[1]);
}

TEST(ServoBatch, KeepsTwistsOfInstancesThatAreNotDue) {
  TactileServoController controller(edgeServo(), gridSensor(), 2);
  const std::vector<float> angle{0.5f, 0.5f}, one{1, 1}, area{1e-4f, 1e-4f}, center(6, 0.0f);
  const std::vector<std::uint8_t> due{0, 1};
  const Twist previous{{1, 2, 3}, {4, 5, 6}};
  std::vector<Twist> twists{previous, previous};
  controller.command(inputOf(angle, one, one, center, area, one, due), kPeriod, twists);
  EXPECT_EQ(twists[0], previous);
  EXPECT_NE(twists[1], previous);
}

TEST(ServoBatch, StopsAnInstanceWithFeaturesThatAreNotFinite) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  TactileServoController controller(edgeServo(), gridSensor(), 2), alone(edgeServo(), gridSensor(), 1);
  const std::vector<float> angle{nan, 0.5f}, one{1, 1}, area{1e-4f, 1e-4f}, center(6, 0.0f);
  const std::vector<std::uint8_t> due{1, 1};
  std::vector<Twist> twists(2);
  controller.command(inputOf(angle, one, one, center, area, one, due), kPeriod, twists);
  EXPECT_EQ(twists[0], Twist{});
  EXPECT_EQ(twists[1], commandOne(alone, {.angle = 0.5f, .force = 1, .area = 1e-4f, .target = 1}));
}

Features drawFeatures() {
  const auto draw = [](double min, double max) {
    return static_cast<float>(min + (max - min) * *rc::gen::inRange(0, 1 << 20) / double{1 << 20});
  };
  return {.angle = draw(-kPi / 2, kPi / 2),
          .confidence = draw(0, 1),
          .force = draw(-0.2, 5),
          .area = draw(0, 1e-3),
          .target = draw(0, 5),
          .center = {draw(-0.03, 0.03), draw(-0.03, 0.03), 0}};
}

RC_GTEST_PROP(ServoBatchProperty, RespectsVelocityLimits, ()) {
  TactileServo servo{.exploration_velocity = 0.03, .max_angular_velocity = 0.7};
  servo[kAngle] = {.selected = true, .kp = 5, .ki = 3, .kd = 0.5};
  servo[kForce] = {.selected = true, .kp = 50, .ki = 20, .kd = 0.9};
  servo[kAcross] = {.selected = true, .kp = 5, .ki = 3, .kd = 0.5};
  TactileServoController controller(servo, gridSensor(), 1);
  for (int tick = 0; tick < 4; ++tick) {
    const Twist twist = commandOne(controller, drawFeatures());
    RC_ASSERT(std::abs(twist.w[2]) <= servo.max_angular_velocity * (1 + kSpeedRounding));
    RC_ASSERT(twist.w[0] == 0 && twist.w[1] == 0);
    RC_ASSERT(speed(twist) <= servo.max_linear_velocity * (1 + kSpeedRounding));
  }
}

// Instance i of a batch is bitwise equal to the same instance alone, in every tick.
RC_GTEST_PROP(ServoBatchProperty, InstancesAreIndependent, ()) {
  TactileServo servo = edgeServo();
  servo.exploration_velocity = 0.005;
  for (FeatureLoop& loop : servo.loops) loop.ki = 0.5, loop.kd = 0.3;
  const int num_instances = *rc::gen::inRange(1, 20);
  const auto n = static_cast<std::size_t>(num_instances);
  TactileServoController controller(servo, gridSensor(1.5), num_instances);
  std::vector<TactileServoController> alone;
  for (std::size_t i = 0; i < n; ++i) alone.emplace_back(servo, gridSensor(1.5), 1);
  for (int tick = 0; tick < 3; ++tick) {
    std::vector<Features> features(n);
    std::vector<float> angle, confidence, force, center, area, target;
    for (Features& f : features) {
      f = drawFeatures();
      angle.push_back(f.angle);
      confidence.push_back(f.confidence);
      force.push_back(f.force);
      center.insert(center.end(), f.center.begin(), f.center.end());
      area.push_back(f.area);
      target.push_back(f.target);
    }
    const std::vector<std::uint8_t> due(n, 1);
    std::vector<Twist> twists(n);
    controller.command(inputOf(angle, confidence, force, center, area, target, due), kPeriod, twists);
    for (std::size_t i = 0; i < n; ++i) {
      const Twist one = commandOne(alone[i], features[i]);
      for (std::size_t k = 0; k < 3; ++k) {
        RC_ASSERT(std::bit_cast<std::uint64_t>(twists[i].v[k]) == std::bit_cast<std::uint64_t>(one.v[k]));
        RC_ASSERT(std::bit_cast<std::uint64_t>(twists[i].w[k]) == std::bit_cast<std::uint64_t>(one.w[k]));
      }
    }
  }
}

}  // namespace
}  // namespace taxelsim
