#include <algorithm>
#include <array>
#include <span>

#include "base/field_checks.h"
#include "scene/conditions.h"
#include "scene/contact_recording_reader.h"
#include "scene/grasp_reader.h"
#include "scene/keys/scene.h"
#include "scene/object_reader.h"
#include "scene/pose_reader.h"
#include "scene/range_reader.h"
#include "scene/robot_file.h"
#include "scene/scene_checks.h"
#include "scene/scene_fields.h"
#include "scene/sensor_file.h"
#include "scene/servo_reader.h"
#include "scene/skin_ranges.h"
#include "scene/task_reader.h"
#include "scene/yaml_reader.h"
#include "taxelsim/error.h"
#include "taxelsim/scene.h"

namespace taxelsim {
namespace {

constexpr std::array<std::string_view, 2> kContactColumns = {"contact_features", "clean_contact_features"};
constexpr int kDefaultRegions = 4;
constexpr double kRateTolerance = 1e-9;  // relative; rates are decimal fractions
constexpr std::array<std::string_view, 4> kFileKeys = {"file", "mesh", "robot", "sensor"};
constexpr std::string_view kActions = "actions", kRobot = "robot", kPoses = "poses";
constexpr std::array<std::string_view, 5> kOfSkin = {"taxel_counts", "tactile_shear_force", "penetration_depth", "tactile_jacobian",
                                                     "clean_tactile_jacobian"};
constexpr std::array<std::string_view, 5> kDefaultColumns = {"tactile_image", "features", "ground_truth", "poses", "actions"};

void readEpisode(const YamlMap& parent, Scene& scene) {
  const bool is_controlled = scene.kind != Scene::Kind::kContactPoints;
  const YamlMap map(parent, "episode");
  if (scene.kind != Scene::Kind::kContacts) {
    readFields(map, kNumStepsFields, scene);
  } else {
    scene.num_steps = static_cast<int>(map.integer("num_steps", 1, 1, 1));
  }
  readFields(map, kSimulationRateFields, scene);
  scene.control_rate = scene.simulation_rate;
  if (!is_controlled) return;
  readFields(map, kControlRateFields, scene);
  atNode(map.node(), [&] { checkRates(scene); });
}

// The delay must be shorter than the episode and fit the ring of forces.
void checkDelay(const YamlNode& place, const Sensor& sensor, const Scene& scene) {
  const double delay = sensor.readout.delay;
  if (delay == 0) return;
  if (scene.kind == Scene::Kind::kContacts) {
    place.fail("readout.delay " + canonicalNumber(delay) +
               " s is not allowed: 0 in a scene of kind contacts, whose one frame would show the sensor before the contact");
  }
  if (delay * scene.simulation_rate > kMaxDelaySteps * (1 + kRateTolerance / 2)) {
    place.fail("readout.delay " + canonicalNumber(delay) + " s is not allowed: at most " + std::to_string(kMaxDelaySteps) +
               " steps at a simulation_rate of " + canonicalNumber(scene.simulation_rate) + " Hz (" +
               canonicalNumber(kMaxDelaySteps / scene.simulation_rate) + " s)");
  }
}

Randomization readRandomization(const YamlMap& parent, const Scene& scene) {
  const bool moves = scene.kind == Scene::Kind::kServo;
  const YamlMap map(parent, "randomization", moves ? servoRandomizationKeys() : randomizationKeys());
  map.rejectBoth("depth", "load");
  if (!map.has("depth")) {
    if (!map.has("load")) {
      map.node().fail("load is missing: " + describe(randomizationField("load").allowed) + ", or [min, max]; or depth[_mm] instead");
    }
    if (std::holds_alternative<Proximity>(scene.sensor.skin.law)) {
      map.find("load")->fail("the sensor's law proximity has no forces: give depth[_mm] instead");
    }
  }
  Randomization random;
  readRanges(map, kRandomizationFields, random);
  if (moves) readRanges(map, kServoRandomizationFields, random);
  atNode(map.node(), [&] { checkSkinRanges(random, scene.sensor); });
  return random;
}

// Contact points do not press on a skin: only the readout varies.
Randomization readReadoutVariation(const YamlMap& parent) {
  const std::array fields{randomizationField("gain"), randomizationField("gain_spread"), randomizationField("noise")};
  const YamlMap map(parent, "randomization");
  Randomization random;
  readRanges(map, fields, random);
  return random;
}

// Exact edge angles need objects with an edge or a contour.
void checkExactAngles(const YamlMap& map, const Scene& scene) {
  const bool wanted = std::any_of(scene.controllers.begin(), scene.controllers.end(), [](const SceneController& controller) {
    return controller.servo.edge_angle_source == EdgeAngleSource::kExact;
  });
  const bool known = std::all_of(scene.objects.begin(), scene.objects.end(),
                                 [](const SceneObject& object) { return object.edge || !object.contour.empty(); });
  if (wanted && !known) map.require("objects", "").fail("edge_angle_source exact needs an edge or a contour of every object");
}

// Why a scene of this kind cannot record a word; empty if it can.
std::string whyNotRecorded(std::string_view word, Scene::Kind kind) {
  const bool is_motion = word == kActions || word == kRobot;
  switch (kind) {
    case Scene::Kind::kServo:
      return "";
    case Scene::Kind::kContacts:
      if (word == kActions) return "a scene of kind contacts has no actions";
      return word == kRobot ? "in a scene of kind contacts no robot moves" : "";
    case Scene::Kind::kGrasp:
      return is_motion || word == kPoses ? "a scene of kind grasp always records its joints and all poses" : "";
    case Scene::Kind::kContactPoints:
      if (is_motion || word == kPoses) return "a scene of kind contact_points has no objects and no robot";
      return std::find(kOfSkin.begin(), kOfSkin.end(), word) != kOfSkin.end() ? "contact points do not determine it" : "";
  }
  return "";
}

std::vector<std::string> readRecord(const YamlMap& map, Scene::Kind kind) {
  std::vector<std::string> chosen;
  if (const std::optional<YamlNode> node = map.find("record")) {
    const std::string words = listOf(kRecordWords);
    const std::vector<YamlNode> items = node->items("a list of " + words);
    if (items.empty()) node->refuse("a list of at least one of " + words);
    for (const YamlNode& item : items) {
      const std::string column = item.text(words);
      if (std::find(kRecordWords.begin(), kRecordWords.end(), column) == kRecordWords.end()) item.refuse(words);
      if (const std::string why = whyNotRecorded(column, kind); !why.empty()) item.fail(why);
      if (std::find(chosen.begin(), chosen.end(), column) != chosen.end()) item.fail(column + " is given twice");
      chosen.push_back(column);
    }
  } else {
    chosen.assign(kDefaultColumns.begin(), kDefaultColumns.end());
    std::erase_if(chosen, [&](const std::string& word) { return !whyNotRecorded(word, kind).empty(); });
  }
  std::vector<std::string> record;
  std::string text;
  for (const std::string_view column : kRecordWords) {
    if (std::find(chosen.begin(), chosen.end(), column) == chosen.end()) continue;
    text += (record.empty() ? "" : ", ") + std::string(column);
    record.emplace_back(column);
  }
  map.canonical().line("record", "[" + text + "]");
  return record;
}

bool records(const Scene& scene, std::string_view word) {
  return std::find(scene.record.begin(), scene.record.end(), word) != scene.record.end();
}

// `which`: of the sensors of a robot.
void checkTaxelCounts(const YamlMap& map, const Scene& scene, const Sensor& sensor, const std::string& which = "") {
  if (sensor.readout.three_axis || !records(scene, "taxel_counts")) return;
  map.require("record", "").fail("taxel_counts needs readout.three_axis of the sensor" + which);
}

void warnOfNoShear(const YamlMap& map, const Scene& scene) {
  if (!records(scene, "tactile_shear_force")) return;
  std::string which;
  if (!scene.grasp && !hasFriction(scene.sensor.skin)) which = " " + scene.sensor.name;
  for (std::size_t s = 0; scene.grasp && s < scene.grasp->sensors.size(); ++s) {
    const RobotSensor& sensor = scene.grasp->sensors[s];
    if (!hasFriction(sensor.sensor.skin)) which += (which.empty() ? "s " : ", ") + sensor.name;
  }
  if (!which.empty()) map.require("record", "").warn("tactile_shear_force is 0 on the sensor" + which + ": skin.friction_coefficient is 0");
}

// Only scenes with contact features have this key.
void readMaxRegions(const YamlMap& map, Scene& scene) {
  const bool has_rows = std::any_of(kContactColumns.begin(), kContactColumns.end(), [&](auto column) { return records(scene, column); });
  if (has_rows) {
    scene.max_regions = kDefaultRegions;
    readFields(map, kMaxRegionsFields, scene);
  } else if (const std::optional<YamlNode> node = map.find("max_regions")) {
    node->fail("needs contact_features or clean_contact_features in record");
  }
}

// The command line's values replace those of the file before the check. The number of episodes is not in the canonical text, so that a data
// set can grow: an episode does not depend on it.
void readDataSet(const YamlMap& parent, const SceneOverrides& overrides, Scene& scene) {
  const YamlMap map(parent, "data_set");
  if (overrides.num_episodes) {
    scene.num_episodes = *overrides.num_episodes;
    checkFields("", kNumEpisodesFields, scene);
  } else {
    Canonical unused;
    readFields(YamlMap(map, unused), kNumEpisodesFields, scene);
  }
  if (overrides.seed) {
    scene.seed = *overrides.seed;
    map.canonical().line("seed", std::to_string(scene.seed));
  } else {
    readFields(map, kSeedFields, scene);
  }
  readFields(map, kDataSetFields, scene);
}

// The episodes of a recording: all of them, unless the scene names fewer.
void readRecordedEpisodes(const YamlMap& map, const SceneOverrides& overrides, Scene& scene) {
  scene.num_episodes = scene.contact_points->num_episodes;
  readDataSet(map, overrides, scene);
  const std::optional<YamlNode> block = map.find("data_set");
  const std::optional<YamlNode> given = block ? block->child("episodes") : std::nullopt;
  const YamlNode place = given && !overrides.num_episodes ? *given : map.require("contact_points", "");
  atNode(place, [&] { checkRecordedEpisodes(scene); });
}

// The rest of a scene of kind grasp.
void readGraspScene(const YamlMap& map, const std::filesystem::path& directory, Scene& scene) {
  Grasp& grasp = scene.grasp.emplace();
  scene.robot = readRobotBlock(map, directory, &grasp.sensors);
  const auto* robot = std::get_if<Manipulator>(&scene.robot);
  if (robot == nullptr) map.require("robot", "a robot with joints").refuse("a robot with joints");
  scene.sensor = grasp.sensors.front().sensor;
  double max_depth_error = maxDepthErrorOf(scene.sensor.skin);
  for (const RobotSensor& sensor : grasp.sensors) max_depth_error = std::min(max_depth_error, maxDepthErrorOf(sensor.sensor.skin));
  scene.objects = readObjects(map, directory, max_depth_error, ObjectUse::kPlaced);
  readEpisode(map, scene);
  for (const RobotSensor& sensor : grasp.sensors) checkDelay(map.require("robot", ""), sensor.sensor, scene);
  scene.randomization = readGrasp(map, *robot, scene.simulation_rate, scene.num_steps, grasp);
  scene.record = readRecord(map, scene.kind);
  for (const RobotSensor& sensor : grasp.sensors) checkTaxelCounts(map, scene, sensor.sensor, " " + sensor.name);
  warnOfNoShear(map, scene);
  readMaxRegions(map, scene);
}

// The rest of a scene of kind contact_points.
void readContactPointsScene(const YamlMap& map, const std::filesystem::path& directory, Scene& scene) {
  const YamlNode sensor = map.require("sensor", kSensorBlock);
  scene.sensor = readSensorBlock(sensor, directory, map.canonical());
  readEpisode(map, scene);
  checkDelay(sensor, scene.sensor, scene);
  scene.contact_points = readContactRecording(map, directory, scene);
  scene.randomization = readReadoutVariation(map);
  scene.record = readRecord(map, scene.kind);
  readMaxRegions(map, scene);
}

// The keys of the kind that the file names. A scene of kind contacts, or of none, may have those of a servo: the readers say why it must
// not.
const Block& keysOfKind(const YamlNode& root) {
  const std::optional<YamlNode> kind = root.isMap() ? root.child("kind") : std::nullopt;
  const std::string_view word = kind && kind->isScalar() ? std::string_view(kind->tree().text) : std::string_view();
  return sceneKeys(word == "grasp" ? Scene::Kind::kGrasp : word == "contact_points" ? Scene::Kind::kContactPoints : Scene::Kind::kServo);
}

// Reads the overrides of all conditions, whichever is loaded. `tree`: the file as it is.
void checkConditions(const YamlTree& tree, const std::string& name, const std::filesystem::path& directory, const Scene& scene) {
  std::optional<Sensor> nominal;
  for (const std::string& condition : scene.conditions) {
    const YamlTree overridden = inCondition(tree, name, condition);
    Canonical unused;
    const YamlMap map(YamlNode(overridden, name), sceneKeys(Scene::Kind::kServo), unused);
    Scene changed;
    changed.kind = scene.kind;
    changed.simulation_rate = scene.simulation_rate;
    const YamlNode sensor = map.require("sensor", kSensorBlock);
    changed.sensor = readSensorBlock(sensor, directory, unused);
    checkDelay(sensor, changed.sensor, changed);
    readRandomization(map, changed);
    if (!nominal) nominal = readSensorBlock(*YamlNode(tree, name).child("sensor"), directory, unused);
    if (!haveSameLayout(*nominal, changed.sensor)) {
      sensor.fail("in condition " + condition + " its taxels are not those of the scene's own sensor");
    }
  }
}

// Checks the conditions of a scene of kind grasp.
void checkGraspConditions(const YamlTree& tree, const std::string& name, const std::filesystem::path& directory, const Scene& scene) {
  for (const std::string& condition : scene.conditions) {
    const YamlTree overridden = inCondition(tree, name, condition);
    Canonical unused;
    const YamlMap map(YamlNode(overridden, name), sceneKeys(Scene::Kind::kGrasp), unused);
    Grasp changed;
    const Robot robot = readRobotBlock(map, directory, &changed.sensors);
    readGraspRandomization(map, changed);
    const YamlNode place = map.require("robot", "");
    for (const RobotSensor& sensor : changed.sensors) checkDelay(place, sensor.sensor, scene);
    const bool same_sensors = std::ranges::equal(changed.sensors, scene.grasp->sensors, [](const RobotSensor& a, const RobotSensor& b) {
      return a.name == b.name && haveSameLayout(a.sensor, b.sensor);
    });
    if (!same_sensors) place.fail("in condition " + condition + " its sensors and their taxels are not those of the scene's own robot");
    const auto* manipulator = std::get_if<Manipulator>(&robot);
    const std::vector<Joint>& joints = std::get<Manipulator>(scene.robot).joints;
    if (manipulator == nullptr || !std::ranges::equal(manipulator->joints, joints, {}, &Joint::name, &Joint::name))
      place.fail("in condition " + condition + " its joints are not those of the scene's own robot");
  }
}

// Refuses names of files with a folder. These keys are those whose text can be such a name.
void refuseFolders(const YamlNode& node) {
  for (const YamlTree::Key& key : node.tree().keys) {
    const YamlNode child = *node.child(key.text);
    if (child.isScalar() && std::find(kFileKeys.begin(), kFileKeys.end(), key.text) != kFileKeys.end() &&
        std::filesystem::path(child.tree().text).filename() != child.tree().text)
      child.refuse("the name of a file without a folder");
    if (child.isMap() || child.isList()) refuseFolders(child);
  }
  if (!node.isList()) return;
  for (const YamlNode& item : node.items("a list")) refuseFolders(item);
}

}  // namespace

Scene loadScene(const std::filesystem::path& file, const SceneOverrides& overrides) {
  const std::string name = file.generic_string();
  const std::filesystem::path directory = file.parent_path();
  const YamlTree file_tree = parseYaml(readYamlFile(file), name);
  checkFormatVersion(YamlNode(file_tree, name));
  if (overrides.refuse_folders) refuseFolders(YamlNode(file_tree, name));
  const std::string condition = overrides.condition.empty() ? std::string(kNominalCondition) : overrides.condition;
  const YamlTree tree = inCondition(file_tree, name, condition);
  const YamlNode root(tree, name);

  Canonical canonical;
  const YamlMap map(root, keysOfKind(root), canonical);
  Scene scene;
  scene.file = file;
  scene.conditions = conditionNames(tree, name);
  scene.condition = condition;
  map.integer("format_version", 1, kFormatVersion);
  scene.name = map.text("name");
  scene.kind = map.choice<Scene::Kind>("kind");
  if (scene.kind == Scene::Kind::kGrasp) {
    readGraspScene(map, directory, scene);
    readDataSet(map, overrides, scene);
    checkGraspConditions(file_tree, name, directory, scene);
    scene.resolved = canonical.text();
    return scene;
  }
  if (scene.kind == Scene::Kind::kContactPoints) {
    readContactPointsScene(map, directory, scene);
    readRecordedEpisodes(map, overrides, scene);
    scene.resolved = canonical.text();
    return scene;
  }
  scene.sensor = readSensorBlock(map.require("sensor", kSensorBlock), directory, canonical);
  scene.robot = readRobotBlock(map, directory);
  if (scene.kind == Scene::Kind::kContacts && !std::holds_alternative<FreeFlying>(scene.robot)) {
    map.find("robot")->fail("a scene of kind contacts has one frame, in which nothing moves");
  }
  scene.objects = readObjects(map, directory, maxDepthErrorOf(scene.sensor.skin));
  if (scene.kind == Scene::Kind::kContacts) refuseMotions(map, "a scene of kind contacts has one frame, in which nothing moves");
  readEpisode(map, scene);
  checkDelay(map.require("sensor", ""), scene.sensor, scene);
  scene.randomization = readRandomization(map, scene);
  if (scene.kind == Scene::Kind::kServo) {
    scene.controllers = readControllers(map);
    checkExactAngles(map, scene);
  } else {
    for (const std::string_view key : {"controller", "controllers"}) {
      if (const std::optional<YamlNode> controller = map.find(key)) controller->fail("a scene of kind contacts has no controller");
    }
  }
  scene.task = readTask(map, scene);
  scene.record = readRecord(map, scene.kind);
  checkTaxelCounts(map, scene, scene.sensor);
  warnOfNoShear(map, scene);
  readMaxRegions(map, scene);
  readDataSet(map, overrides, scene);
  checkConditions(file_tree, name, directory, scene);
  scene.resolved = canonical.text();
  return scene;
}

}  // namespace taxelsim
