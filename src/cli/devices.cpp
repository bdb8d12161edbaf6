// `taxelsim devices`: what taxelsim can run on, and what a scene would take there.
#include <spdlog/fmt/fmt.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/commands.h"
#include "cli/driver_advice.h"
#include "figures/text.h"
#include "taxelsim/device.h"
#include "taxelsim/generate.h"
#include "taxelsim/model.h"
#include "taxelsim/scene.h"
#include "taxelsim/simulator.h"

namespace taxelsim::cli {
namespace {

constexpr std::uint64_t kPlannedMemory = std::uint64_t{1} << 30;  // bytes

struct Arguments {
  std::string scene;
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

MemoryPlan planFor(const DeviceInfo& info, const Scene& scene) {
  ModelOptions options{.sensor = scene.sensor, .objects = {}};
  for (const SceneObject& object : scene.objects) options.objects.push_back(object.object);
  const Model model(Device::open({.device = std::to_string(info.index)}), options);
  const auto records = [&](const char* name) { return std::find(scene.record.begin(), scene.record.end(), name) != scene.record.end(); };
  return Simulator::plan(model, {.outputs = {.tactile_normal_force = records("tactile_normal_force"),
                                             .tactile_shear_force = records("tactile_shear_force"),
                                             .penetration_depth = records("penetration_depth"),
                                             .contact_features = records("contact_features"),
                                             .clean_contact_features = records("clean_contact_features"),
                                             .tactile_jacobian = records("tactile_jacobian"),
                                             .clean_tactile_jacobian = records("clean_tactile_jacobian")},
                                 .max_regions = scene.max_regions});
}

// Instances that 1 GiB of the device would hold.
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

int runDevices(const Arguments& arguments) {
  const std::vector<DeviceInfo> devices = listDevices();
  std::vector<MemoryPlan> plans;
  if (!arguments.scene.empty()) {
    const Scene scene = loadScene(arguments.scene);
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
    fmt::print("{}\n", list.dump(2));
    return kExitOk;
  }
  std::vector<std::vector<std::string>> table{
      {"#", "device", "type", "driver", "Vulkan", "memory", "largest buffer", "shared", "subgroup"}};
  for (const DeviceInfo& info : devices)
    table.push_back({std::to_string(info.index), info.name, nameOf(info.type), info.driver, info.api_version, bytesText(info.memory),
                     bytesText(info.max_buffer), bytesText(info.shared_memory), std::to_string(info.subgroup_size)});
  fmt::print("{}", tableText(table));
  for (const DeviceInfo& info : devices) {
    if (const std::string advice = driverAdvice(info); !advice.empty()) fmt::print("{}\n", advice);
  }
  if (plans.empty()) return kExitOk;
  table = {{"#", "per instance", "fixed", "instances in 1 GiB", "instances on the device"}};
  for (std::size_t i = 0; i < devices.size(); ++i)
    table.push_back({std::to_string(devices[i].index), bytesText(plans[i].bytes_per_instance), bytesText(plans[i].bytes_fixed),
                     countText(instancesInPlannedMemory(plans[i])), countText(plans[i].max_instances)});
  fmt::print("\nMemory for {}\n{}", arguments.scene, tableText(table));
  return kExitOk;
}

}  // namespace

void addDevices(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("devices", "List the devices that taxelsim can run on, best first");
  command->footer("Example:\n  taxelsim devices --plan scenes/edge_servo.yaml");
  const auto arguments = std::make_shared<Arguments>();
  command->add_option("--plan", arguments->scene, "Say what a batch of this scene takes on each device")->type_name("SCENE");
  command->add_flag("--json", arguments->json, "Print JSON, sizes in bytes");
  command->callback([arguments, &action] { action = [arguments] { return runDevices(*arguments); }; });
}

}  // namespace taxelsim::cli
