#include "simulation/friction_paths.h"

#include "simulation/layer_scene.h"

namespace taxelsim::support {
namespace {

Pose nudged(Random& random, const Pose& X_SO, double size) {
  const Vector3 axis{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1) + 1e-3};
  Pose moved{X_SO.position, axisAngle(axis, random.uniform(-1, 1) * size / 0.01) * X_SO.rotation};
  for (double& coordinate : moved.position) coordinate += random.uniform(-1, 1) * size;
  return moved;
}

const std::vector<double> kStep{1e-3};  // s

std::vector<std::vector<std::uint32_t>> runPaths(Simulator& simulator, const ObjectPaths& paths, const std::vector<int>& instances,
                                                 const std::vector<double>& dt) {
  const int n = static_cast<int>(instances.size());
  std::vector<std::vector<std::uint32_t>> bits(instances.size());
  for (int i = 0; i < n; ++i) simulator.setLoad(i, paths.loads[instances[i]]);
  for (std::size_t step = 0; step < paths.touches.size(); ++step) {
    std::vector<Touch> touches;
    for (const int instance : instances) touches.push_back(paths.touches[step][instance]);
    const FrameView frame = stepOnce(simulator, touches, dt[step % dt.size()]);
    expectWellFormed(frame, simulator.model().sensor(), n);
    for (int i = 0; i < n; ++i) {
      const std::vector<std::uint32_t> now = bitsOf(frame, i, n);
      bits[i].insert(bits[i].end(), now.begin(), now.end());
    }
  }
  return bits;
}

}  // namespace

Sensor frictionSensor() {
  Sensor sensor = gridSensor({.num_rows = 5, .num_cols = 7, .samples_per_taxel = 3, .law = {1.73e8, 1, 1e4}});
  addPatch(sensor, {{0.02, 0, 0}, axisAngle({0, 1, 0}, 0.1)});
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

ObjectPaths layerPaths(const Sensor& sensor, int num_slots) {
  constexpr int kNumSteps = 3;
  constexpr double kLength = 0.012, kReach = 1.7e-3;  // m
  Random random(16);
  ObjectPaths paths{roundObjects(random), std::vector<std::vector<Touch>>(kNumSteps), {}};
  const bool has_cells = sensor.depth_sampling == DepthSampling::kArea;
  if (has_cells) paths.objects = {Cylinder{1e-3, kLength}, Box{{0.9e-3, 3e-3, kLength}}};
  for (const float load : {kPoseDriven, 2.0f, kPoseDriven, 0.5f, kPoseDriven}) {
    paths.loads.push_back(load);
    Touch touch;
    for (std::vector<Touch>& step : paths.touches) {
      if (touch.ids.empty() || random.chance(0.2)) touch = randomTouch(random, sensor, paths.objects, num_slots);
      for (Pose& X_SO : touch.X_SO) {
        if (has_cells) X_SO = {{random.uniform(-kReach, kReach), random.uniform(-kReach, kReach), kLength / 2 - 0.5e-3}, {1, 0, 0, 0}};
        X_SO = nextPose(random, X_SO, 0.2e-3);
      }
      step.push_back(touch);
    }
  }
  return paths;
}

std::vector<std::vector<std::uint32_t>> runPaths(const Model& model, const ObjectPaths& paths, const std::vector<int>& instances,
                                                 const std::vector<double>& dt, const OutputOptions& outputs) {
  Simulator simulator(model, {.num_instances = static_cast<int>(instances.size()),
                              .num_slots = static_cast<int>(paths.touches[0][0].ids.size()),
                              .outputs = outputs});
  return runPaths(simulator, paths, instances, dt);
}

void expectIndependentOfBatch(const Sensor& sensor, const ObjectPaths& paths, const std::vector<Workgroups>& workgroups,
                              const OutputOptions& outputs) {
  const int n = static_cast<int>(paths.loads.size());
  const std::vector<int> all = upTo(n), backwards(all.rbegin(), all.rend());
  std::vector<std::vector<std::uint32_t>> expected;
  for (const auto& [contact, image] : workgroups) {
    const Model model(sharedDevice(), {.sensor = sensor, .objects = paths.objects, .contact_workgroup = contact, .image_workgroup = image});
    Simulator together(model, {.num_instances = n, .num_slots = static_cast<int>(paths.touches[0][0].ids.size()), .outputs = outputs});
    const auto found = runPaths(together, paths, all, kStep);
    if (!expected.empty()) {
      EXPECT_EQ(found, expected) << "workgroups " << contact << " and " << image;
      continue;
    }
    expected = found;
    for (int i = 0; i < n; ++i) together.reset(i, 0);
    EXPECT_EQ(runPaths(together, paths, all, kStep), expected) << "after a reset";
    const auto reversed = runPaths(model, paths, backwards, kStep, outputs);
    for (int i = 0; i < n; ++i) EXPECT_EQ(reversed[n - 1 - i], expected[i]) << "in reverse order: instance " << i;
    for (const int i : {0, 1, 2}) EXPECT_EQ(runPaths(model, paths, {i}, kStep, outputs)[0], expected[i]) << "alone: instance " << i;
  }
}

std::vector<int> upTo(int count) {
  std::vector<int> numbers;
  for (int n = 0; n < count; ++n) numbers.push_back(n);
  return numbers;
}

}  // namespace taxelsim::support
