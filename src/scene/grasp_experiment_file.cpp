#include "scene/experiment_reader.h"
#include "scene/sensor_file.h"

namespace taxelsim {

GraspExperiment readGraspExperiment(const YamlNode& root, const std::filesystem::path& directory) {
  Canonical canonical;
  const YamlMap map(root, {"format_version", "name", "experiment", "scene", "gains"}, canonical);
  GraspExperiment experiment;
  map.integer("format_version", 1, kFormatVersion);
  experiment.name = map.text("name", "a name");
  map.choice("experiment", {"grasp"});
  experiment.scene = readSceneOfKind(map, directory, Scene::Kind::kGrasp);
  experiment.gains = readList(map, "gains", Allowed::aboveUpTo(0, experiment.scene.simulation_rate, "1/s"));
  return experiment;
}

}  // namespace taxelsim
