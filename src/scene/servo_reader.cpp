#include "scene/servo_reader.h"

#include "control/servo_fields.h"
#include "scene/scene_fields.h"

namespace taxelsim {

TactileServo readTactileServo(const YamlMap& outer) {
  outer.require("tactile_servo", "the controller's gains and limits");
  YamlMap::Keys keys{"jacobian", "edge_angle_source", "contact"};
  addKeys(kServoFields, keys);
  keys.insert(keys.end(), kServoFeatureNames.begin(), kServoFeatureNames.end());
  const YamlMap map(outer, "tactile_servo", keys);
  TactileServo servo;
  for (std::size_t f = 0; f < servo.loops.size(); ++f) {
    if (!map.has(kServoFeatureNames[f])) continue;
    const auto fields = loopFields(static_cast<ServoFeature>(f));
    servo.loops[f].selected = true;
    readFields(YamlMap(map, kServoFeatureNames[f], keysOf(fields)), fields, servo.loops[f]);
  }
  const std::string source = map.choice("edge_angle_source", {"principal_axis", "window", "ridge", "exact"}, "principal_axis");
  servo.edge_angle_source = source == "window"  ? EdgeAngleSource::kWindow
                            : source == "ridge" ? EdgeAngleSource::kRidge
                            : source == "exact" ? EdgeAngleSource::kExact
                                                : EdgeAngleSource::kPrincipalAxis;
  const bool whole = map.choice("contact", {"whole", "largest_region"}, "whole") == "whole";
  servo.contact = whole ? ServoContact::kWhole : ServoContact::kLargestRegion;
  const bool nominal = map.choice("jacobian", {"nominal", "measured"}, "nominal") == "nominal";
  servo.jacobian = nominal ? TactileJacobianSource::kNominal : TactileJacobianSource::kMeasured;
  readFields(map, kServoFields, servo);
  atNode(map.node(), [&] { checkServo(servo); });
  return servo;
}

std::vector<SceneController> readControllers(const YamlMap& scene) {
  const std::optional<YamlNode> list = scene.find("controllers");
  std::vector<SceneController> controllers;
  if (!list) {
    scene.require("controller", "the controller of a scene of kind servo, {tactile_servo: {...}}; or controllers, a list of them");
    controllers.push_back(
        {.name = "tactile_servo", .weight = 1, .servo = readTactileServo(YamlMap(scene, "controller", {"tactile_servo"}))});
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
    readFields(map, kControllerFields, controller);
    controller.servo = readTactileServo(map);
    total_weight += controller.weight;
    controllers.push_back(std::move(controller));
  }
  canonical.close();
  if (total_weight <= 0) list->fail("every weight is 0: at least one controller must be chosen");
  return controllers;
}

}  // namespace taxelsim
