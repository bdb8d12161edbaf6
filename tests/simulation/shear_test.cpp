// Properties of shear that hold for springs, bristles and an elastic layer, on one patch and over several.
#include "simulation/friction_paths.h"
#include "simulation/layer_scene.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using support::Touch;

constexpr double kDt = 1e-3;  // s
constexpr double kMu = 0.6;

struct Skin {
  std::string name;
  Sensor sensor;
  bool is_layer = false;
  double slide = 0.05e-3;  // m, in which springs bend and do not slip
  // Under a load that slides: shear over load from this step on, and errors of load and share.
  double share = kMu;
  int slips_from = 31;
  double load_error = 1e-4, share_error = 0.01;
};

void PrintTo(const Skin& skin, std::ostream* out) {
  *out << skin.name;
}

std::vector<Skin> skins() {
  Skin springs{"springs", support::gridSensor()}, bristles = springs, layer = springs;
  springs.sensor.skin.friction = {1e8, kMu};
  bristles = {.name = "bristles", .sensor = bristles.sensor, .slide = 5e-6, .share = 1.004, .slips_from = 1, .share_error = 2e-3};
  bristles.sensor.skin.law = LuGre{.normal_contact_stiffness = 1.73e8};
  layer.name = "layer";
  layer.sensor = support::layerSensor({.margin = 2e-3, .iterations = 10, .tolerance = 1e-3}, {.samples_per_taxel = 2});
  layer.sensor.skin.friction = {1e9, kMu};
  layer.is_layer = true;
  layer.slide = 0.01e-3;
  layer.load_error = 1e-3;
  std::vector<Skin> all{springs, bristles, layer};
  for (Skin skin : {springs, bristles}) {
    skin.name += " of two patches";
    support::addPatch(skin.sensor, {.position = {6 * 3.4e-3, 0, 0}});
    all.push_back(skin);
  }
  return all;
}

class ShearOnEveryDriver : public ::testing::TestWithParam<Skin> {};

INSTANTIATE_TEST_SUITE_P(Skins, ShearOnEveryDriver, ::testing::ValuesIn(skins()));

TEST_P(ShearOnEveryDriver, EndsWithSeparation) {
  Simulator simulator = support::makeSimulator(GetParam().sensor, {Object(Sphere{0.01})});
  std::vector<float> shear;
  for (const auto& [x, z] : std::vector<std::array<double, 2>>{{0, 0.0095}, {0.1e-3, 0.0095}, {0.1e-3, 0.0101}, {0.1e-3, 0.0095}}) {
    shear.push_back(support::stepOnce(simulator, {{{0}, {{.position = {x, 0, z}}}}}, kDt).ground_truth.contact_wrench[0]);
  }
  EXPECT_GT(shear[1], 0.1f);
  for (const std::size_t n : {0, 2, 3}) EXPECT_EQ(shear[n], 0) << n;
}

// Shear along x after a slide of 0.1 mm, N. `meddle` may change simulator or objects before the slide.
template <typename Meddle>
double shearAfterSlide(const Model& model, int num_slots, Meddle&& meddle) {
  Simulator simulator(model, {.num_slots = num_slots});
  Touch touch{{0}, {{.position = {0, 0, 0.0095}}}};
  touch.ids.resize(static_cast<std::size_t>(num_slots), kNoObject);
  touch.X_SO.resize(static_cast<std::size_t>(num_slots));
  support::stepOnce(simulator, {touch}, kDt);
  touch.X_SO[0].position[0] += 0.1e-3;
  meddle(simulator, touch);
  return support::stepOnce(simulator, {touch}, kDt).ground_truth.contact_wrench[0];
}

TEST_P(ShearOnEveryDriver, BeginsAtZeroForNewObjectsSlotsAndEpisodes) {
  const Model model(support::sharedDevice(), {.sensor = GetParam().sensor, .objects = {Object(Sphere{0.01}), Object(Sphere{0.01})}});
  for (const int num_slots : {1, 2}) {
    EXPECT_GT(shearAfterSlide(model, num_slots, [](Simulator&, Touch&) {}), 0.1);
    EXPECT_EQ(shearAfterSlide(model, num_slots, [](Simulator& simulator, Touch&) { simulator.reset(0, 1); }), 0);
    EXPECT_EQ(shearAfterSlide(model, num_slots, [](Simulator&, Touch& touch) { touch.ids[0] = 1; }), 0);
  }
  EXPECT_EQ(shearAfterSlide(
                model, 2, [](Simulator&, Touch& touch) { std::swap(touch.ids[0], touch.ids[1]), std::swap(touch.X_SO[0], touch.X_SO[1]); }),
            0);
}

// Slid far under a load along x, on a layer along its border: the whole contact slips. Springs at the leading edge may still stick; they
// carry little.
TEST_P(ShearOnEveryDriver, IsMuTimesASlidingLoad) {
  constexpr double kLoad = 3;
  const Skin& skin = GetParam();
  Simulator simulator = support::makeSimulator(skin.sensor, {Object(Sphere{0.02})});
  simulator.setLoad(0, static_cast<float>(kLoad));
  for (int n = 0; n < 40; ++n) {
    const Pose X_SO{.position = {0.1e-3 * n, skin.is_layer ? 0.0235 : 0, 0.03}};
    const GroundTruthView truth = support::stepOnce(simulator, {{{0}, {X_SO}}}, 1e-2).ground_truth;
    const auto wrench = truth.contact_wrench;
    EXPECT_NEAR(wrench[2], -kLoad, skin.load_error * kLoad);
    EXPECT_NEAR(wrench[1], 0, 0.01 * kLoad);
    if (skin.is_layer) {
      EXPECT_GT(truth.off_array_load[0], 0.1 * kLoad);
    }
    if (n == 0 || n >= skin.slips_from) {
      EXPECT_NEAR(wrench[0], n == 0 ? 0 : skin.share * kLoad, n == 0 ? 0 : skin.share_error * kLoad) << n;
    }
  }
}

// Far from the origin of S and rotated, where rounding of float32 poses would show as motion. The pressures of a layer converge within the
// tolerance of the solver only, and so does the offset of a load.
TEST_P(ShearOnEveryDriver, OfAnObjectAtRestStays) {
  const Skin& skin = GetParam();
  Simulator simulator = support::makeSimulator(skin.sensor, {Object(Sphere{0.01})}, {.num_instances = 2});
  simulator.setLoad(1, 2.0f);
  Pose X_SO{{4e-3, 17e-3, 0.0094}, axisAngle({1, 2, 3}, 1.1)};
  const auto step = [&](double dt) { return support::stepOnce(simulator, {{{0}, {X_SO}}, {{0}, {X_SO}}}, dt); };
  step(kDt);
  X_SO.position[0] += skin.slide;
  step(kDt);
  const FrameView slid = step(kDt);
  const std::vector<std::uint32_t> bits = support::bitsOf(slid, 1, 2);
  const std::vector<float> shear{slid.ground_truth.contact_wrench[0], slid.ground_truth.contact_wrench[6]};
  EXPECT_GT(shear[1], 0.1f);
  for (int n = 0; n < 100; ++n) {
    const FrameView now = step(std::pow(10.0, n % 20 - 10));
    if (!skin.is_layer) {
      ASSERT_EQ(support::bitsOf(now, 1, 2), bits) << "step " << n;
    }
    for (const std::size_t i : {0, 1}) EXPECT_NEAR(now.ground_truth.contact_wrench[6 * i] / shear[i], 1, 1e-3) << "step " << n;
  }
}

// One object slides and lifts off while another takes its place: its springs are new, although the samples were always in contact.
TEST(ShearOnDevice, IsNotInheritedByAnotherObject) {
  Sensor sensor = support::gridSensor();
  sensor.skin.friction = {1e8, 0.6};
  Simulator simulator = support::makeSimulator(sensor, {Object(Box{{8e-3, 8e-3, 0.01}})}, {.num_slots = 2});
  const auto shearAt = [&](const Vector3& first, const Vector3& second) {
    return support::stepOnce(simulator, {{{0, 0}, {{.position = first}, {.position = second}}}}, kDt).ground_truth.contact_wrench[0];
  };
  EXPECT_EQ(shearAt({0, 0, 4.5e-3}, {0, 0, 0.03}), 0);
  EXPECT_GT(shearAt({0.1e-3, 0, 4.5e-3}, {0, 0, 0.03}), 0.1);
  EXPECT_EQ(shearAt({0.1e-3, 0, 0.03}, {0, 0, 4.5e-3}), 0);
  EXPECT_GT(shearAt({0.1e-3, 0, 0.03}, {0.1e-3, 0, 4.5e-3}), 0.1);
}

// Slid far, pose-driven and load-driven: the whole contact slips at the relaxed pressure.
TEST(ShearOnDevice, FollowsTheRelaxedPressure) {
  constexpr double kLoad = 2;
  for (Skin skin : skins()) {
    SCOPED_TRACE(skin.name);
    if (std::holds_alternative<LuGre>(skin.sensor.skin.law)) continue;
    skin.sensor.skin.friction = {1e11, kMu};
    skin.sensor.skin.relaxation = {{0.5, 0.2}};
    Simulator simulator = support::makeSimulator(skin.sensor, {Object(Sphere{0.02})}, {.num_instances = 2});
    simulator.setLoads(std::vector<float>{kPoseDriven, static_cast<float>(kLoad)});
    double first = 0;
    for (int n = 0; n < 40; ++n) {
      const Pose X_SO{.position = {20e-6 * n, 0, 0.0195}};
      const auto wrench = support::stepOnce(simulator, {{{0}, {X_SO}}, {{0}, {X_SO}}}, 0.01).ground_truth.contact_wrench;
      if (n == 0) first = -wrench[2];
      EXPECT_NEAR(wrench[8], -kLoad, 0.001 * kLoad);
      for (const std::size_t i : {0, 6}) EXPECT_NEAR(wrench[i] / (-kMu * wrench[i + 2]), n == 0 ? 0 : 1, n == 0 ? 0 : 0.01) << n;
      if (n == 39) {
        EXPECT_LT(-wrench[2], 0.7 * first);
      }
    }
  }
}

// |shear| <= mu normal force, per taxel and after the PSF, which spreads both with the same weights; likewise for the wrench of one patch.
void expectInsideCone(const Sensor& sensor, const support::ObjectPaths& paths, double mu) {
  // Products with four factors and sums of up to 64 samples and 81 neighbours, each rounded.
  constexpr double kRounding = 300 * support::kUlp;
  const int num_instances = static_cast<int>(paths.loads.size());
  Simulator simulator = support::makeSimulator(
      sensor, paths.objects, {.num_instances = num_instances, .num_slots = static_cast<int>(paths.touches[0][0].ids.size())});
  for (const std::vector<Touch>& touches : paths.touches) {
    const FrameView frame = support::stepOnce(simulator, touches, kDt, paths.loads);
    support::expectWellFormed(frame, sensor, num_instances);
    const auto normal = frame.ground_truth.tactile_normal_force, shear = frame.ground_truth.tactile_shear_force;
    std::size_t num_outside = 0;
    for (std::size_t t = 0; t < normal.size(); ++t) {
      num_outside += std::hypot(shear[2 * t], shear[2 * t + 1]) > mu * normal[t] * (1 + kRounding) ? 1 : 0;
    }
    EXPECT_EQ(num_outside, 0u) << mu;
    for (std::size_t i = 0; sensor.patches.size() == 1 && i < paths.loads.size(); ++i) {
      const auto wrench = frame.ground_truth.contact_wrench.subspan(6 * i, 6);
      EXPECT_LE(std::hypot(wrench[0], wrench[1]), -mu * wrench[2] * (1 + kRounding)) << mu;
    }
  }
}

TEST(ShearOnDevice, StaysInsideTheConeAtAnyStiffness) {
  for (const double stiffness : {1e-6, 1.0, 1e6}) {
    for (const double mu : {1e-3, 10.0}) {
      Sensor sensor = support::frictionSensor();
      sensor.skin.friction = {stiffness * 0.4e8, mu};
      for (const double step_size : {1e-6, 0.3e-3, 0.02}) {
        expectInsideCone(sensor, support::randomPaths(sensor, 4, 1, true, step_size), mu);
      }
    }
  }
}

TEST(ShearOnDevice, OfALayerStaysInsideTheConeAtAnyStiffness) {
  for (const auto& [num_slots, stiffness] : std::vector<std::pair<int, double>>{{1, 1e9}, {2, 1e3}, {2, 1e15}}) {
    Sensor sensor = support::layerSensor({.margin = 2e-3, .iterations = 10, .tolerance = 1e-3}, {.samples_per_taxel = 2});
    sensor.skin.friction = {stiffness, 0.3};
    sensor.psf = gaussianPsf(0.8, 3);
    expectInsideCone(sensor, support::layerPaths(sensor, num_slots), 0.3);
  }
}

// Without a margin the shear of the wrench is the sum over the taxels, and the PSF keeps that sum.
TEST(ShearOnDevice, OfALayerIsTheSumOverTheTaxels) {
  for (const int size : {1, 5}) {
    Sensor sensor = support::layerSensor({.iterations = 10, .tolerance = 1e-3}, {.num_rows = 5, .num_cols = 8, .samples_per_taxel = 2});
    sensor.skin.friction = {1e9, 0.6};
    if (size > 1) sensor.psf = gaussianPsf(0.7, size);
    Simulator simulator = support::makeSimulator(sensor, {Object(Sphere{0.02})});
    for (const double slide : {0.0, 0.03e-3, 0.06e-3}) {
      support::stepOnce(simulator, {{{0}, {{.position = {-7e-3 + slide, 2e-3 + slide / 3, 0.0195}}}}}, kDt);
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

}  // namespace
}  // namespace taxelsim
