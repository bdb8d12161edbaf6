#include "simulation/friction_paths.h"

namespace taxelsim::support {
namespace {

Pose nudged(Random& random, const Pose& X_SO, double size) {
  const Vector3 axis{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1) + 1e-3};
  Pose moved{X_SO.position, axisAngle(axis, random.uniform(-1, 1) * size / 0.01) * X_SO.rotation};
  for (double& coordinate : moved.position) coordinate += random.uniform(-1, 1) * size;
  return moved;
}

}  // namespace

Sensor frictionSensor() {
  Sensor sensor = gridSensor({.num_rows = 5, .num_cols = 7, .samples_per_taxel = 3, .law = {1.73e8, 1, 1e4}});
  sensor.patches.push_back(sensor.patches[0]);
  sensor.patches[1].name = "second";
  sensor.patches[1].X_SP = {{0.02, 0, 0}, axisAngle({0, 1, 0}, 0.1)};
  sensor.psf = gaussianPsf(0.8, 5);
  sensor.skin.friction = {0.4e8, 0.7};
  return sensor;
}

Sensor bristleSensor() {
  Sensor sensor = frictionSensor();
  sensor.skin.friction = {};
  sensor.skin.law = LuGre{.normal_contact_stiffness = 1.73e8};
  return sensor;
}

ObjectPaths randomPaths(const Sensor& sensor, int num_instances, int num_slots, bool with_loads, double step_size) {
  constexpr int kNumSteps = 6;
  Random random(8);
  ObjectPaths paths;
  for (int n = 0; n < 4; ++n) paths.objects.push_back(n % 2 ? randomSolid(random, 0.02) : randomMeshObject(random, 0.02));
  paths.touches.resize(kNumSteps);
  for (int i = 0; i < num_instances; ++i) {
    Touch touch;
    for (int slot = 0; slot < num_slots; ++slot) {
      touch.ids.push_back(random.integer(0, 3));
      touch.X_SO.push_back(randomContact(random, sensor, paths.objects[touch.ids.back()]));
    }
    for (std::vector<Touch>& step : paths.touches) {
      step.push_back(touch);
      for (Pose& X_SO : touch.X_SO) X_SO = nudged(random, X_SO, step_size);
    }
    paths.loads.push_back(with_loads && i % 3 == 2 ? static_cast<float>(random.uniform(0.1, 2)) : kPoseDriven);
  }
  return paths;
}

std::vector<std::vector<std::uint32_t>> runPaths(const Model& model, const ObjectPaths& paths, const std::vector<int>& instances,
                                                 const std::vector<double>& dt) {
  const int n = static_cast<int>(instances.size());
  Simulator simulator(model, {.num_instances = n, .num_slots = static_cast<int>(paths.touches[0][0].ids.size())});
  std::vector<std::vector<std::uint32_t>> bits(instances.size());
  for (int i = 0; i < n; ++i) simulator.setLoad(i, paths.loads[instances[i]]);
  for (std::size_t step = 0; step < paths.touches.size(); ++step) {
    std::vector<Touch> touches;
    for (const int instance : instances) touches.push_back(paths.touches[step][instance]);
    setTouches(simulator, touches);
    simulator.step(dt[step % dt.size()]);
    const FrameView frame = simulator.read();
    expectWellFormed(frame, model.sensor(), n);
    for (int i = 0; i < n; ++i) {
      const std::vector<std::uint32_t> now = bitsOf(frame, i, n);
      bits[i].insert(bits[i].end(), now.begin(), now.end());
    }
  }
  return bits;
}

std::vector<int> upTo(int count) {
  std::vector<int> numbers;
  for (int n = 0; n < count; ++n) numbers.push_back(n);
  return numbers;
}

}  // namespace taxelsim::support
