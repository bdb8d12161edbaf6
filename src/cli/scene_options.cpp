#include "cli/scene_options.h"

#include <CLI/CLI.hpp>

#include "cli/activity.h"
#include "cli/commands.h"

namespace taxelsim::cli {

void addSceneOptions(CLI::App& command, SceneOptions& options, int default_batch_size) {
  options.batch_size = default_batch_size;
  command.add_option("scene", options.scene, "Scene file (YAML)")->required()->type_name("SCENE");
  command.add_option("--episodes", options.overrides.num_episodes, "Number of episodes; default: the scene's")
      ->check(refuseNegative)
      ->check(silent(CLI::Range(std::uint64_t{1}, std::uint64_t{1} << 48)))
      ->type_name("N");
  command.add_option("--seed", options.overrides.seed, "Seed of all random numbers; default: the scene's")
      ->check(refuseNegative)
      ->type_name("S");
  addConditionOption(command, options.overrides);
  command.add_option("--batch-size", options.batch_size, "Number of instances simulated at once")
      ->check(silent(CLI::Range(1, 1 << 24)))
      ->capture_default_str()
      ->type_name("B");
  addDeviceOptions(command, options.device, options.validation);
}

CLI::Option* addConditionOption(CLI::App& command, SceneOverrides& overrides) {
  return command
      .add_option("--condition", overrides.condition,
                  "Condition of the scene: its overrides of sensor and randomization; nominal is the scene without them")
      ->capture_default_str()
      ->type_name("NAME");
}

void addDeviceOptions(CLI::App& command, std::string& device, bool& validation) {
  command
      .add_option("--device", device,
                  "Device: gpu, discrete, integrated, cpu, a number from `taxelsim devices`, or part of its name; default: the best")
      ->type_name("D");
  command.add_flag("--validation", validation, "Enable the Vulkan validation layers; slow");
}

Scene loadSceneOf(const SceneOptions& options) {
  const Activity activity("loading " + options.scene);
  return loadScene(options.scene, options.overrides);
}

Device openDevice(const SceneOptions& options) {
  return Device::open({.device = options.device, .validation = options.validation});
}

std::string sceneTitle(const Scene& scene) {
  return scene.condition == kNominalCondition ? scene.name : scene.name + " (" + scene.condition + ")";
}

}  // namespace taxelsim::cli
