#include "scene/experiment_reader.h"
#include "scene/scene_checks.h"
#include "scene/sensor_file.h"

namespace taxelsim {

GraspExperiment readGraspExperiment(const YamlNode& root, const std::filesystem::path& directory) {
  Canonical canonical;
  const YamlMap map(root, {"format_version", "name", "experiment", "scene", "gains"}, canonical);
  GraspExperiment experiment;
  map.integer("format_version", 1, kFormatVersion);
  experiment.name = map.text("name", "a name");
  map.choice("experiment", {"grasp"});
  const YamlNode scene_node = map.require("scene", "a scene file");
  const std::filesystem::path scene_file = directory / scene_node.text("a scene file");
  experiment.scene = loadScene(scene_file);
  if (experiment.scene.kind != Scene::Kind::kGrasp)
    scene_node.fail(scene_file.generic_string() + " is a scene of kind " + wordOf(experiment.scene.kind) + ": one of kind grasp");
  experiment.gains = readList(map, "gains", Allowed::aboveUpTo(0, experiment.scene.simulation_rate, "1/s"));
  return experiment;
}

}  // namespace taxelsim
