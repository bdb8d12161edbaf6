// Shear with memory on the device: closed forms, spread, and tiles. Properties of every skin: shear_test.cpp.
#include "reference/psf.h"
#include "simulation/comparison.h"
#include "support/friction_cases.h"
#include "support/random_scene.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using support::FrictionCases;
using support::Push;
using support::Touch;

constexpr double kDt = 1e-3;  // s
// Depths have an error of kMarginZ at most; the mean depth of the contacts is at least this.
constexpr double kMeanDepth = 0.1e-3;  // m

std::vector<std::vector<Push>> simulateByDevice(const Sensor& sensor, const Object& object, const std::vector<support::Path>& paths) {
  Simulator simulator = support::makeSimulator(sensor, {object}, {.num_instances = static_cast<int>(paths.size())});
  std::vector<std::vector<Push>> result(paths.size());
  for (std::size_t step = 0; step < paths[0].size(); ++step) {
    std::vector<Touch> touches;
    for (const support::Path& path : paths) touches.push_back({{0}, {path[step]}});
    const FrameView frame = support::stepOnce(simulator, touches, kDt);
    for (std::size_t i = 0; i < paths.size(); ++i) {
      Push push{.normal = frame.ground_truth.total_force[i]};
      std::copy_n(frame.ground_truth.contact_wrench.begin() + static_cast<std::ptrdiff_t>(6 * i), 6, push.wrench.begin());
      result[i].push_back(push);
    }
  }
  return result;
}

std::vector<Push> pushesOf(const Sensor& sensor, const Object& object, const support::Path& path) {
  return simulateByDevice(sensor, object, {path}).front();
}

const FrictionCases kDevice{simulateByDevice, support::kMarginZ / kMeanDepth};

class FrictionClosedFormOnDevice : public ::testing::TestWithParam<support::FrictionCase> {};

TEST_P(FrictionClosedFormOnDevice, Holds) {
  (kDevice.*GetParam().check)();
}

INSTANTIATE_TEST_SUITE_P(Cases, FrictionClosedFormOnDevice, ::testing::ValuesIn(support::kFrictionCases),
                         [](const auto& row) { return row.param.name; });

TEST(FrictionOnEveryDriver, SlideStopSlideBack) {
  kDevice.slideStopSlideBack();
}

// A flat punch on whole samples at the ends of the range: nothing slips if the springs are a million times too soft, everything if they are
// a million times too stiff.
TEST(FrictionOnDevice, ExtremeStiffnessGivesTheClosedForm) {
  const double depth = 0.5e-3, side = 4e-3, slide = 0.1e-3, normal = 1.73e8 * depth * side * side;
  for (const double stiffness : {1e-6, 1e6}) {
    for (const double mu : {1e-3, 10.0}) {
      Sensor sensor = support::gridSensor({.num_rows = 12, .num_cols = 12, .pitch_x = 1e-3, .pitch_y = 1e-3});
      sensor.skin.friction = {stiffness * 1e8, mu};
      const std::vector<Push> pushes =
          pushesOf(sensor, Object(Box{{side, side, 0.01}}),
                   {{.position = {0.02e-3, 0.02e-3, 5e-3 - depth}}, {.position = {0.02e-3, 0.02e-3 - slide, 5e-3 - depth}}});
      const double expected = -std::min(stiffness * 1e8 * slide * side * side, mu * normal);
      EXPECT_NEAR(pushes[1].wrench[1] / expected, 1, support::kMarginZ / depth) << stiffness << " " << mu;
    }
  }
}

TEST(FrictionOnDevice, SpreadKeepsTheSumAndTheWeights) {
  Sensor plain = support::gridSensor({.num_rows = 5, .num_cols = 8});
  plain.skin.friction = {1e8, 0.6};
  for (const int size : {3, 5}) {
    Sensor spread = plain;
    spread.psf = gaussianPsf(0.7, size);
    const auto shearOf = [&](const Sensor& sensor) {
      Simulator simulator = support::makeSimulator(sensor, {Object(Sphere{0.02})});
      for (const double slide : {0.0, 0.3e-3}) {
        support::stepOnce(simulator, {{{0}, {{.position = {-4e-3 + slide, 2e-3 + slide / 3, 0.0193}}}}}, kDt);
      }
      const auto shear = simulator.read().ground_truth.tactile_shear_force;
      std::vector<std::vector<double>> components(2);
      for (std::size_t n = 0; n < shear.size(); ++n) components[n % 2].push_back(shear[n]);
      return components;
    };
    const auto before = shearOf(plain), after = shearOf(spread);
    for (int axis = 0; axis < 2; ++axis) {
      const std::vector<double> expected = reference::spread(spread, before[axis]);
      double sum_before = 0, sum_after = 0;
      for (std::size_t t = 0; t < expected.size(); ++t) {
        sum_before += before[axis][t];
        sum_after += after[axis][t];
        EXPECT_NEAR(after[axis][t], expected[t], 100 * support::kUlp);  // of about a newton
      }
      EXPECT_GT(sum_before, 0.1);
      EXPECT_NEAR(sum_after / sum_before, 1, 300 * support::kUlp);
    }
  }
}

// Jumps of several taxels over an array of several tiles, from one of which the object moves to the next: nothing stays behind for the
// spread.
TEST(FrictionOnDevice, ShearUnderALoadAddsUpBetweenTiles) {
  Sensor sensor = support::gridSensor({.num_rows = 6, .num_cols = 96});
  sensor.skin.friction = {1e8, 0.6};
  sensor.psf = gaussianPsf(2, 9);
  Simulator simulator = support::makeSimulator(sensor, {Object(Sphere{0.01})});
  simulator.setLoad(0, 2.0f);
  constexpr int kNumFrames = 60;
  for (int n = 0; n < kNumFrames; ++n) {
    const double y = (n - kNumFrames / 2) * 5e-3 + (n % 2) * 1e-3;
    const FrameView frame = support::stepOnce(simulator, {{{0}, {{.position = {0, y, 0.0095}}}}}, kDt);
    double x_sum = 0, y_sum = 0;
    const auto shear = frame.ground_truth.tactile_shear_force;
    for (std::size_t k = 0; k < shear.size(); k += 2) x_sum += shear[k], y_sum += shear[k + 1];
    EXPECT_NEAR(x_sum, frame.ground_truth.contact_wrench[0], 300 * support::kUlp) << n;
    EXPECT_NEAR(y_sum, frame.ground_truth.contact_wrench[1], 300 * support::kUlp) << n;
    if (n > 0) {
      EXPECT_GT(std::hypot(x_sum, y_sum), 0.1);
    }
  }
}

TEST(FrictionOnDevice, NoShearWithoutFriction) {
  const Sensor sensor = support::gridSensor();
  const std::vector<Push> pushes =
      pushesOf(sensor, Object(Sphere{0.01}), {{.position = {0, 0, 0.0095}}, {.position = {0.1e-3, 0, 0.0095}}});
  EXPECT_EQ(pushes[1].wrench[0], 0);
  EXPECT_EQ(pushes[1].wrench[5], 0);
}

}  // namespace
}  // namespace taxelsim
