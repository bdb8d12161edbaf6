#include "scene/robot_file.h"

#include <algorithm>
#include <cctype>
#include <set>
#include <string>
#include <tuple>

#include "control/robot_fields.h"
#include "scene/hashed_file.h"
#include "scene/keys/robot.h"
#include "scene/pose_reader.h"
#include "scene/sensor_file.h"
#include "scene/urdf_taxels.h"
#include "taxelsim/scene.h"

namespace taxelsim {
namespace {

constexpr const char* kRobotBlock = "a robot file, or a robot's own settings";
// Names below data/ that are no sensor's.
constexpr std::array<std::string_view, 3> kColumnGroups = {"time", "robot", "object_pose"};

// Where mounts come from.
struct SensorFiles {
  const std::filesystem::path& directory;          // of sensor files
  std::vector<RobotSensor>* sensors;               // of a scene whose mounts have sensors of their own, else null
  const std::filesystem::path* robot_description;  // the URDF of the robot, else null
  LoadedRobot* loaded = nullptr;                   // receives the URDF and its base link, unless it is null
};

void writeMount(const SensorMount& mount, Canonical& canonical) {
  canonical.line("link", canonicalText(mount.link));
  canonical.open("mount");
  canonical.line("position", canonicalList(mount.X_LS.position));
  canonical.line("rotation", canonicalList(mount.X_LS.rotation));
  canonical.close();
}

// A mount by the name of a link, or as a tactile sensor of the URDF has it.
SensorMount readMount(const YamlMap& mount, const SensorFiles& files) {
  const std::optional<YamlNode> node = mount.find("urdf_sensor");
  if (!node) {
    SensorMount result{.link = mount.text("link"), .X_LS = {}};
    result.X_LS = readPose(mount, "mount");
    return result;
  }
  if (files.robot_description == nullptr) node->fail("only a robot from a urdf has sensors in its description");
  for (const std::string_view key : {"link", "mount"}) {
    if (mount.has(key)) node->fail("not allowed with " + std::string(key) + ": the description says where the sensor is");
  }
  const SensorMount result = loadUrdfMount(*files.robot_description, node->text(mount.whatOf("urdf_sensor")));
  writeMount(result, mount.canonical());
  return result;
}

// The name and the sensor of a mount.
RobotSensor readRobotSensor(const YamlMap& mount, const SensorFiles& files) {
  RobotSensor result{.name = mount.text("name"), .sensor = {}, .text = {}};
  const YamlNode name = mount.require("name");
  const auto fits = [](unsigned char c) { return (c < 0x80 && std::isalnum(c) != 0) || c == '_'; };
  if (!std::all_of(result.name.begin(), result.name.end(), fits)) name.refuse(mount.whatOf("name"));
  if (std::find(kColumnGroups.begin(), kColumnGroups.end(), result.name) != kColumnGroups.end()) {
    name.fail(result.name + " is not allowed: data sets have a column of this name");
  }
  for (const RobotSensor& other : *files.sensors) {
    if (other.name == result.name) name.fail("an earlier sensor is named " + result.name);
  }
  Canonical own;
  readSensorBlock(mount.require("sensor", kSensorBlock), files.directory, own);
  result.text = own.text();
  result.sensor = readSensorBlock(mount.require("sensor", kSensorBlock), files.directory, mount.canonical());
  return result;
}

std::vector<SensorMount> readMounts(const YamlMap& map, const std::vector<SensorMount>& otherwise, const SensorFiles& files) {
  Canonical& canonical = map.canonical();
  std::vector<SensorMount> mounts;
  if (!map.has("sensors") && !otherwise.empty() && files.sensors == nullptr) {
    canonical.open("sensors");
    for (const SensorMount& mount : otherwise) {
      canonical.openItem();
      writeMount(mount, canonical);
      canonical.close();
    }
    canonical.close();
    return otherwise;
  }
  const std::vector<YamlNode> items = map.items("sensors");
  canonical.open("sensors");
  for (const YamlNode& item : items) {
    const YamlMap mount(YamlMap::item(item, mountKeys(), canonical));
    if (files.sensors != nullptr) files.sensors->push_back(readRobotSensor(mount, files));
    for (const std::string_view key : {"name", "sensor"}) {
      const std::optional<YamlNode> node = mount.find(key);
      if (node && files.sensors == nullptr) node->fail("only a scene of kind grasp takes the sensors of its robot; this one has its own");
    }
    mounts.push_back(readMount(mount, files));
  }
  canonical.close();
  return mounts;
}

std::array<bool, 6> readSelection(const YamlMap& map, std::array<bool, 6> selection) {
  const std::string what = "a list of at least one of vx, vy, vz, wx, wy, wz";
  if (const std::optional<YamlNode> node = map.find("selection")) {
    const std::vector<YamlNode> items = node->items(what);
    if (items.empty()) node->refuse(what);
    selection.fill(false);
    for (const YamlNode& item : items) {
      const std::string word = item.choice(kCoordinateNames);
      bool& chosen = selection[std::find(kCoordinateNames.begin(), kCoordinateNames.end(), word) - kCoordinateNames.begin()];
      if (chosen) item.fail(word + " is given twice");
      chosen = true;
    }
  }
  std::string text;
  for (std::size_t i = 0; i < selection.size(); ++i) {
    if (selection[i]) text += (text.empty() ? "" : ", ") + std::string(kCoordinateNames[i]);
  }
  map.canonical().line("selection", "[" + text + "]");
  return selection;
}

Joint& jointNamed(const YamlNode& item, std::vector<Joint>& joints) {
  const std::optional<YamlNode> node = item.child("joint");
  if (!node) item.fail("joint is missing: the name of a joint");
  const std::string name = node->text("the name of a joint");
  std::string names;
  for (Joint& joint : joints) {
    if (joint.name == name) return joint;
    names += (names.empty() ? "" : ", ") + joint.name;
  }
  node->fail("no joint " + name + " moves a sensor: " + names);
}

void readInitialPositions(const YamlMap& map, std::vector<Joint>& joints) {
  if (const std::optional<YamlNode> node = map.find("initial_positions")) {
    std::set<std::string> given;
    for (const YamlNode& item : node->items("a list of {joint, position}")) {
      Joint& joint = jointNamed(item, joints);
      if (!given.insert(joint.name).second) item.fail("joint " + joint.name + " is given twice");
      const bool is_revolute = joint.type == JointType::kRevolute;
      Canonical none;
      const YamlMap entry(item, {"joint", is_revolute ? "position[_deg]" : "position[_mm]"}, none);
      joint.initial_position = entry.number("position", Allowed::within(joint.lower, joint.upper, is_revolute ? "rad" : "m"));
    }
  }
  Canonical& canonical = map.canonical();
  canonical.open("initial_positions");
  for (const Joint& joint : joints) {
    canonical.openItem();
    canonical.line("joint", canonicalText(joint.name));
    canonical.line("position", canonicalNumber(joint.initial_position));
    canonical.close();
  }
  canonical.close();
}

// Settings of all robots with joints. The drive is read before.
void readManipulator(const YamlMap& map, Manipulator& robot) {
  robot.X_WB = readPose(map, "base");
  robot.selection = readSelection(map, robot.selection);
  readFields(map, kManipulatorFields, robot);
  readInitialPositions(map, robot.joints);
  atNode(map.node(), [&] { checkRobot(robot); });
}

Manipulator readPanTilt(const YamlMap& parent, const SensorFiles& files) {
  const YamlMap map(parent, "pan_tilt");
  PanTilt platform;
  readFields(map, kPanTiltFields, platform);
  readFields(map, kDriveFields, platform.drive);
  platform.sensors = readMounts(map, platform.sensors, files);
  Manipulator robot = atNode(map.node(), [&] { return panTilt(platform); });
  readManipulator(map, robot);
  return robot;
}

Manipulator readUrdf(const YamlMap& parent, const SensorFiles& files) {
  const YamlMap map(parent, "urdf");
  const std::filesystem::path file = readHashedFile(map, "file", files.directory, kMaxRobotFileBytes);
  UrdfOptions options;
  if (map.has("base_link")) options.base_link = map.text("base_link");
  readFields(map, kUrdfFields, options);
  JointDrive drive;
  readFields(map, kDriveFields, drive);
  options.sensors = readMounts(map, {}, {files.directory, files.sensors, &file});
  if (files.loaded != nullptr) std::tie(files.loaded->urdf, files.loaded->base_link) = std::tie(file, options.base_link);
  Manipulator robot = atNode(map.node(), [&] { return loadUrdf(file, options); });
  robot.drive = drive;
  readManipulator(map, robot);
  return robot;
}

Robot readRobot(const YamlNode& node, const SensorFiles& files, Canonical& canonical, bool versioned) {
  const YamlMap map(node, robotKeys(), canonical, versioned ? "" : "format_version");
  const std::string_view kind = map.onlyOne();
  if (kind == "pan_tilt") return readPanTilt(map, files);
  if (kind == "urdf") return readUrdf(map, files);
  Canonical none;
  const YamlMap nothing(map.require(kind), YamlMap::Keys{}, none);
  canonical.line("free_flying", "{}");
  return FreeFlying{};
}

// A file, whose errors have positions in it.
Robot readRobotFile(const std::filesystem::path& file, std::vector<RobotSensor>* sensors, Canonical& canonical) {
  const std::string name = file.generic_string();
  const YamlTree tree = parseYaml(readYamlFile(file), name);
  const YamlNode root(tree, name);
  checkFormatVersion(root);
  const std::filesystem::path folder = file.parent_path();
  return readRobot(root, {folder, sensors, nullptr}, canonical, true);
}

// The robot file that the key `robot` of a scene names.
std::filesystem::path robotFileOf(const YamlNode& node, const std::filesystem::path& directory) {
  std::filesystem::path file = directory / node.text(kRobotBlock);
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) node.fail(file.generic_string() + " is not there, or not a file");
  return file;
}

// Whether the first mount of a robot names its sensor, as those for scenes of kind grasp do.
bool namesSensors(const YamlNode& root) {
  for (const char* kind : {"urdf", "pan_tilt"}) {
    const std::optional<YamlNode> robot = root.isMap() ? root.child(kind) : std::nullopt;
    const std::optional<YamlNode> mounts = robot && robot->isMap() ? robot->child("sensors") : std::nullopt;
    if (!mounts) continue;
    const std::vector<YamlNode> items = mounts->items("a list of sensors");
    return !items.empty() && items.front().isMap() && items.front().child("name").has_value();
  }
  return false;
}

bool isScene(const YamlNode& root) {
  return root.isMap() && root.child("kind").has_value();
}

// The robot of a robot file (`is_file`), or of the block `robot` of a scene.
LoadedRobot loadRobot(const YamlNode& node, const std::filesystem::path& folder, bool is_file) {
  LoadedRobot loaded;
  Canonical none;
  if (is_file) checkFormatVersion(node);
  loaded.robot = readRobot(node, {folder, namesSensors(node) ? &loaded.sensors : nullptr, nullptr, &loaded}, none, is_file);
  for (const RobotSensor& sensor : loaded.sensors) loaded.names.push_back(sensor.name);
  const auto* manipulator = std::get_if<Manipulator>(&loaded.robot);
  for (std::size_t s = loaded.names.size(); manipulator != nullptr && s < manipulator->sensors.size(); ++s)
    loaded.names.push_back("sensor " + std::to_string(s));
  return loaded;
}

}  // namespace

bool isSceneFile(const std::filesystem::path& file) {
  const std::string name = file.generic_string();
  const YamlTree tree = parseYaml(readYamlFile(file), name);
  return isScene(YamlNode(tree, name));
}

LoadedRobot loadRobotFile(const std::filesystem::path& file) {
  const std::string name = file.generic_string();
  const YamlTree tree = parseYaml(readYamlFile(file), name);
  const YamlNode root(tree, name);
  if (!isScene(root)) return loadRobot(root, file.parent_path(), true);
  const std::optional<YamlNode> robot = root.child("robot");
  if (!robot) return {};
  if (robot->isMap()) return loadRobot(*robot, file.parent_path(), false);
  const std::filesystem::path robot_file = robotFileOf(*robot, file.parent_path());
  const std::string robot_name = robot_file.generic_string();
  const YamlTree robot_tree = parseYaml(readYamlFile(robot_file), robot_name);
  return loadRobot(YamlNode(robot_tree, robot_name), robot_file.parent_path(), true);
}

Robot readRobotBlock(const YamlMap& scene, const std::filesystem::path& directory, std::vector<RobotSensor>* sensors) {
  Canonical& canonical = scene.canonical();
  canonical.open("robot");
  const std::optional<YamlNode> node = scene.find("robot");
  Robot robot;
  if (!node) {
    canonical.line("free_flying", "{}");
  } else if (node->isMap()) {
    robot = readRobot(*node, {directory, sensors, nullptr}, canonical, false);
  } else {
    robot = readRobotFile(robotFileOf(*node, directory), sensors, canonical);
  }
  canonical.close();
  return robot;
}

}  // namespace taxelsim
