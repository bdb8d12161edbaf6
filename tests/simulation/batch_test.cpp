// An instance of a batch has the same bits whatever its slot, the batch size and the other instances.
#include "simulation/comparison.h"
#include "simulation/model_access.h"
#include "support/random_scene.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using support::Random;
using support::Touch;

constexpr double kDt = 0.01;  // s
constexpr std::uint64_t kSeed = 77;

// A sensor that uses damping, noise, a wide PSF and two patches.
Sensor busySensor(DepthSampling sampling = DepthSampling::kPoint) {
  Sensor sensor = support::gridSensor({.num_rows = 5, .num_cols = 7, .samples_per_taxel = 3, .law = {1.73e8, 1, 1e5}});
  support::addPatch(sensor, {{0.02, 0, 0}, axisAngle({0, 1, 0}, 0.1)});
  sensor.psf = gaussianPsf(0.8, 5);
  sensor.readout = support::paperReadout();
  sensor.readout.noise = 5;
  sensor.depth_sampling = sampling;
  return sensor;
}

struct Batch {
  std::vector<Object> objects;
  std::vector<Touch> first, second;  // two steps
  std::vector<float> loads;
};

Batch randomBatch(const Sensor& sensor, int num_instances) {
  Random random(21);
  Batch batch;
  for (int n = 0; n < 6; ++n) {
    batch.objects.push_back(n % 2 ? support::randomSolid(random, 0.02) : support::randomMeshObject(random, 0.02));
  }
  for (int i = 0; i < num_instances; ++i) {
    Touch touch;
    for (int slot = 0; slot < 2; ++slot) {
      const int id = random.integer(0, 5);
      touch.ids.push_back(id);
      touch.X_SO.push_back(support::randomContact(random, sensor, batch.objects[id]));
    }
    batch.first.push_back(touch);
    for (Pose& X_SO : touch.X_SO) {
      X_SO.position[2] -= 0.1e-3;
    }
    batch.second.push_back(touch);
    batch.loads.push_back(i % 4 == 3 ? static_cast<float>(random.uniform(0.1, 2)) : kPoseDriven);
  }
  return batch;
}

// Simulates the given instances in that order for two steps. Returns the bits of each after the second.
std::vector<std::vector<std::uint32_t>> runBatch(const Model& model, const Batch& batch, const std::vector<int>& instances) {
  const int n = static_cast<int>(instances.size());
  Simulator simulator(model, {.num_instances = n, .num_slots = 2, .seed = kSeed});
  std::vector<float> loads;
  std::vector<Touch> first, second;
  for (int i = 0; i < n; ++i) {
    simulator.reset(i, 1000 + static_cast<std::uint64_t>(instances[i]), {.gain = 1.1f, .gain_spread = 0.1f, .noise = 3});
    first.push_back(batch.first[instances[i]]);
    second.push_back(batch.second[instances[i]]);
    loads.push_back(batch.loads[instances[i]]);
  }
  support::stepOnce(simulator, first, kDt, loads);
  const FrameView frame = support::stepOnce(simulator, second, kDt);
  support::expectWellFormed(frame, model.sensor(), n);
  return support::bitsOfAll(frame, n);
}

TEST(BatchOnEveryDriver, InstanceInABatchEqualsItAlone) {
  constexpr int kNumInstances = 37;
  const Sensor sensor = busySensor();
  const Batch batch = randomBatch(sensor, kNumInstances);
  const Model model(support::sharedDevice(), {.sensor = sensor, .objects = batch.objects});
  std::vector<int> all(kNumInstances);
  for (int i = 0; i < kNumInstances; ++i) {
    all[i] = i;
  }
  const auto together = runBatch(model, batch, all);
  std::vector<int> backwards(all.rbegin(), all.rend());
  const auto reversed = runBatch(model, batch, backwards);
  for (int i = 0; i < kNumInstances; ++i) {
    EXPECT_EQ(together[i], reversed[kNumInstances - 1 - i]) << "instance " << i;
    EXPECT_EQ(together[i], runBatch(model, batch, {i})[0]) << "instance " << i;
  }
  EXPECT_NE(together[0], together[1]);
}

TEST(BatchOnEveryDriver, AreaSampling) {
  const Sensor sensor = busySensor(DepthSampling::kArea);
  const Batch batch = randomBatch(sensor, 9);
  const std::vector<int> all{0, 1, 2, 3, 4, 5, 6, 7, 8};
  const Model model(support::sharedDevice(), {.sensor = sensor, .objects = batch.objects});
  const auto together = runBatch(model, batch, all);
  for (const int i : all) EXPECT_EQ(together[i], runBatch(model, batch, {i})[0]) << "instance " << i;
  const Model wider(support::sharedDevice(), {.sensor = sensor, .objects = batch.objects, .contact_workgroup = 32});
  EXPECT_EQ(together, runBatch(wider, batch, all));
}

TEST(BatchOnEveryDriver, IndependentOfWorkgroupSize) {
  const Sensor sensor = busySensor();
  const Batch batch = randomBatch(sensor, 9);
  const std::vector<int> all{0, 1, 2, 3, 4, 5, 6, 7, 8};
  const auto bits = [&](int contact_workgroup, int image_workgroup) {
    const Model model(
        support::sharedDevice(),
        {.sensor = sensor, .objects = batch.objects, .contact_workgroup = contact_workgroup, .image_workgroup = image_workgroup});
    return runBatch(model, batch, all);
  };
  const auto expected = bits(8, 8);
  EXPECT_EQ(bits(32, 64), expected);
  EXPECT_EQ(bits(128, 16), expected);
}

TEST(BatchOnEveryDriver, IndependentOfTuning) {
  const Sensor sensor = busySensor();
  const Batch batch = randomBatch(sensor, 9);
  const std::vector<int> all{0, 1, 2, 3, 4, 5, 6, 7, 8};
  const auto bits = [&](const Tuning& tuning) {
    const Model model =
        ModelAccess::make(support::sharedDevice(), {.sensor = sensor, .objects = batch.objects, .image_workgroup = 16}, tuning);
    return runBatch(model, batch, all);
  };
  const auto expected = bits({});
  EXPECT_EQ(bits({.contact_repeat = 1, .image_team = 1, .image_repeat = 1, .groups_per_batch = 16}), expected);
  EXPECT_EQ(bits({.contact_repeat = 4, .image_team = 16, .image_repeat = 2, .groups_per_batch = 64}), expected);
}

// A dispatch that exceeds the limit of one dimension uses two, with surplus workgroups.
TEST(BatchOnEveryDriver, DispatchesOverTwoDimensions) {
  constexpr int kMany = 65'535 + 10, kFew = 16;
  const Sensor sensor = support::gridSensor({.num_rows = 2, .num_cols = 2, .samples_per_taxel = 1});
  const Model model =
      ModelAccess::make(support::sharedDevice(), {.sensor = sensor, .objects = {Object("ball", Sphere{0.01})}}, {.contact_repeat = 1});
  const auto features = [&](int num_instances) {
    Simulator simulator(model, {.num_instances = num_instances});
    std::vector<Pose> X_SO;
    for (int i = 0; i < num_instances; ++i) X_SO.push_back({.position = {0, 0, 0.01 - 1e-4 * (i % kFew)}});
    simulator.setObjects(std::vector<int>(X_SO.size(), 0), X_SO);
    const std::span<const float> forces = support::stepOnce(simulator, kDt).ground_truth.total_force;
    return std::vector<float>(forces.begin(), forces.end());
  };
  const std::vector<float> few = features(kFew), many = features(kMany);
  EXPECT_GT(few.back(), 0);
  for (std::size_t i = 0; i < many.size(); ++i) ASSERT_EQ(many[i], few[i % kFew]) << "instance " << i;
}

TEST(BatchOnEveryDriver, NoiseIsKeyedByEpisodeAndSeedNotBySlot) {
  const Sensor sensor = busySensor();
  const std::vector<Object> objects{Object(Sphere{0.01})};
  const Model model(support::sharedDevice(), {.sensor = sensor, .objects = objects});
  const Touch touch{{0}, {{.position = {0, 0, 0.009}}}};
  const auto image = [&](std::uint64_t seed, const std::vector<std::uint64_t>& episodes) {
    Simulator simulator(model, {.num_instances = 3, .seed = seed});
    support::setTouches(simulator, {touch, touch, touch});
    for (int i = 0; i < 3; ++i) {
      simulator.reset(i, episodes[i]);
    }
    const FrameView frame = support::stepOnce(simulator, kDt);
    std::vector<std::vector<std::uint32_t>> bits;
    for (int i = 0; i < 3; ++i) {
      bits.push_back(support::measuredBitsOf(frame, i, 3));
    }
    return bits;
  };
  const auto a = image(1, {5, 6, 5}), b = image(1, {6, 5, 0x100000005u}), c = image(2, {5, 6, 5});
  EXPECT_EQ(a[0], a[2]);
  EXPECT_EQ(a[0], b[1]);
  EXPECT_EQ(a[1], b[0]);
  EXPECT_NE(a[0], a[1]);
  EXPECT_NE(a[0], b[2]);  // episodes are 64 bits
  EXPECT_NE(a[0], c[0]);
}

// Instances with one object and no state compute heights and forces in one loop, as long as no instance of the batch has a second near
// object or a load; otherwise heights go through the tile. The bits must be the same.
void expectEqualWithSecondObjectOrLoad(const std::vector<Object>& objects, const OutputOptions& outputs = {}) {
  constexpr int kNumInstances = 48;
  const Sensor sensor = support::gridSensor();
  Random random(3);
  std::vector<Touch> touches;
  for (int i = 0; i < kNumInstances; ++i) {
    const int id = i % static_cast<int>(objects.size());
    touches.push_back({{id}, {support::randomContact(random, sensor, objects[id])}});
  }
  const Model model(support::sharedDevice(), {.sensor = sensor, .objects = objects});
  const auto bits = [&](int num_slots, float load_of_the_first) {
    Simulator simulator(model, {.num_instances = kNumInstances, .num_slots = num_slots, .outputs = outputs});
    std::vector<Touch> padded = touches;
    for (Touch& touch : padded) {
      touch.ids.resize(num_slots, kNoObject);
      touch.X_SO.resize(num_slots);
    }
    if (num_slots > 1) padded[0] = {{0, 0}, {touches[0].X_SO[0], touches[0].X_SO[0]}};
    std::vector<float> loads(kNumInstances, kPoseDriven);
    loads[0] = load_of_the_first;
    const FrameView frame = support::stepOnce(simulator, padded, kDt, loads);
    std::vector<std::vector<std::uint32_t>> others;
    for (int i = 1; i < kNumInstances; ++i) {
      others.push_back(support::bitsOf(frame, i, kNumInstances));
    }
    return others;
  };
  const auto without = bits(1, kPoseDriven);
  EXPECT_EQ(bits(2, kPoseDriven), without) << "with a second object in another instance";
  EXPECT_EQ(bits(1, 1.0f), without) << "with a load in another instance";
}

TEST(BatchOnEveryDriver, PolyhedronIndependentOfOtherSlotsAndLoads) {
  Random random(3);
  const Object polyhedron = support::randomPolyhedron(random, 0.02);
  expectEqualWithSecondObjectOrLoad({polyhedron});
  expectEqualWithSecondObjectOrLoad({polyhedron}, {.tactile_jacobian = true, .clean_tactile_jacobian = true});
}

TEST(BatchOnEveryDriver, SolidsIndependentOfOtherSlotsAndLoads) {
  expectEqualWithSecondObjectOrLoad({Object("sphere", Sphere{0.008})});
  expectEqualWithSecondObjectOrLoad({Object("cylinder", Cylinder{0.006, 0.02}), Object("capsule", Capsule{0.005, 0.01}),
                                     Object("box", Box{{0.008, 0.006, 0.01}}), Object("cone", Cone{0.008, 0.012}),
                                     Object("half_space", HalfSpace{})});
}

TEST(BatchOnEveryDriver, EmptySlotsAndFarObjectsGiveZero) {
  const Sensor sensor = support::gridSensor();
  Random random(2);
  const std::vector<Object> objects{Object(Sphere{0.005}), Object("soup", support::triangleSoup(40, 0.01, random)), Object(HalfSpace{})};
  Simulator simulator = support::makeSimulator(sensor, objects, {.num_instances = 7, .num_slots = 2});
  const Pose near{.position = {0, 0, 0.0045}}, far_beside{.position = {1e3, -1e3, 0}}, far_above{.position = {0, 0, 100}};
  const FrameView frame = support::stepOnce(simulator,
                                            {{{kNoObject, kNoObject}, {Pose{}, Pose{}}},
                                             {{0, kNoObject}, {near, Pose{}}},
                                             {{kNoObject, 0}, {Pose{}, near}},
                                             {{0, 1}, {near, far_beside}},
                                             {{1, 0}, {far_above, near}},
                                             {{0, 0}, {far_beside, far_above}},
                                             {{2, 0}, {far_above, near}}},
                                            kDt);
  support::expectWellFormed(frame, sensor, 7);
  EXPECT_EQ(frame.ground_truth.total_force[0], 0);
  EXPECT_GT(frame.ground_truth.total_force[1], 0);
  for (const int same : {2, 3, 4, 6}) {
    EXPECT_EQ(support::bitsOf(frame, same, 7), support::bitsOf(frame, 1, 7)) << "instance " << same;
  }
  EXPECT_EQ(support::bitsOf(frame, 5, 7), support::bitsOf(frame, 0, 7));
}

TEST(BatchOnEveryDriver, NoContactBeforeObjectsAreSet) {
  const Sensor sensor = support::gridSensor();
  Simulator simulator = support::makeSimulator(sensor, {Object(HalfSpace{})}, {.num_instances = 2});
  const FrameView frame = support::stepOnce(simulator, kDt);
  support::expectWellFormed(frame, sensor, 2);
  EXPECT_EQ(frame.ground_truth.total_force[1], 0);
  EXPECT_EQ(*std::max_element(frame.tactile_image.begin(), frame.tactile_image.end()), 0u);
}

// Also if the second step needs other commands than the first.
TEST(BatchOnEveryDriver, RefusesAStepBeforeReadOfTheLast) {
  Simulator simulator = support::makeSimulator(support::gridSensor(), {Object(Sphere{0.01})});
  simulator.step(kDt);
  simulator.setLoad(0, 1.0f);
  EXPECT_THROW(simulator.step(kDt), std::logic_error);
  simulator.read();
  support::stepOnce(simulator, kDt);
}

TEST(BatchOnEveryDriver, SetsOneInstance) {
  const Sensor sensor = support::gridSensor();
  const Model model(support::sharedDevice(), {.sensor = sensor, .objects = {Object(Sphere{0.005}), Object(Sphere{0.008})}});
  const Touch a{{0}, {{.position = {0, 0, 0.0045}}}}, b{{1}, {{.position = {1e-3, 0, 0.0075}}}};
  Simulator at_once(model, {.num_instances = 2}), one_by_one(model, {.num_instances = 2});
  support::setTouches(at_once, {a, b});
  support::setTouches(one_by_one, {a, a});
  one_by_one.setObjects(1, b.ids, b.X_SO);
  at_once.step(kDt);
  const FrameView frame = at_once.read(), other = support::stepOnce(one_by_one, kDt);
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(support::bitsOf(frame, i, 2), support::bitsOf(other, i, 2));
  }
}

TEST(BatchOnEveryDriver, ReportsOverPenetration) {
  const Sensor sensor =
      support::gridSensor({.num_rows = 4, .num_cols = 6, .pitch_x = 1e-3, .pitch_y = 1e-3, .samples_per_taxel = 2, .thickness = 1e-3});
  Simulator simulator = support::makeSimulator(sensor, {Object(Box{{2e-3, 3e-3, 10e-3}})}, {.num_instances = 3});
  const auto at = [](double depth) { return Touch{{0}, {{.position = {0, 0.5e-3, 5e-3 - depth}}}}; };
  const FrameView frame = support::stepOnce(simulator, {at(0.9e-3), at(1.5e-3), at(9e-3)}, kDt);
  const double full = 1.73e8 * 1e-3 * 6e-6;  // 6 taxels of 1 mm^2 at full depth
  EXPECT_EQ(frame.ground_truth.over_penetration[0], 0);
  EXPECT_NEAR(frame.ground_truth.total_force[0], 0.9 * full, 1e-3 * full);
  for (const int i : {1, 2}) {
    EXPECT_NEAR(frame.ground_truth.over_penetration[i], 6.0 / 24, 4 * support::kUlp);
    EXPECT_NEAR(frame.ground_truth.total_force[i], full, 1e-5 * full);
  }
}

TEST(BatchOnEveryDriver, OutputsThatAreOffAreEmpty) {
  const Sensor sensor = support::gridSensor();
  const Model model(support::sharedDevice(), {.sensor = sensor, .objects = {Object(Sphere{0.005})}});
  Simulator lean(model, {.outputs = kNoOutputs}), full(model, {});
  for (Simulator* simulator : {&lean, &full}) {
    support::setTouches(*simulator, {{{0}, {{.position = {0, 0, 0.0045}}}}});
    simulator->step(kDt);
  }
  const FrameView a = lean.read(), b = full.read();
  EXPECT_TRUE(a.ground_truth.tactile_normal_force.empty());
  EXPECT_TRUE(a.ground_truth.tactile_shear_force.empty());
  EXPECT_TRUE(a.ground_truth.penetration_depth.empty());
  EXPECT_EQ(support::measuredBitsOf(a, 0, 1), support::measuredBitsOf(b, 0, 1));
  EXPECT_EQ(a.ground_truth.total_force[0], b.ground_truth.total_force[0]);
}

TEST(BatchOnEveryDriver, DeviceTimeIsOptionalAndChangesNoValue) {
  const Sensor sensor = support::gridSensor();
  const Model model(support::sharedDevice(), {.sensor = sensor, .objects = {Object(Sphere{0.005})}});
  Simulator without_clock(model, {}), with_clock(model, {.device_clock = true});
  for (Simulator* simulator : {&without_clock, &with_clock}) {
    support::setTouches(*simulator, {{{0}, {{.position = {0, 0, 0.0045}}}}});
    simulator->step(kDt);
  }
  EXPECT_EQ(support::bitsOf(without_clock.read(), 0, 1), support::bitsOf(with_clock.read(), 0, 1));
  EXPECT_TRUE(std::isnan(without_clock.timing().total));
  const StepTiming timing = with_clock.timing();
  EXPECT_GT(timing.contact, 0);
  EXPECT_GT(timing.image, 0);
  EXPECT_NEAR(timing.contact + timing.image, timing.total, 1e-9);
}

}  // namespace
}  // namespace taxelsim
