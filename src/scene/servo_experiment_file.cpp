#include <algorithm>
#include <cmath>

#include "scene/experiment_reader.h"
#include "scene/robot_file.h"
#include "scene/scene_checks.h"
#include "scene/scene_fields.h"
#include "scene/sensor_file.h"

namespace taxelsim {
namespace {

constexpr double kMaxGain = 1000;  // kp times the control period; far above the stability limit
constexpr std::size_t kMaxRuns = 100;
constexpr const char* kRuns = "a list of 1 to 100 {name, controller, ...}";
constexpr const char* kSweeps = "a list of {name, controller, gains, ...}";

const YamlMap::Keys kSceneKeys{"name",      "controller", "object",          "robot",        "x[_mm]",   "y[_mm]",
                               "yaw[_deg]", "load",       "simulation_rate", "control_rate", "num_steps"};

template <typename T>
std::string namesOf(const std::vector<T>& items, const std::string& (*name)(const T&)) {
  std::string names;
  for (const T& item : items) names += (names.empty() ? "" : " | ") + name(item);
  return names;
}

const std::string& controllerName(const SceneController& controller) {
  return controller.name;
}

const std::string& objectName(const SceneObject& object) {
  return object.object.name;
}

// The item with that name, as a list of one.
template <typename T>
void choose(const YamlMap& map, std::string_view key, std::vector<T>& items, const std::string& (*name)(const T&)) {
  const std::string allowed = namesOf(items, name);
  const YamlNode node = map.require(key, "one of " + allowed);
  const std::string wanted = node.text(allowed);
  const auto found = std::find_if(items.begin(), items.end(), [&](const T& item) { return name(item) == wanted; });
  if (found == items.end()) node.refuse(allowed);
  T chosen = std::move(*found);
  chosen.weight = 1;
  items.assign(1, std::move(chosen));
}

void readRates(const YamlMap& map, Scene& scene) {
  const double ratio = scene.simulation_rate / scene.control_rate;
  readFields(map, kSimulationRateFields, scene);
  scene.control_rate = scene.simulation_rate / ratio;
  readFields(map, kControlRateFields, scene);
  atNode(map.node(), [&] { checkRates(scene); });
}

// Settings of a run or sweep that replace those of its scene.
Scene readOverrides(const YamlMap& map, Scene scene, const std::filesystem::path& directory) {
  choose(map, "controller", scene.controllers, controllerName);
  if (map.has("object")) {
    choose(map, "object", scene.objects, objectName);
  } else if (scene.objects.size() > 1) {
    map.require("object", "the object to be felt, one of " + namesOf(scene.objects, objectName));
  }
  if (map.has("robot")) scene.robot = readRobotBlock(map, directory);
  Randomization& start = scene.randomization;
  const auto fix = [&](std::string_view key, Range& range) {
    if (map.has(key)) range.min = range.max = map.number(key, randomizationField(key).allowed);
  };
  fix("x", start.x);
  fix("y", start.y);
  fix("yaw", start.yaw);
  if (map.has("load")) {
    start.load = Range{};
    fix("load", *start.load);
    start.depth.reset();
  }
  readRates(map, scene);
  const std::uint64_t max_steps = maxWhole(kNumStepsFields[0].allowed);
  scene.num_steps = static_cast<int>(map.integer("num_steps", 2, max_steps, static_cast<std::uint64_t>(std::max(2, scene.num_steps))));
  scene.num_episodes = 1;
  return scene;
}

// Fails at `node` unless the controller controls the edge angle alone, by kp alone, as the theory assumes.
void checkLoop(const YamlNode& node, const std::string& what, const Scene& scene, bool exact) {
  const auto fail = [&](const std::string& of) { node.fail(what + " is of " + of); };
  const TactileServo& servo = scene.controllers.front().servo;
  const FeatureLoop& angle = servo[ServoFeature::kEdgeAngle];
  const auto selected = std::count_if(servo.loops.begin(), servo.loops.end(), [](const FeatureLoop& loop) { return loop.selected; });
  if (!angle.selected || selected != 1 || angle.ki != 0 || angle.kd != 0 || std::isfinite(angle.error_limit) ||
      servo.exploration_velocity != 0 || scene.randomization.exploration_velocity) {
    fail("a controller that holds edge_angle alone, by kp alone");
  }
  if (!(angle.kp > 0)) fail("a controller whose kp is above 0");
  if (exact != (servo.edge_angle_source == EdgeAngleSource::kExact)) {
    fail(exact ? "a controller with edge_angle_source exact" : "a controller that measures its edge angle");
  }
  const auto& object = scene.objects.front();
  if (!object.edge || object.motion) fail("an object at rest that has an edge");
  const Readout& readout = scene.sensor.readout;
  if (!exact && (scene.sensor.frame_rate != 0 || readout.delay != 0 || readout.low_pass_time != 0)) {
    fail("a sensor without a frame_rate, delay or low_pass_time of its own");
  }
  const auto* manipulator = std::get_if<Manipulator>(&scene.robot);
  const int period = static_cast<int>(std::lround(scene.simulation_rate / scene.control_rate));
  if (manipulator == nullptr || manipulator->drive.delay == 0 || manipulator->drive.delay == period) return;
  fail("a robot without delay, or with one of a control period (" + std::to_string(period) + ")");
}

ServoRun readRun(const YamlNode& item, const Scene& scene, const std::filesystem::path& directory, Canonical& canonical) {
  YamlMap::Keys keys = kSceneKeys;
  keys.insert(keys.end(), {"group", "theory"});
  const YamlMap map = YamlMap::item(item, keys, canonical);
  ServoRun run;
  run.name = map.text("name", "a name");
  run.group = map.text("group", "a name", run.name);
  run.scene = readOverrides(map, scene, directory);
  const std::string theory = map.choice("theory", {"none", "closed_form", "characteristic"}, "none");
  if (theory == "none") return run;
  run.theory = theory == "closed_form" ? ServoRun::Theory::kClosedForm : ServoRun::Theory::kCharacteristic;
  checkLoop(map.require("theory", ""), theory, run.scene, run.theory == ServoRun::Theory::kClosedForm);
  return run;
}

ServoSweep readSweep(const YamlNode& item, const Scene& scene, const std::filesystem::path& directory, Canonical& canonical) {
  YamlMap::Keys keys = kSceneKeys;
  keys.emplace_back("gains");
  const YamlMap map = YamlMap::item(item, keys, canonical);
  ServoSweep sweep;
  sweep.name = map.text("name", "a name");
  sweep.scene = readOverrides(map, scene, directory);
  checkLoop(item, "a sweep", sweep.scene, true);
  sweep.gains = readList(map, "gains", Allowed::aboveUpTo(0, kMaxGain, ""));
  if (!std::is_sorted(sweep.gains.begin(), sweep.gains.end(), std::less_equal<>())) {
    map.require("gains", "").fail("the gains do not ascend");
  }
  return sweep;
}

}  // namespace

ServoExperiment readServoExperiment(const YamlNode& root, const std::filesystem::path& directory) {
  Canonical canonical;
  const YamlMap map(root, {"format_version", "name", "experiment", "scene", "band", "steady", "runs", "sweeps"}, canonical);
  ServoExperiment experiment;
  map.integer("format_version", 1, kFormatVersion);
  experiment.name = map.text("name", "a name");
  map.choice("experiment", {"servo"});
  const Scene scene = readSceneOfKind(map, directory, Scene::Kind::kServo);
  readFields(map, kServoExperimentFields, experiment);

  const YamlNode runs = map.require("runs", kRuns);
  const std::vector<YamlNode> run_items = runs.items(kRuns);
  if (run_items.empty() || run_items.size() > kMaxRuns) runs.refuse(kRuns);
  canonical.open("runs");
  for (const YamlNode& item : run_items) {
    ServoRun run = readRun(item, scene, directory, canonical);
    for (const ServoRun& other : experiment.runs) {
      if (other.name == run.name) item.fail("an earlier run has the name " + run.name);
    }
    experiment.runs.push_back(std::move(run));
  }
  canonical.close();
  if (const std::optional<YamlNode> sweeps = map.find("sweeps")) {
    canonical.open("sweeps");
    for (const YamlNode& item : sweeps->items(kSweeps)) experiment.sweeps.push_back(readSweep(item, scene, directory, canonical));
    canonical.close();
  }
  return experiment;
}

}  // namespace taxelsim
