#include "scene/servo_reader.h"

#include "control/servo_fields.h"
#include "scene/keys/controller.h"
#include "scene/scene_fields.h"

namespace taxelsim {

TactileServo readTactileServo(const YamlMap& outer) {
  outer.require("tactile_servo", "the controller's gains and limits");
  const YamlMap map(outer, "tactile_servo");
  TactileServo servo;
  for (std::size_t f = 0; f < servo.loops.size(); ++f) {
    if (!map.has(kServoFeatureNames[f])) continue;
    servo.loops[f].selected = true;
    readFields(YamlMap(map, kServoFeatureNames[f]), loopFields(static_cast<ServoFeature>(f)), servo.loops[f]);
  }
  servo.edge_angle_source = map.choice<EdgeAngleSource>("edge_angle_source");
  servo.contact = map.choice<ServoContact>("contact");
  servo.jacobian = map.choice<TactileJacobianSource>("jacobian");
  readFields(map, kServoFields, servo);
  atNode(map.node(), [&] { checkServo(servo); });
  return servo;
}

std::vector<SceneController> readControllers(const YamlMap& scene) {
  const std::optional<YamlNode> list = scene.find("controllers");
  std::vector<SceneController> controllers;
  if (!list) {
    scene.require("controller", "the controller of a scene of kind servo, {tactile_servo: {...}}; or controllers, a list of them");
    controllers.push_back({.name = "tactile_servo", .weight = 1, .servo = readTactileServo(YamlMap(scene, "controller"))});
    return controllers;
  }
  scene.rejectBoth("controller", "controllers");
  const std::vector<YamlNode> items = scene.items("controllers");
  Canonical& canonical = scene.canonical();
  canonical.open("controllers");
  double total_weight = 0;
  for (const YamlNode& item : items) {
    const YamlMap map = YamlMap::item(item, controllerKeys(), canonical);
    SceneController controller;
    controller.name = map.text("name");
    for (const SceneController& other : controllers) {
      if (other.name == controller.name) map.require("name").fail("an earlier controller has this name");
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
