#include "scene/servo_reader.h"

#include <numbers>

namespace taxelsim {
namespace {

// Key, unit and alternative unit of each feature, in the order of ServoFeature.
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
    {"tilt_x", "rad", "[_deg]", Allowed::within(-kHalfTurn, kHalfTurn, "rad")},
    {"tilt_y", "rad", "[_deg]", Allowed::within(-kHalfTurn, kHalfTurn, "rad")},
};

constexpr std::string_view kRollingRadius = "rolling_radius[_mm]";

bool mayRoll(std::string_view feature) {
  return feature == "center_x" || feature == "center_y";
}

FeatureLoop readLoop(const YamlMap& parent, const FeatureKeys& keys) {
  const auto suffixed = [&](std::string_view key) { return std::string(key) + std::string(keys.suffix); };
  const std::string reference = suffixed("reference"), error = suffixed("error_limit"), integral = suffixed("integral_limit"),
                    derivative = suffixed("derivative_limit");
  YamlMap::Keys allowed{reference, "kp", "ki", "kd", error, integral, derivative};
  if (mayRoll(keys.name)) allowed.push_back(kRollingRadius);
  const YamlMap map(parent, keys.name, allowed);
  FeatureLoop loop{.selected = true};
  if (map.has("reference")) loop.reference = map.number("reference", keys.reference);
  loop.kp = map.number("kp", Allowed::atLeast(0, "1/s"));
  loop.ki = map.number("ki", Allowed::atLeast(0, "1/s^2"), loop.ki);
  loop.kd = map.number("kd", Allowed::within(0, 0.99, ""), loop.kd);
  const std::string integral_unit = std::string(keys.unit) + " s", rate_unit = std::string(keys.unit) + "/s";
  if (map.has("error_limit")) loop.error_limit = map.number("error_limit", Allowed::above(0, keys.unit));
  if (map.has("integral_limit")) loop.integral_limit = map.number("integral_limit", Allowed::above(0, integral_unit));
  if (map.has("derivative_limit")) loop.derivative_limit = map.number("derivative_limit", Allowed::above(0, rate_unit));
  if (mayRoll(keys.name)) loop.rolling_radius = map.number("rolling_radius", Allowed::atLeast(0, "m"), loop.rolling_radius);
  return loop;
}

TactileServo readServo(const YamlMap& outer) {
  outer.require("tactile_servo", "the controller's gains and limits");
  std::string features;
  YamlMap::Keys keys{"jacobian",
                     "edge_angle_source",
                     "contact",
                     "exploration_velocity[_mm]",
                     "exploration_direction[_deg]",
                     "max_angular_velocity[_deg]",
                     "max_linear_velocity[_mm]",
                     "min_confidence"};
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
  if (!any) map.node().fail("no feature to control: at least one of " + features);
  for (const ServoFeature axis : {ServoFeature::kCenterX, ServoFeature::kCenterY}) {
    const std::string_view name = kFeatures[static_cast<std::size_t>(axis)].name;
    map.rejectBoth(name, "center_across", "both control the same coordinate");
  }
  const std::string source = map.choice("edge_angle_source", {"principal_axis", "window", "exact"}, "principal_axis");
  servo.edge_angle_source = source == "window"  ? EdgeAngleSource::kWindow
                            : source == "exact" ? EdgeAngleSource::kExact
                                                : EdgeAngleSource::kPrincipalAxis;
  const bool whole = map.choice("contact", {"whole", "largest_region"}, "whole") == "whole";
  servo.contact = whole ? ServoContact::kWhole : ServoContact::kLargestRegion;
  const bool nominal = map.choice("jacobian", {"nominal", "measured"}, "nominal") == "nominal";
  servo.jacobian = nominal ? TactileJacobianSource::kNominal : TactileJacobianSource::kMeasured;
  if (!nominal && !whole) map.require("jacobian", "").fail("measured covers all contacts, but contact is largest_region");
  servo.exploration_velocity = map.number("exploration_velocity", Allowed::any("m/s"), servo.exploration_velocity);
  servo.exploration_direction =
      map.number("exploration_direction", Allowed::within(-2 * kHalfTurn, 2 * kHalfTurn, "rad"), servo.exploration_direction);
  servo.max_angular_velocity = map.number("max_angular_velocity", Allowed::above(0, "rad/s"), servo.max_angular_velocity);
  servo.max_linear_velocity = map.number("max_linear_velocity", Allowed::above(0, "m/s"), servo.max_linear_velocity);
  servo.min_confidence = map.number("min_confidence", Allowed::within(0, 1, ""), servo.min_confidence);
  return servo;
}

}  // namespace

std::vector<SceneController> readControllers(const YamlMap& scene) {
  const std::optional<YamlNode> list = scene.find("controllers");
  std::vector<SceneController> controllers;
  if (!list) {
    scene.require("controller", "the controller of a scene of kind servo, {tactile_servo: {...}}; or controllers, a list of them");
    controllers.push_back({.name = "tactile_servo", .weight = 1, .servo = readServo(YamlMap(scene, "controller", {"tactile_servo"}))});
    return controllers;
  }
  scene.rejectBoth("controller", "controllers");
  const std::string what = "a list of at least one controller, {name: ..., tactile_servo: {...}}";
  const std::vector<YamlNode> items = list->items(what);
  if (items.empty()) list->refuse(what);
  Canonical& canonical = scene.canonical();
  canonical.open("controllers");
  double total_weight = 0;
  for (const YamlNode& item : items) {
    const YamlMap map = YamlMap::item(item, {"name", "weight", "tactile_servo"}, canonical);
    SceneController controller;
    controller.name = map.text("name", "a name");
    for (const SceneController& other : controllers) {
      if (other.name == controller.name) map.require("name", "").fail("an earlier controller has this name");
    }
    controller.weight = map.number("weight", Allowed::atLeast(0, ""), controller.weight);
    controller.servo = readServo(map);
    total_weight += controller.weight;
    controllers.push_back(std::move(controller));
  }
  canonical.close();
  if (total_weight <= 0) list->fail("every weight is 0: at least one controller must be chosen");
  return controllers;
}

}  // namespace taxelsim
