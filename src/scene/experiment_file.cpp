#include "scene/experiment_reader.h"

#include <algorithm>
#include <array>

#include "scene/object_reader.h"
#include "scene/scene_checks.h"
#include "scene/scene_fields.h"
#include "scene/sensor_file.h"

namespace taxelsim {
namespace {

constexpr std::size_t kMaxValues = 1000;

void checkEntry(const YamlNode& item, const StaticExperiment::Entry& entry, const Sensor& reference) {
  if (numTaxels(entry.sensor) != numTaxels(reference)) {
    item.fail("has " + std::to_string(numTaxels(entry.sensor)) + " taxels, the reference " + std::to_string(numTaxels(reference)));
  }
  if (entry.fitted && !std::holds_alternative<Winkler>(entry.sensor.skin.law)) item.fail("only sensors of law winkler can be fitted");
  if (entry.fitted && (isTaxelList(entry.sensor) || entry.sensor.psf.sigma > 0)) {
    item.fail("only sensors whose point spread function is a kernel over grids can be fitted");
  }
}

}  // namespace

std::vector<double> readList(const YamlMap& map, std::string_view key, const Allowed& allowed) {
  const std::string what = "a list of 1 to " + std::to_string(kMaxValues) + " numbers";
  const YamlNode node = map.require(key, what);
  const std::vector<YamlNode> items = node.items(what);
  if (items.empty() || items.size() > kMaxValues) node.refuse(what);
  std::vector<double> values;
  for (const YamlNode& item : items) values.push_back(item.number(allowed));
  map.canonical().line(key, canonicalList(values));
  return values;
}

Scene readSceneOfKind(const YamlMap& map, const std::filesystem::path& directory, Scene::Kind kind) {
  const YamlNode node = map.require("scene", "a scene file");
  const std::filesystem::path file = directory / node.text("a scene file");
  Scene scene = loadScene(file);
  if (scene.kind != kind) node.fail(file.generic_string() + " is a scene of kind " + wordOf(scene.kind) + ": one of kind " + wordOf(kind));
  return scene;
}

StaticExperiment readStaticExperiment(const YamlNode& root, const std::filesystem::path& directory) {
  Canonical canonical;
  const YamlMap map(root, {"format_version", "name", "experiment", "reference", "sensors", "objects", "yaw[_deg]", "loads"}, canonical);
  StaticExperiment experiment;
  map.integer("format_version", 1, kFormatVersion);
  experiment.name = map.text("name", "a name");
  map.choice("experiment", {"static"});
  experiment.reference = readSensorBlock(map.require("reference", kSensorBlock), directory, canonical);
  const YamlNode sensors = map.require("sensors", "a list of {sensor, fitted}");
  canonical.open("sensors");
  for (const YamlNode& item : sensors.items("a list of {sensor, fitted}")) {
    const YamlMap entry_map = YamlMap::item(item, {"sensor", "fitted"}, canonical);
    StaticExperiment::Entry entry;
    entry.sensor = readSensorBlock(entry_map.require("sensor", kSensorBlock), directory, canonical);
    entry.fitted = entry_map.choice("fitted", {"true", "false"}, "false") == "true";
    checkEntry(item, entry, experiment.reference);
    experiment.sensors.push_back(std::move(entry));
  }
  canonical.close();
  if (experiment.sensors.empty()) sensors.refuse("a list of at least one {sensor, fitted}");
  double max_depth_error = maxDepthErrorOf(experiment.reference.skin);
  for (const StaticExperiment::Entry& entry : experiment.sensors)
    max_depth_error = std::min(max_depth_error, maxDepthErrorOf(entry.sensor.skin));
  experiment.objects = readObjects(map, directory, max_depth_error);
  const bool any_fitted = std::any_of(experiment.sensors.begin(), experiment.sensors.end(), [](const auto& entry) { return entry.fitted; });
  if (any_fitted && experiment.objects.size() < 2) {
    root.child("objects")->fail("has 1 indenter: a sensor with fitted: true needs 2, since a fit sees one half and the other is scored");
  }
  refuseMotions(map, "objects of a static experiment do not move");
  experiment.yaw = readList(map, "yaw", randomizationField("yaw").allowed);
  experiment.loads = readList(map, "loads", Allowed::above(0, "N"));
  return experiment;
}

StaticExperiment loadStaticExperiment(const std::filesystem::path& file) {
  return readVersionedFile(file, readStaticExperiment);
}

ServoExperiment loadServoExperiment(const std::filesystem::path& file) {
  return readVersionedFile(file, readServoExperiment);
}

GraspExperiment loadGraspExperiment(const std::filesystem::path& file) {
  return readVersionedFile(file, readGraspExperiment);
}

Experiment loadExperiment(const std::filesystem::path& file) {
  return readVersionedFile(file, [](const YamlNode& root, const std::filesystem::path& directory) -> Experiment {
    const std::optional<YamlNode> kind = root.child("experiment");
    if (!kind) root.fail("experiment is missing: static | servo | calibration | characterization | grasp");
    const std::string word = kind->choice(std::array<std::string_view, 5>{"static", "servo", "calibration", "characterization", "grasp"});
    if (word == "static") return readStaticExperiment(root, directory);
    if (word == "servo") return readServoExperiment(root, directory);
    if (word == "grasp") return readGraspExperiment(root, directory);
    if (word == "calibration") return readCalibrationExperiment(root, directory);
    return readCharacterizationExperiment(root, directory);
  });
}

}  // namespace taxelsim
