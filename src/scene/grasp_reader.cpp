#include "scene/grasp_reader.h"

#include <algorithm>
#include <array>
#include <numbers>
#include <set>
#include <string>

namespace taxelsim {
namespace {

constexpr std::array kRandomFields{
    Field<Grasp>{"offset[_mm]", &Grasp::offset, Allowed::within(0, 1, "m")},
    Field<Grasp>{"yaw[_deg]", &Grasp::yaw, Allowed::within(0, std::numbers::pi, "rad")},
    Field<Grasp>{"force_spread", &Grasp::force_spread, Allowed::within(0, 1, "")},
};
constexpr const char* kFingers = "a list of at least one {sensor, force, joints}";
constexpr const char* kFingerJoints = "a list of at least one {joint, velocity}";
constexpr double kMaxVelocity = 1e6;  // rad/s or m/s, of a joint without a limit
constexpr Allowed kForce = Allowed::aboveUpTo(0, 1e6, "N");

// Index of the item of that name; fails with all names if there is none.
template <typename Named>
int indexOf(const YamlMap& map, std::string_view key, const std::string& what, const std::vector<Named>& list) {
  const std::string name = map.text(key, what);
  std::string names;
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (list[i].name == name) return static_cast<int>(i);
    names += (names.empty() ? "" : ", ") + list[i].name;
  }
  map.require(key, what).fail("no " + std::string(key) + " " + name + ": " + names);
}

FingerJoint readJoint(const YamlNode& item, const Manipulator& robot, std::set<int>& taken, Canonical& canonical) {
  // The type of the joint decides the unit of its velocity.
  Canonical unused;
  const int index = indexOf(YamlMap(item, {"joint", "velocity", "velocity_deg", "velocity_mm"}, unused), "joint",
                            "the name of a joint that moves a sensor", robot.joints);
  const Joint& joint = robot.joints[static_cast<std::size_t>(index)];
  const bool is_revolute = joint.type == JointType::kRevolute;
  const YamlMap map(YamlMap::item(item, {"joint", is_revolute ? "velocity[_deg]" : "velocity[_mm]"}, canonical));
  map.text("joint", "");
  if (!taken.insert(index).second) map.require("joint", "").fail("joint " + joint.name + " is given twice, and moves one finger only");
  const double limit = std::min(joint.max_velocity, kMaxVelocity);
  const double velocity = map.number("velocity", Allowed::within(-limit, limit, is_revolute ? "rad/s" : "m/s"));
  if (velocity == 0) map.require("velocity", "").fail("0 is not allowed: the velocity while the finger closes");
  return {.joint = index, .velocity = velocity};
}

GraspFinger readFinger(const YamlNode& item, const Manipulator& robot, const Grasp& grasp, std::set<int>& taken, Canonical& canonical) {
  const YamlMap map(YamlMap::item(item, {"sensor", "force", "joints"}, canonical));
  GraspFinger finger;
  finger.sensor = indexOf(map, "sensor", "the name of a sensor of the robot", grasp.sensors);
  const YamlNode sensor = map.require("sensor", "");
  for (const GraspFinger& other : grasp.fingers) {
    if (other.sensor == finger.sensor) sensor.fail("an earlier finger has this sensor");
  }
  if (std::holds_alternative<Proximity>(grasp.sensors[static_cast<std::size_t>(finger.sensor)].sensor.skin.law)) {
    sensor.fail("the sensor's law proximity has no forces");
  }
  finger.force = map.number("force", kForce);
  const YamlNode joints = map.require("joints", kFingerJoints);
  canonical.open("joints");
  for (const YamlNode& joint : joints.items(kFingerJoints)) finger.joints.push_back(readJoint(joint, robot, taken, canonical));
  canonical.close();
  if (finger.joints.empty()) joints.refuse(kFingerJoints);
  return finger;
}

}  // namespace

void readGrasp(const YamlMap& scene, const Manipulator& robot, double simulation_rate, Grasp& grasp) {
  scene.require("grasp", "the fingers and their target forces");
  {
    const YamlMap map(scene, "grasp", {"gain", "fingers"});
    const YamlNode fingers = map.require("fingers", kFingers);
    Canonical& canonical = map.canonical();
    grasp.gain = map.number("gain", Allowed::aboveUpTo(0, simulation_rate, "1/s"), std::min(grasp.gain, simulation_rate));
    canonical.open("fingers");
    std::set<int> taken;
    for (const YamlNode& item : fingers.items(kFingers)) grasp.fingers.push_back(readFinger(item, robot, grasp, taken, canonical));
    canonical.close();
    if (grasp.fingers.empty()) fingers.refuse(kFingers);
  }
  const YamlMap random(scene, "randomization", keysOf(kRandomFields));
  readFields(random, kRandomFields, grasp);
}

}  // namespace taxelsim
