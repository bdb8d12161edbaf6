// Shear of the law `elastic_layer` on the device: general properties. Closed forms: friction_test.cpp; against the twin:
// layer_shear_twin_test.cpp.
#include "simulation/layer_scene.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using support::layerSensor;
using support::Random;
using support::Touch;

constexpr double kDt = 1e-3;  // s

// Random paths of a batch, some instances under a load.
struct Paths {
  std::vector<Object> objects;
  std::vector<std::vector<Touch>> touches;  // (steps x instances)
  std::vector<float> loads;
};

Paths randomPaths(const Sensor& sensor, int num_instances, int num_slots) {
  Random random(12);
  Paths paths{support::roundObjects(random), std::vector<std::vector<Touch>>(3), {}};
  for (int i = 0; i < num_instances; ++i) {
    Touch touch;
    for (int slot = 0; slot < num_slots; ++slot) {
      const Touch one = support::randomTouch(random, sensor, paths.objects);
      touch.ids.push_back(one.ids[0]);
      touch.X_SO.push_back(one.X_SO[0]);
    }
    for (std::vector<Touch>& step : paths.touches) {
      step.push_back(touch);
      for (Pose& X_SO : touch.X_SO) X_SO = support::nextPose(random, X_SO, 0.1e-3);
    }
    paths.loads.push_back(i % 2 == 1 ? static_cast<float>(random.uniform(0.1, 2)) : kPoseDriven);
  }
  return paths;
}

// Simulates the given instances along their paths. Returns the bits of each after every step.
std::vector<std::vector<std::uint32_t>> bitsAlong(const Model& model, const Paths& paths, const std::vector<std::size_t>& instances,
                                                  double dt = kDt) {
  const int n = static_cast<int>(instances.size());
  Simulator simulator(model, {.num_instances = n, .num_slots = static_cast<int>(paths.touches[0][0].ids.size())});
  std::vector<std::vector<std::uint32_t>> bits(instances.size());
  for (int i = 0; i < n; ++i) simulator.setLoad(i, paths.loads[instances[static_cast<std::size_t>(i)]]);
  for (const std::vector<Touch>& all : paths.touches) {
    std::vector<Touch> touches;
    for (const std::size_t instance : instances) touches.push_back(all[instance]);
    support::setTouches(simulator, touches);
    simulator.step(dt);
    const FrameView frame = simulator.read();
    for (int i = 0; i < n; ++i) {
      const std::vector<std::uint32_t> now = support::bitsOf(frame, i, n);
      bits[static_cast<std::size_t>(i)].insert(bits[static_cast<std::size_t>(i)].end(), now.begin(), now.end());
    }
  }
  return bits;
}

Sensor slippingSensor(int samples = 2) {
  Sensor sensor = layerSensor({.margin = 2e-3, .iterations = 10, .tolerance = 1e-3}, {.samples_per_taxel = samples});
  sensor.skin.friction = {1e9, 0.6};
  return sensor;
}

TEST(ElasticLayerShear, IndependentOfBatchWorkgroupAndSpeed) {
  for (const int num_slots : {1, 2}) {
    const Sensor sensor = slippingSensor();
    const Paths paths = randomPaths(sensor, 5, num_slots);
    const auto model = [&](int workgroup) {
      return Model(support::sharedDevice(), {.sensor = sensor, .objects = paths.objects, .contact_workgroup = workgroup});
    };
    const Model usual = model(8);
    const auto together = bitsAlong(usual, paths, {0, 1, 2, 3, 4});
    EXPECT_EQ(bitsAlong(model(64), paths, {0, 1, 2, 3, 4}), together);
    EXPECT_EQ(bitsAlong(usual, paths, {0, 1, 2, 3, 4}, 3.0), together);
    const auto reversed = bitsAlong(usual, paths, {4, 3, 2, 1, 0});
    for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(reversed[4 - i], together[i]) << "instance " << i;
    EXPECT_EQ(bitsAlong(usual, paths, {1})[0], together[1]);
  }
}

// |shear| <= mu normal force per taxel at any stiffness.
TEST(ElasticLayerShear, StaysInsideTheCone) {
  constexpr double kSums = 300 * support::kUlp;  // of a few products, and a word that gives its last bits to the slot
  for (const int num_slots : {1, 2}) {
    for (const double stiffness : num_slots == 1 ? std::vector<double>{1e9} : std::vector<double>{1e3, 1e15}) {
      Sensor sensor = slippingSensor();
      sensor.skin.friction = {stiffness, 0.3};
      sensor.psf = gaussianPsf(0.8, 3);
      const Paths paths = randomPaths(sensor, 4, num_slots);
      const Model model(support::sharedDevice(), {.sensor = sensor, .objects = paths.objects});
      Simulator simulator(model, {.num_instances = 4, .num_slots = num_slots});
      simulator.setLoads(paths.loads);
      for (const std::vector<Touch>& touches : paths.touches) {
        support::setTouches(simulator, touches);
        simulator.step(kDt);
        const GroundTruthView truth = simulator.read().ground_truth;
        const auto normal = truth.tactile_normal_force, shear = truth.tactile_shear_force;
        std::size_t num_outside = 0;
        for (std::size_t t = 0; t < normal.size(); ++t) {
          num_outside += std::hypot(shear[2 * t], shear[2 * t + 1]) > 0.3 * normal[t] * (1 + kSums) ? 1 : 0;
        }
        EXPECT_EQ(num_outside, 0u) << stiffness;
        for (std::size_t i = 0; i < 4; ++i) {
          const auto wrench = truth.contact_wrench.subspan(6 * i, 6);
          EXPECT_LE(std::hypot(wrench[0], wrench[1]), -0.3 * wrench[2] * (1 + kSums));
        }
      }
    }
  }
}

TEST(ElasticLayerShear, NewObjectsAndEpisodesBeginWithoutShear) {
  const Sensor sensor = slippingSensor();
  const Model model(support::sharedDevice(), {.sensor = sensor, .objects = {Object(Sphere{0.01}), Object(Sphere{0.01})}});
  for (const int num_slots : {1, 2}) {
    const auto shearAfter = [&](const auto& meddle) {
      Simulator simulator(model, {.num_slots = num_slots});
      Touch touch{{0}, {{.position = {0, 0, 0.0095}}}};
      touch.ids.resize(static_cast<std::size_t>(num_slots), kNoObject);
      touch.X_SO.resize(static_cast<std::size_t>(num_slots));
      for (int step = 0; step < 3; ++step) {
        if (step > 0) touch.X_SO[0].position[0] += 0.02e-3;
        if (step == 2) meddle(simulator, touch);
        support::setTouches(simulator, {touch});
        simulator.step(kDt);
        simulator.read();
      }
      return simulator.read().ground_truth.contact_wrench[0];
    };
    EXPECT_GT(shearAfter([](Simulator&, Touch&) {}), 0.1f);
    EXPECT_EQ(shearAfter([](Simulator& simulator, Touch&) { simulator.reset(0, 1); }), 0);
    EXPECT_EQ(shearAfter([](Simulator&, Touch& touch) { touch.ids[0] = 1; }), 0);
    if (num_slots > 1) {
      EXPECT_EQ(shearAfter([](Simulator&, Touch& touch) {
                  std::swap(touch.ids[0], touch.ids[1]);
                  std::swap(touch.X_SO[0], touch.X_SO[1]);
                }),
                0);
    }
  }
}

// Separation releases the springs.
TEST(ElasticLayerShear, SeparationClearsShear) {
  const Sensor sensor = slippingSensor();
  const Model model(support::sharedDevice(), {.sensor = sensor, .objects = {Object(Sphere{0.01})}});
  Simulator simulator(model, {});
  std::vector<float> shear;
  for (const auto& [x, z] : std::vector<std::array<double, 2>>{{0, 0.0095}, {0.1e-3, 0.0095}, {0.1e-3, 0.012}, {0.1e-3, 0.0095}}) {
    support::setTouches(simulator, {{{0}, {{.position = {x, 0, z}}}}});
    simulator.step(kDt);
    shear.push_back(simulator.read().ground_truth.contact_wrench[0]);
  }
  EXPECT_EQ(shear[0], 0);
  EXPECT_GT(shear[1], 0.1f);
  EXPECT_EQ(shear[2], 0);
  EXPECT_EQ(shear[3], 0);
}

// Without a margin the shear of the wrench is the sum over the taxels, and the PSF keeps that sum.
TEST(ElasticLayerShear, WrenchIsTheSumOverTheTaxels) {
  for (const int size : {1, 5}) {
    Sensor sensor = layerSensor({.iterations = 10, .tolerance = 1e-3}, {.num_rows = 5, .num_cols = 8, .samples_per_taxel = 2});
    sensor.skin.friction = {1e9, 0.6};
    if (size > 1) sensor.psf = gaussianPsf(0.7, size);
    const Model model(support::sharedDevice(), {.sensor = sensor, .objects = {Object(Sphere{0.02})}});
    Simulator simulator(model, {});
    for (const double slide : {0.0, 0.03e-3, 0.06e-3}) {
      support::setTouches(simulator, {{{0}, {{.position = {-7e-3 + slide, 2e-3 + slide / 3, 0.0195}}}}});
      simulator.step(kDt);
      simulator.read();
    }
    const GroundTruthView truth = simulator.read().ground_truth;
    for (std::size_t axis = 0; axis < 2; ++axis) {
      double sum = 0;
      for (std::size_t t = 0; t < truth.tactile_normal_force.size(); ++t) sum += truth.tactile_shear_force[2 * t + axis];
      EXPECT_GT(sum, 0.05);
      EXPECT_NEAR(truth.contact_wrench[axis] / sum, 1, 300 * support::kUlp) << size;
    }
  }
}

// Slid far under a load along the border: the whole contact slips, also on the margin.
TEST(ElasticLayerShearOnEveryDriver, SlidingLoadShearsWithMuTimesTheLoad) {
  constexpr double kLoad = 3, kMu = 0.6;
  const Sensor sensor = slippingSensor();
  const Model model(support::sharedDevice(), {.sensor = sensor, .objects = {Object(Sphere{0.02})}});
  Simulator simulator(model, {});
  simulator.setLoad(0, static_cast<float>(kLoad));
  for (int n = 0; n < 30; ++n) {
    support::setTouches(simulator, {{{0}, {{.position = {0.1e-3 * n, 0.0235, 0.03}}}}});
    simulator.step(kDt);
    const GroundTruthView truth = simulator.read().ground_truth;
    const auto wrench = truth.contact_wrench;
    EXPECT_GT(truth.off_array_load[0], 0.1 * kLoad);
    EXPECT_NEAR(wrench[2], -kLoad, 1e-3 * kLoad);
    // Springs at the leading edge may still stick; they carry little.
    if (n > 20) {
      EXPECT_NEAR(wrench[0], kMu * kLoad, 0.01 * kLoad) << n;
    }
  }
}

TEST(ElasticLayerShear, ObjectAtRestDoesNotCreep) {
  const Sensor sensor = slippingSensor();
  const Model model(support::sharedDevice(), {.sensor = sensor, .objects = {Object(Sphere{0.01})}});
  Simulator simulator(model, {.num_instances = 2});
  simulator.setLoad(1, 2.0f);
  Pose X_SO{{4e-3, 17e-3, 0.0094}, axisAngle({1, 2, 3}, 1.1)};
  const auto shearAt = [&] {
    support::setTouches(simulator, {{{0}, {X_SO}}, {{0}, {X_SO}}});
    simulator.step(kDt);
    const auto wrench = simulator.read().ground_truth.contact_wrench;
    return std::array<float, 2>{wrench[0], wrench[6]};
  };
  shearAt();
  X_SO.position[0] += 0.01e-3;
  const auto slid = shearAt();
  // Pressures converge within the tolerance of the solver, relative to the total force, and so does the offset of a load.
  for (int n = 0; n < 50; ++n) {
    const auto now = shearAt();
    for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(now[i] / slid[i], 1, 1e-3) << "step " << n;
  }
}

}  // namespace
}  // namespace taxelsim
