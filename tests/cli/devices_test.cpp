// `devices --plan`: memory by the options of a run.
#include <nlohmann/json.hpp>

#include "cli/command_line.h"
#include "support/test.h"
#include "taxelsim/device.h"
#include "taxelsim/model.h"
#include "taxelsim/scene.h"
#include "taxelsim/simulator.h"

namespace taxelsim::testing {
namespace {

// One servo loop with the measured Jacobian; the recorded columns need no further outputs.
const std::string kScene = "format_version: 1\nname: jacobian\nkind: servo\nsensor: " TAXELSIM_SOURCE_DIR
                           "/scenes/sensors/wts0614_soft_cover.yaml\n"
                           "objects: [{name: rod, cylinder: {radius_mm: 2, length_mm: 120}, edge: [0, 0, 1]}]\n"
                           "episode: {num_steps: 10, simulation_rate: 100}\nrandomization: {load: [1, 4]}\n"
                           "controllers: [{name: j, tactile_servo: {jacobian: measured, total_force: {kp: 2}}}]\n"
                           "record: [tactile_image]\ndata_set: {episodes: 10, seed: 1}\n";

TEST(DevicesPlan, CountsTheJacobianThatAControllerNeeds) {
  const TemporaryDirectory root;
  const std::string file = root / "scene.yaml";
  std::ofstream(file) << kScene;
  const Scene scene = loadScene(file);
  const Outcome outcome = succeed({"devices", "--plan", file, "--json"});
  ModelOptions options{.sensor = scene.sensor, .objects = {}};
  for (const SceneObject& object : scene.objects) options.objects.push_back(object.object);
  for (const nlohmann::json& device : nlohmann::json::parse(outcome.out)) {
    const Model model(Device::open({.device = std::to_string(device["index"].get<int>())}), options);
    OutputOptions outputs = kNoOutputs;
    const std::uint64_t without = Simulator::plan(model, {.outputs = outputs}).bytes_per_instance;
    outputs.tactile_jacobian = true;
    const MemoryPlan with = Simulator::plan(model, {.outputs = outputs});
    EXPECT_EQ(device["plan"]["bytes_per_instance"], with.bytes_per_instance);
    EXPECT_EQ(device["plan"]["bytes_fixed"], with.bytes_fixed);
    EXPECT_GT(with.bytes_per_instance, without);
  }
}

// The condition's creep adds state to every taxel.
TEST(DevicesPlan, CountsTheSensorOfACondition) {
  const TemporaryDirectory root;
  const std::string file = root / "scene.yaml";
  Sensor sensor = loadSensor(TAXELSIM_SOURCE_DIR "/scenes/sensors/wts0614_soft_cover.yaml");
  sensor.readout.creep.push_back({.fraction = 0.1, .time = 1});
  std::ofstream(root / "slow.yaml") << sensorText(sensor);
  std::ofstream(file) << kScene << "conditions: {slow: {sensor: slow.yaml}}\n";
  const auto bytes = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"devices", "--plan", file, "--json"});
    const Outcome outcome = succeed(arguments);
    return nlohmann::json::parse(outcome.out)[0]["plan"]["bytes_per_instance"].get<std::uint64_t>();
  };
  const std::uint64_t nominal = bytes({});
  EXPECT_EQ(bytes({"--condition", "nominal"}), nominal);
  EXPECT_GT(bytes({"--condition", "slow"}), nominal);
  const Outcome table = runTaxelsim({"devices", "--plan", file, "--condition", "slow"});
  EXPECT_THAT(table.out, ::testing::HasSubstr("scene.yaml (slow)"));
  const Outcome unknown = runTaxelsim({"devices", "--plan", file, "--condition", "fast"});
  EXPECT_EQ(unknown.status, 2);
  EXPECT_THAT(unknown.err, ::testing::HasSubstr("slow"));
  EXPECT_EQ(runTaxelsim({"devices", "--condition", "slow"}).status, 2) << "without --plan";
}

}  // namespace
}  // namespace taxelsim::testing
