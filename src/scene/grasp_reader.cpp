#include "scene/grasp_reader.h"

#include <algorithm>
#include <set>
#include <string>

#include "scene/keys/grasp.h"
#include "scene/range_reader.h"
#include "scene/scene_checks.h"
#include "scene/scene_fields.h"
#include "scene/servo_reader.h"

namespace taxelsim {
namespace {

constexpr double kDefaultGraspHold = 0.5;  // s, for episodes that last at least as long
constexpr double kMaxVelocity = 1e6;       // rad/s or m/s, of a joint without a limit

// Index of the item that the node names; fails with all names if there is none. kind: of the items.
template <typename Named>
int indexOf(const YamlNode& node, const std::string& kind, const std::vector<Named>& list) {
  const std::string name = node.text("the name of a " + kind);
  std::string names;
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (list[i].name == name) return static_cast<int>(i);
    names += (names.empty() ? "" : ", ") + list[i].name;
  }
  node.fail("no " + kind + " " + name + ": " + names);
}

// The same for a key, which is also the kind.
template <typename Named>
int indexOf(const YamlMap& map, const std::string& key, const std::vector<Named>& list) {
  map.text(key);
  return indexOf(map.require(key), key, list);
}

void refuseProximity(const YamlNode& node, const RobotSensor& sensor) {
  if (std::holds_alternative<Proximity>(sensor.sensor.skin.law)) node.fail("the sensor's law proximity has no forces");
}

FingerJoint readJoint(const YamlNode& item, const Manipulator& robot, std::set<int>& taken, Canonical& canonical) {
  static constexpr const char* kJoint = "the name of a joint that moves a sensor";
  // The type of the joint decides the unit of its velocity.
  Canonical unused;
  const int index =
      indexOf(YamlMap(item, {"joint", "velocity", "velocity_deg", "velocity_mm"}, unused).require("joint", kJoint), "joint", robot.joints);
  const Joint& joint = robot.joints[static_cast<std::size_t>(index)];
  const bool is_revolute = joint.type == JointType::kRevolute;
  const YamlMap map(YamlMap::item(item, {"joint", is_revolute ? "velocity[_deg]" : "velocity[_mm]"}, canonical));
  map.text("joint", kJoint);
  if (!taken.insert(index).second) map.require("joint", "").fail("joint " + joint.name + " is given twice, and moves one finger only");
  const double limit = std::min(joint.max_velocity, kMaxVelocity);
  const double velocity = map.number("velocity", Allowed::within(-limit, limit, is_revolute ? "rad/s" : "m/s"));
  if (velocity == 0) map.require("velocity", "").fail("0 is not allowed: the velocity while the finger closes");
  return {.joint = index, .velocity = velocity};
}

bool moves(const Manipulator& robot, int joint, int sensor) {
  const std::vector<ChainJoint>& chain = robot.sensors[static_cast<std::size_t>(sensor)].chain;
  return std::any_of(chain.begin(), chain.end(), [&](const ChainJoint& link) { return link.joint == joint; });
}

// A finger whose joints stay, or move other sensors only, never touches.
void checkClosing(const YamlNode& node, const Manipulator& robot, const Grasp& grasp, const GraspFinger& finger) {
  const std::string& sensor = grasp.sensors[static_cast<std::size_t>(finger.sensor)].name;
  const auto moves_it = [&](const FingerJoint& joint) { return moves(robot, joint.joint, finger.sensor); };
  if (std::none_of(finger.joints.begin(), finger.joints.end(), moves_it)) node.fail("no joint of the list moves the sensor " + sensor);
  const auto is_at_limit = [&](const FingerJoint& closing) {
    const Joint& joint = robot.joints[static_cast<std::size_t>(closing.joint)];
    return closing.velocity > 0 ? joint.initial_position >= joint.upper : joint.initial_position <= joint.lower;
  };
  if (!std::all_of(finger.joints.begin(), finger.joints.end(), is_at_limit)) return;
  const FingerJoint& first = finger.joints.front();
  const Joint& joint = robot.joints[static_cast<std::size_t>(first.joint)];
  const bool is_upper = first.velocity > 0;
  node.fail("the finger cannot close: joint " + joint.name + " starts at its " + (is_upper ? "upper" : "lower") + " limit " +
            canonicalNumber(is_upper ? joint.upper : joint.lower) + ", towards which its velocity points");
}

GraspFinger readFinger(const YamlNode& item, const Manipulator& robot, const Grasp& grasp, std::set<int>& taken, Canonical& canonical) {
  const YamlMap map(YamlMap::item(item, fingerKeys(), canonical));
  GraspFinger finger;
  finger.sensor = indexOf(map, "sensor", grasp.sensors);
  const YamlNode sensor = map.require("sensor", "");
  for (const GraspFinger& other : grasp.fingers) {
    if (other.sensor == finger.sensor) sensor.fail("an earlier finger has this sensor");
  }
  refuseProximity(sensor, grasp.sensors[static_cast<std::size_t>(finger.sensor)]);
  readFields(map, kFingerForceFields, finger);
  const YamlNode joints = map.require("joints");
  canonical.open("joints");
  for (const YamlNode& joint : map.items("joints")) finger.joints.push_back(readJoint(joint, robot, taken, canonical));
  canonical.close();
  checkClosing(joints, robot, grasp, finger);
  return finger;
}

// taken: joints of the fingers.
std::vector<int> readServoJoints(const YamlMap& map, const Manipulator& robot, const Grasp& grasp, int sensor, const std::set<int>& taken) {
  std::vector<int> joints;
  std::string text;
  for (const YamlNode& item : map.items("joints")) {
    const int index = indexOf(item, "joint", robot.joints);
    const std::string& name = robot.joints[static_cast<std::size_t>(index)].name;
    if (taken.contains(index)) item.fail("joint " + name + " belongs to a finger: a joint follows the servo or closes one finger");
    if (std::find(joints.begin(), joints.end(), index) != joints.end()) item.fail("joint " + name + " is given twice");
    if (!moves(robot, index, sensor)) {
      item.fail("joint " + name + " does not move the sensor " + grasp.sensors[static_cast<std::size_t>(sensor)].name);
    }
    joints.push_back(index);
    text += (text.empty() ? "" : ", ") + canonicalText(name);
  }
  map.canonical().line("joints", "[" + text + "]");
  return joints;
}

GraspServo readGraspServo(const YamlMap& outer, const Manipulator& robot, const Grasp& grasp, const std::set<int>& taken) {
  const YamlMap map(outer, "servo");
  GraspServo servo;
  servo.sensor = indexOf(map, "sensor", grasp.sensors);
  const YamlNode sensor = map.require("sensor", "");
  for (const GraspFinger& finger : grasp.fingers) {
    if (finger.sensor == servo.sensor) sensor.fail("a finger has this sensor; the servo needs another one");
  }
  refuseProximity(sensor, grasp.sensors[static_cast<std::size_t>(servo.sensor)]);
  servo.joints = readServoJoints(map, robot, grasp, servo.sensor, taken);
  servo.servo = readTactileServo(map);
  if (servo.servo.edge_angle_source == EdgeAngleSource::kExact) {
    map.require("tactile_servo", "")
        .child("edge_angle_source")
        ->refuse("principal_axis, window or ridge in a scene of kind grasp, whose objects have no edge");
  }
  return servo;
}

// duration: s, of an episode. A scene without this key has the defaults.
void readGraspTask(const YamlMap& scene, double duration, GraspTask& task) {
  task.hold = std::min(kDefaultGraspHold, duration);
  if (!scene.has("task")) return;
  const YamlMap map(scene, "task");
  readFields(map, kGraspTaskFields, task);
  atNode(map.node(), [&] { checkGraspTask(task, duration); });
}

}  // namespace

Randomization readGrasp(const YamlMap& scene, const Manipulator& robot, double simulation_rate, int num_steps, Grasp& grasp) {
  scene.require("grasp", "the fingers and their target forces");
  {
    const YamlMap map(scene, "grasp");
    const std::vector<YamlNode> fingers = map.items("fingers");
    Canonical& canonical = map.canonical();
    grasp.gain = map.number("gain", Allowed::aboveUpTo(0, simulation_rate, "1/s"), std::min(grasp.gain, simulation_rate));
    canonical.open("fingers");
    std::set<int> taken;
    for (const YamlNode& item : fingers) grasp.fingers.push_back(readFinger(item, robot, grasp, taken, canonical));
    canonical.close();
    if (map.has("servo")) grasp.servo = readGraspServo(map, robot, grasp, taken);
  }
  const Randomization random = readGraspRandomization(scene, grasp);
  readGraspTask(scene, num_steps / simulation_rate, grasp.task);
  return random;
}

Randomization readGraspRandomization(const YamlMap& scene, Grasp& grasp) {
  const YamlMap map(scene, "randomization");
  readFields(map, kGraspRandomFields, grasp);
  const std::array fields{randomizationField("gain"), randomizationField("gain_spread"), randomizationField("noise")};
  Randomization random;
  // Without a range the canonical text is the one that it was before these keys existed.
  if (std::ranges::any_of(fields, [&](const RangeField& field) { return map.has(field.name()); })) readRanges(map, fields, random);
  return random;
}

}  // namespace taxelsim
