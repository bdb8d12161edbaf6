// The C++ side of bench/python/rates.py: the same loop of setObjects(), step() and read(). Prints frames/s.
//
//   simulator_rate OBJECT NUM_INSTANCES NUM_STEPS
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <vector>

#include "report.h"
#include "taxelsim/taxelsim.h"

namespace taxelsim::bench {
namespace {

constexpr double kStep = 0.001;        // s
constexpr double kDepth = 0.0005;      // m
constexpr double kDepthSpread = 1e-6;  // m per instance and step, modulo kNumDepths
constexpr int kNumDepths = 256;

// As in rates.py: the object lies with its lowest point in the skin, a little deeper in every instance and step.
std::vector<Pose> posesAt(int step, int num_instances, double height) {
  std::vector<Pose> poses(static_cast<std::size_t>(num_instances));
  for (int i = 0; i < num_instances; ++i) {
    const double depth = kDepth + kDepthSpread * ((i + step) % kNumDepths);
    poses[static_cast<std::size_t>(i)] = {{0, 0, height - depth}, axisAngle({1, 0, 0}, std::numbers::pi / 2)};
  }
  return poses;
}

double framesPerSecond(const std::string& object_text, int num_instances, int num_steps) {
  const Object object = parseObject(object_text);
  const Quaternion rotation = axisAngle({1, 0, 0}, std::numbers::pi / 2);
  const double height = -rotate(rotation, lowestPoint(object, rotation))[2];
  const Model model(Device::open(), {.sensor = loadSensor(TAXELSIM_SCENES "/sensors/wts0614_soft_cover.yaml"), .objects = {object}});
  Simulator simulator(model, {.num_instances = num_instances});
  simulator.prepare();
  const std::vector<int> ids(static_cast<std::size_t>(num_instances), 0);
  std::vector<std::vector<Pose>> poses;
  for (int step = 0; step < num_steps; ++step) poses.push_back(posesAt(step, num_instances, height));
  const auto run = [&](int step) {
    simulator.setObjects(ids, poses[static_cast<std::size_t>(step)]);
    simulator.step(kStep);
    return simulator.read().tactile_image.back();
  };
  for (int step = 0; step < num_steps; ++step) run(step);
  const Stopwatch stopwatch;
  for (int step = 0; step < num_steps; ++step) run(step);
  return static_cast<double>(num_instances) * num_steps / stopwatch.seconds();
}

}  // namespace
}  // namespace taxelsim::bench

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  try {
    std::printf("%.0f\n", taxelsim::bench::framesPerSecond(argv[1], std::atoi(argv[2]), std::atoi(argv[3])));
  } catch (const taxelsim::Error& error) {
    std::fprintf(stderr, "simulator_rate: %s\n", error.what());
    return 1;
  }
}
