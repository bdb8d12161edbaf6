// `taxelsim devices`: lists Vulkan devices, and the memory that a scene needs on each.
#include <spdlog/fmt/fmt.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/activity.h"
#include "cli/commands.h"
#include "cli/driver_advice.h"
#include "cli/print.h"
#include "cli/scene_options.h"
#include "episodes/batch.h"
#include "figures/text.h"
#include "generation/columns.h"
#include "taxelsim/device.h"
#include "taxelsim/model.h"
#include "taxelsim/scene.h"
#include "taxelsim/simulator.h"

namespace taxelsim::cli {

using namespace figures;

namespace {

constexpr std::uint64_t kPlannedMemory = std::uint64_t{1} << 30;  // bytes

struct DevicesArguments {
  std::string scene;
  SceneOverrides overrides{};
  bool json = false;
};

const char* nameOf(DeviceType type) {
  switch (type) {
    case DeviceType::kDiscrete:
      return "discrete";
    case DeviceType::kIntegrated:
      return "integrated";
    case DeviceType::kVirtual:
      return "virtual";
    case DeviceType::kCpu:
      return "cpu";
    case DeviceType::kOther:
      break;
  }
  return "other";
}

// Memory of a batch of the scene's episodes, by the simulator options of a run (generate); an instance may have several sensors.
MemoryPlan planFor(const DeviceInfo& info, const Scene& scene) {
  const Model model(Device::open({.device = std::to_string(info.index)}), modelOptionsOf(scene));
  const SlicePlan run(scene, outputsOf(scene));
  MemoryPlan plan = run.memory(model, 1);
  const auto num_sensors = static_cast<std::uint64_t>(run.num_sensors);
  plan.bytes_per_instance *= num_sensors;
  plan.max_instances /= num_sensors;
  return plan;
}

// Number of instances that fit into 1 GiB.
std::uint64_t instancesInPlannedMemory(const MemoryPlan& plan) {
  if (plan.bytes_per_instance == 0 || plan.bytes_fixed >= kPlannedMemory) return 0;
  return std::min((kPlannedMemory - plan.bytes_fixed) / plan.bytes_per_instance, plan.max_instances);
}

nlohmann::ordered_json asJson(const DeviceInfo& info) {
  return {{"index", info.index},
          {"name", info.name},
          {"type", nameOf(info.type)},
          {"driver", info.driver},
          {"advice", driverAdvice(info)},
          {"api_version", info.api_version},
          {"uuid", info.uuid},
          {"memory", info.memory},
          {"max_buffer", info.max_buffer},
          {"subgroup_size", info.subgroup_size},
          {"shared_memory", info.shared_memory}};
}

int runDevices(const DevicesArguments& arguments) {
  const std::vector<DeviceInfo> devices = listDevices();
  std::vector<MemoryPlan> plans;
  std::string title;
  if (!arguments.scene.empty()) {
    Activity activity("loading " + arguments.scene);
    const Scene scene = loadScene(arguments.scene, arguments.overrides);
    if (scene.condition != kNominalCondition) title = " (" + scene.condition + ")";
    for (const DeviceInfo& info : devices) plans.push_back(planFor(info, scene));
  }
  if (arguments.json) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (std::size_t i = 0; i < devices.size(); ++i) {
      list.push_back(asJson(devices[i]));
      if (!plans.empty())
        list.back()["plan"] = {{"bytes_per_instance", plans[i].bytes_per_instance},
                               {"bytes_fixed", plans[i].bytes_fixed},
                               {"max_instances_in_1_gib", instancesInPlannedMemory(plans[i])},
                               {"max_instances", plans[i].max_instances}};
    }
    printJsonText(list);
    return kExitOk;
  }
  std::vector<std::vector<std::string>> table{
      {"#", "device", "type", "driver", "Vulkan", "memory", "largest buffer", "shared", "subgroup"}};
  for (const DeviceInfo& info : devices)
    table.push_back({std::to_string(info.index), info.name, nameOf(info.type), info.driver, info.api_version, bytesText(info.memory),
                     bytesText(info.max_buffer), bytesText(info.shared_memory), std::to_string(info.subgroup_size)});
  printOut("{}", tableText(table));
  for (const DeviceInfo& info : devices) {
    if (const std::string advice = driverAdvice(info); !advice.empty()) printOut("{}\n", advice);
  }
  if (plans.empty()) return kExitOk;
  table = {{"#", "per instance", "fixed", "instances in 1 GiB", "instances on the device"}};
  for (std::size_t i = 0; i < devices.size(); ++i)
    table.push_back({std::to_string(devices[i].index), bytesText(plans[i].bytes_per_instance), bytesText(plans[i].bytes_fixed),
                     countText(instancesInPlannedMemory(plans[i])), countText(plans[i].max_instances)});
  printOut("\nMemory for {}{}\n{}", arguments.scene, title, tableText(table));
  return kExitOk;
}

}  // namespace

void addDevices(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("devices", "List the Vulkan devices, best first");
  command->footer("Example:\n  taxelsim devices --plan scenes/edge_servo.yaml");
  const auto arguments = std::make_shared<DevicesArguments>();
  CLI::Option* plan = command->add_option("--plan", arguments->scene, "Print the memory that a batch of this scene needs on each device")
                          ->type_name("SCENE");
  addConditionOption(*command, arguments->overrides)->needs(plan);
  command->add_flag("--json", arguments->json, "Print JSON, sizes in bytes");
  command->callback([arguments, &action] { action = [arguments] { return runDevices(*arguments); }; });
}

}  // namespace taxelsim::cli
