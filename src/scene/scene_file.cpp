#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "scene/conditions.h"
#include "scene/object_reader.h"
#include "scene/pose_reader.h"
#include "scene/robot_file.h"
#include "scene/sensor_file.h"
#include "scene/servo_reader.h"
#include "scene/task_reader.h"
#include "scene/yaml_reader.h"
#include "taxelsim/error.h"
#include "taxelsim/scene.h"

namespace taxelsim {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr std::uint64_t kMaxSteps = 1'000'000;  // frames per episode
constexpr std::uint64_t kMaxEpisodes = std::uint64_t{1} << 40;
constexpr std::uint64_t kMaxEpisodesPerShard = 1'000'000;  // a shard is held in memory
constexpr double kMaxRate = 1e6;                           // Hz
constexpr double kMaxOffset = 1;                           // m; no sensor is larger
constexpr double kMaxLoad = 1e6;                           // N
constexpr double kRateTolerance = 1e-9;                    // relative; rates are decimal fractions

constexpr std::array<std::string_view, 2> kContactColumns = {"contact_features", "clean_contact_features"};
constexpr std::uint64_t kMaxRegions = 8;  // as in taxelsim/simulator.h
constexpr std::uint64_t kDefaultRegions = 4;
constexpr std::string_view kActions = "actions", kRobot = "robot";
constexpr std::array<std::string_view, 5> kDefaultColumns = {"tactile_image", "features", "ground_truth", "poses", "actions"};

// A number, or [min, max].
Range readRange(const YamlMap& map, std::string_view key, const Allowed& allowed, std::optional<Range> otherwise = {}) {
  const std::optional<YamlNode> node = map.find(key);
  Range range = otherwise.value_or(Range{});
  if (!node && !otherwise) map.require(key, "a number, or [min, max]");
  if (node && node->isList()) {
    const std::vector<double> numbers = node->numbers(allowed, 2);
    range = {numbers[0], numbers[1]};
    if (range.min > range.max) node->fail("[min, max] is not allowed with min > max");
  } else if (node) {
    range.min = range.max = node->number(allowed);
  }
  map.canonical().line(key, canonicalList(std::array{range.min, range.max}));
  return range;
}

void readEpisode(const YamlMap& parent, Scene& scene) {
  const YamlMap map(parent, "episode", {"num_steps", "simulation_rate", "control_rate"});
  const Allowed rate{.min = 0, .max = kMaxRate, .above_min = true, .unit = "Hz"};
  if (scene.kind == Scene::Kind::kServo) {
    scene.num_steps = static_cast<int>(map.integer("num_steps", 1, kMaxSteps));
  } else {
    scene.num_steps = static_cast<int>(map.integer("num_steps", 1, 1, 1));
  }
  scene.simulation_rate = map.number("simulation_rate", rate, scene.simulation_rate);
  scene.control_rate = map.number("control_rate", rate, scene.simulation_rate);
  const double ratio = scene.simulation_rate / scene.control_rate;
  if (ratio < 1 - kRateTolerance || std::abs(ratio - std::round(ratio)) > kRateTolerance * ratio) {
    const YamlNode place = map.find("control_rate").value_or(map.node());
    place.fail(canonicalNumber(scene.control_rate) + " Hz is not allowed: simulation_rate (" + canonicalNumber(scene.simulation_rate) +
               " Hz) divided by a whole number");
  }
}

// The delay must be shorter than the episode and fit the ring of forces.
void checkDelay(const YamlMap& map, const Scene& scene) {
  const double delay = scene.sensor.readout.delay;
  if (delay == 0) return;
  const YamlNode sensor = map.require("sensor", "");
  if (scene.kind == Scene::Kind::kContacts) {
    sensor.fail("readout.delay " + canonicalNumber(delay) +
                " s is not allowed: 0 in a scene of kind contacts, whose one frame would show the sensor before the contact");
  }
  if (delay * scene.simulation_rate > kMaxDelaySteps * (1 + kRateTolerance / 2)) {
    sensor.fail("readout.delay " + canonicalNumber(delay) + " s is not allowed: at most " + std::to_string(kMaxDelaySteps) +
                " steps at a simulation_rate of " + canonicalNumber(scene.simulation_rate) + " Hz (" +
                canonicalNumber(kMaxDelaySteps / scene.simulation_rate) + " s)");
  }
}

Randomization readRandomization(const YamlMap& parent, const Scene& scene) {
  YamlMap::Keys keys{"x[_mm]", "y[_mm]", "yaw[_deg]", "tilt[_deg]", "load", "depth[_mm]", "gain", "gain_spread", "noise"};
  const bool moves = scene.kind == Scene::Kind::kServo;
  if (moves) keys.insert(keys.end(), {"exploration_velocity[_mm]", "linear_action_noise[_mm]", "angular_action_noise[_deg]"});
  const YamlMap map(parent, "randomization", keys);
  const Allowed offset = Allowed::within(-kMaxOffset, kMaxOffset, "m");
  Randomization random;
  random.x = readRange(map, "x", offset, Range{});
  random.y = readRange(map, "y", offset, Range{});
  random.yaw = readRange(map, "yaw", Allowed::within(-2 * kPi, 2 * kPi, "rad"), Range{});
  random.tilt = readRange(map, "tilt", Allowed::within(0, kPi / 2, "rad"), Range{});
  if (map.has("depth")) {
    map.rejectBoth("depth", "load");
    random.depth = readRange(map, "depth", Allowed::within(0, kMaxOffset, "m"));
  } else {
    if (!map.has("load")) map.node().fail("load is missing: a number from 0 to 1e6 N, or [min, max]; or depth[_mm] instead");
    if (std::holds_alternative<Proximity>(scene.sensor.skin.law)) {
      map.find("load")->fail("the sensor's law proximity has no forces: give depth[_mm] instead");
    }
    random.load = readRange(map, "load", Allowed::within(0, kMaxLoad, "N"));
  }
  random.gain = readRange(map, "gain", {.min = 0, .max = 1e3, .above_min = true}, random.gain);
  random.gain_spread = readRange(map, "gain_spread", Allowed::within(0, 2, ""), random.gain_spread);
  random.noise = readRange(map, "noise", Allowed::within(0, 65535, "counts"), random.noise);
  if (moves) {
    if (map.has("exploration_velocity")) random.exploration_velocity = readRange(map, "exploration_velocity", Allowed::any("m/s"));
    random.linear_action_noise = readRange(map, "linear_action_noise", Allowed::atLeast(0, "m/s"), random.linear_action_noise);
    random.angular_action_noise = readRange(map, "angular_action_noise", Allowed::atLeast(0, "rad/s"), random.angular_action_noise);
  }
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

std::vector<std::string> readRecord(const YamlMap& map, Scene::Kind kind) {
  std::vector<std::string> chosen;
  const bool has_actions = kind == Scene::Kind::kServo;
  if (const std::optional<YamlNode> node = map.find("record")) {
    std::string words;
    for (const std::string_view column : kRecordWords) words += (words.empty() ? "" : " | ") + std::string(column);
    const std::vector<YamlNode> items = node->items("a list of " + words);
    if (items.empty()) node->refuse("a list of at least one of " + words);
    for (const YamlNode& item : items) {
      const std::string column = item.text(words);
      if (std::find(kRecordWords.begin(), kRecordWords.end(), column) == kRecordWords.end()) item.refuse(words);
      if (column == kActions && !has_actions) item.fail("a scene of kind contacts has no actions");
      if (column == kRobot && !has_actions) item.fail("in a scene of kind contacts no robot moves");
      if (std::find(chosen.begin(), chosen.end(), column) != chosen.end()) item.fail(column + " is given twice");
      chosen.push_back(column);
    }
  } else {
    chosen.assign(kDefaultColumns.begin(), kDefaultColumns.end());
    if (!has_actions) std::erase(chosen, kActions);
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

// Only scenes with contact features have this key.
int readMaxRegions(const YamlMap& map, const std::vector<std::string>& record) {
  const bool has_rows = std::any_of(kContactColumns.begin(), kContactColumns.end(), [&](std::string_view column) {
    return std::find(record.begin(), record.end(), column) != record.end();
  });
  if (has_rows) return static_cast<int>(map.integer("max_regions", 0, kMaxRegions, kDefaultRegions));
  if (const std::optional<YamlNode> node = map.find("max_regions")) {
    node->fail("needs contact_features or clean_contact_features in record");
  }
  return 0;
}

// The command line's value replaces the file's before the check.
std::uint64_t overridden(const YamlMap& map, std::string_view key, std::uint64_t min, std::uint64_t max, std::uint64_t otherwise,
                         const std::optional<std::uint64_t>& override_value) {
  if (!override_value) return map.integer(key, min, max, otherwise);
  if (*override_value < min || *override_value > max) {
    throw Error(ErrorKind::kInput, std::string(key) + ": " + std::to_string(*override_value) + " is not allowed: a whole number from " +
                                       std::to_string(min) + " to " + std::to_string(max));
  }
  map.canonical().line(key, std::to_string(*override_value));
  return *override_value;
}

void readDataSet(const YamlMap& parent, const SceneOverrides& overrides, Scene& scene) {
  const YamlMap map(parent, "data_set", {"episodes", "seed", "episodes_per_shard", "compression", "chunk_bytes"});
  scene.num_episodes = overridden(map, "episodes", 1, kMaxEpisodes, scene.num_episodes, overrides.num_episodes);
  scene.seed = overridden(map, "seed", 0, std::numeric_limits<std::uint64_t>::max(), scene.seed, overrides.seed);
  scene.episodes_per_shard = map.integer("episodes_per_shard", 1, kMaxEpisodesPerShard, scene.episodes_per_shard);
  scene.compression = static_cast<int>(map.integer("compression", 0, 9, static_cast<std::uint64_t>(scene.compression)));
  scene.chunk_bytes = map.integer("chunk_bytes", kMinChunkBytes, kMaxChunkBytes, scene.chunk_bytes);
}

YamlMap::Keys sceneKeys() {
  return {"format_version", "name",       "kind",        "sensor", "robot",  "objects",     "episode", "randomization(randomisation)",
          "conditions",     "controller", "controllers", "task",   "record", "max_regions", "data_set"};
}

// Reads the overrides of all conditions, whichever is loaded. `tree`: the file as it is.
void checkConditions(const YamlTree& tree, const std::string& name, const std::filesystem::path& directory, const Scene& scene) {
  std::optional<Sensor> nominal;
  for (const std::string& condition : scene.conditions) {
    const YamlTree overridden = inCondition(tree, name, condition);
    Canonical unused;
    const YamlMap map(YamlNode(overridden, name), sceneKeys(), unused);
    Scene changed;
    changed.kind = scene.kind;
    changed.simulation_rate = scene.simulation_rate;
    const YamlNode sensor = map.require("sensor", kSensorBlock);
    changed.sensor = readSensorBlock(sensor, directory, unused);
    checkDelay(map, changed);
    readRandomization(map, changed);
    if (!nominal) nominal = readSensorBlock(*YamlNode(tree, name).child("sensor"), directory, unused);
    if (!haveSameLayout(*nominal, changed.sensor)) {
      sensor.fail("in condition " + condition + " its taxels are not those of the scene's own sensor");
    }
  }
}

}  // namespace

Scene loadScene(const std::filesystem::path& file, const SceneOverrides& overrides) {
  const std::string name = file.generic_string();
  const std::filesystem::path directory = file.parent_path();
  const YamlTree file_tree = parseYaml(readYamlFile(file), name);
  checkFormatVersion(YamlNode(file_tree, name));
  const std::string condition = overrides.condition.empty() ? std::string(kNominalCondition) : overrides.condition;
  const YamlTree tree = inCondition(file_tree, name, condition);
  const YamlNode root(tree, name);

  Canonical canonical;
  const YamlMap map(root, sceneKeys(), canonical);
  Scene scene;
  scene.file = file;
  scene.conditions = conditionNames(tree, name);
  scene.condition = condition;
  map.integer("format_version", 1, kFormatVersion);
  scene.name = map.text("name", "a name");
  scene.kind = map.choice("kind", {"servo", "contacts"}) == "servo" ? Scene::Kind::kServo : Scene::Kind::kContacts;
  scene.sensor = readSensorBlock(map.require("sensor", kSensorBlock), directory, canonical);
  scene.robot = readRobotBlock(map, directory);
  if (scene.kind == Scene::Kind::kContacts && !std::holds_alternative<FreeFlying>(scene.robot)) {
    map.find("robot")->fail("a scene of kind contacts has one frame, in which nothing moves");
  }
  scene.objects = readObjects(map, directory);
  if (scene.kind == Scene::Kind::kContacts) refuseMotions(map, "a scene of kind contacts has one frame, in which nothing moves");
  readEpisode(map, scene);
  checkDelay(map, scene);
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
  scene.max_regions = readMaxRegions(map, scene.record);
  readDataSet(map, overrides, scene);
  checkConditions(file_tree, name, directory, scene);
  scene.resolved = canonical.text();
  return scene;
}

}  // namespace taxelsim
