// Sensor, features and servos shared by the tests of the tactile servo controller.
#pragma once

#include "control/tactile_servo.h"
#include "support/test.h"

namespace taxelsim {

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kPitch = 3.4e-3;         // m
inline constexpr double kStiffness = 1.73e8;     // N/m^3
inline constexpr double kFloat = 4 * 0x1p-24;    // relative: four rounding errors of float32 features
inline constexpr double kSpeedRounding = 1e-12;  // relative: rounding errors in double

inline Sensor gridSensor(double exponent = 1) {
  Sensor sensor;
  sensor.patches.push_back({.name = "grid", .num_rows = 6, .num_cols = 14, .pitch = {kPitch, kPitch}, .X_SP = {}});
  sensor.skin = {.thickness = 2e-3, .law = Winkler{.normal_contact_stiffness = kStiffness, .normal_exponent = exponent}};
  return sensor;
}

// Features of one instance.
struct Features {
  float angle = 0, confidence = 1, force = 2, area = 4e-5f, target = 2;
  std::array<float, 3> center{0, 0, 0};
};

inline constexpr double kPeriod = 0.01;  // s

inline ServoInput inputOf(std::span<const float> angle, std::span<const float> confidence, std::span<const float> force,
                          std::span<const float> center, std::span<const float> area, std::span<const float> target,
                          std::span<const std::uint8_t> due) {
  ServoInput input{.start_force = target, .due = due};
  input.features.edge_angle = angle;
  input.features.edge_confidence = confidence;
  input.features.total_force = force;
  input.features.center_of_pressure = center;
  input.features.contact_area = area;
  return input;
}

inline ServoInput inputOf(const Features& f) {
  static constexpr std::uint8_t kDue = 1;
  return inputOf({&f.angle, 1}, {&f.confidence, 1}, {&f.force, 1}, f.center, {&f.area, 1}, {&f.target, 1}, {&kDue, 1});
}

inline Twist commandOne(TactileServoController& controller, const Features& f) {
  Twist twist;
  controller.command(inputOf(f), kPeriod, {&twist, 1});
  return twist;
}

inline Twist commandOne(const TactileServo& servo, const Features& f) {
  TactileServoController controller(servo, gridSensor(), 1);
  return commandOne(controller, f);
}

struct Setting {
  ServoFeature feature;
  FeatureLoop loop;
};

// A servo with these loops, and velocity limits that are not reached.
inline TactileServo servoOf(std::initializer_list<Setting> settings) {
  TactileServo servo{.max_angular_velocity = 10, .max_linear_velocity = 1};
  for (const Setting& setting : settings) {
    servo[setting.feature] = setting.loop;
    servo[setting.feature].selected = true;
  }
  return servo;
}

inline double speed(const Twist& t) {
  return std::sqrt(t.v[0] * t.v[0] + t.v[1] * t.v[1] + t.v[2] * t.v[2]);
}

inline constexpr ServoFeature kAngle = ServoFeature::kEdgeAngle, kForce = ServoFeature::kTotalForce, kAcross = ServoFeature::kCenterAcross,
                              kX = ServoFeature::kCenterX, kY = ServoFeature::kCenterY;

}  // namespace taxelsim
