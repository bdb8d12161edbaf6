#include "scene/servo_reader.h"

#include <numbers>

namespace taxelsim {
namespace {

// Of each feature, in the order of ServoFeature: the unit of its values, and how a file may also give them.
struct FeatureKeys {
  std::string_view name, unit, suffix;
  Allowed reference;
};
constexpr double kHalfTurn = std::numbers::pi / 2;
const FeatureKeys kFeatures[kNumServoFeatures] = {
    {"center_x", "m", "[_mm]", Allowed::within(-1, 1, "m")},
    {"center_y", "m", "[_mm]", Allowed::within(-1, 1, "m")},
    {"center_across", "m", "[_mm]", Allowed::within(-1, 1, "m")},
    {"total_force", "N", "", Allowed::within(0, 1e6, "N")},
    {"edge_angle", "rad", "[_deg]", {.min = -kHalfTurn, .max = kHalfTurn, .above_min = true, .unit = "rad"}},
};

FeatureLoop readLoop(const YamlMap& parent, const FeatureKeys& keys) {
  const auto suffixed = [&](std::string_view key) { return std::string(key) + std::string(keys.suffix); };
  const std::string reference = suffixed("reference"), error = suffixed("error_limit"), integral = suffixed("integral_limit"),
                    derivative = suffixed("derivative_limit");
  const YamlMap map(parent, keys.name, {reference, "kp", "ki", "kd", error, integral, derivative});
  FeatureLoop loop{.selected = true};
  if (map.has("reference")) loop.reference = map.number("reference", keys.reference);
  loop.kp = map.number("kp", Allowed::atLeast(0, "1/s"));
  loop.ki = map.number("ki", Allowed::atLeast(0, "1/s^2"), loop.ki);
  loop.kd = map.number("kd", Allowed::within(0, 0.99, ""), loop.kd);
  const std::string integral_unit = std::string(keys.unit) + " s", rate_unit = std::string(keys.unit) + "/s";
  if (map.has("error_limit")) loop.error_limit = map.number("error_limit", Allowed::above(0, keys.unit));
  if (map.has("integral_limit")) loop.integral_limit = map.number("integral_limit", Allowed::above(0, integral_unit));
  if (map.has("derivative_limit")) loop.derivative_limit = map.number("derivative_limit", Allowed::above(0, rate_unit));
  return loop;
}

}  // namespace

TactileServo readController(const YamlMap& scene) {
  scene.require("controller", "the controller of a scene of kind servo, {tactile_servo: {...}}");
  const YamlMap outer(scene, "controller", {"tactile_servo"});
  std::string features;
  YamlMap::Keys keys{"exploration_velocity[_mm]", "max_angular_velocity[_deg]", "max_linear_velocity[_mm]", "min_confidence"};
  for (const FeatureKeys& feature : kFeatures) {
    keys.push_back(feature.name);
    features += (features.empty() ? "" : ", ") + std::string(feature.name);
  }
  const YamlMap map(outer, "tactile_servo", keys);
  TactileServo servo;
  bool any = false;
  for (std::size_t f = 0; f < servo.loops.size(); ++f) {
    if (!map.has(kFeatures[f].name)) continue;
    servo.loops[f] = readLoop(map, kFeatures[f]);
    any = true;
  }
  if (!any) map.node().fail("nothing to hold: at least one of " + features);
  for (const ServoFeature axis : {ServoFeature::kCenterX, ServoFeature::kCenterY}) {
    const std::string_view name = kFeatures[static_cast<std::size_t>(axis)].name;
    if (servo[axis].selected && servo[ServoFeature::kCenterAcross].selected) {
      map.require(name, "").fail("given beside center_across, which holds the same contact");
    }
  }
  servo.exploration_velocity = map.number("exploration_velocity", Allowed::any("m/s"), servo.exploration_velocity);
  servo.max_angular_velocity = map.number("max_angular_velocity", Allowed::above(0, "rad/s"), servo.max_angular_velocity);
  servo.max_linear_velocity = map.number("max_linear_velocity", Allowed::above(0, "m/s"), servo.max_linear_velocity);
  servo.min_confidence = map.number("min_confidence", Allowed::within(0, 1, ""), servo.min_confidence);
  return servo;
}

}  // namespace taxelsim
