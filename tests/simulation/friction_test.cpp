// Shear with memory on the device: closed forms, spread, separation and loads.
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
  const Model model(support::sharedDevice(), {.sensor = sensor, .objects = {object}});
  Simulator simulator(model, {.num_instances = static_cast<int>(paths.size())});
  std::vector<std::vector<Push>> result(paths.size());
  for (std::size_t step = 0; step < paths[0].size(); ++step) {
    std::vector<Touch> touches;
    for (const support::Path& path : paths) touches.push_back({{0}, {path[step]}});
    support::setTouches(simulator, touches);
    simulator.step(kDt);
    const FrameView frame = simulator.read();
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

TEST(FrictionOnDevice, DiscTwist) {
  kDevice.discTwist();
}
TEST(FrictionOnDevice, SphereTwist) {
  kDevice.sphereTwist();
}
TEST(FrictionOnDevice, PartialSlipOfAFlat) {
  kDevice.partialSlipOfAFlat();
}
TEST(FrictionOnDevice, PartialSlipOfASphere) {
  kDevice.partialSlipOfASphere();
}
TEST(FrictionOnDevice, PartialSlipOfACylinder) {
  kDevice.partialSlipOfACylinder();
}
TEST(FrictionOnDevice, LoopAreas) {
  kDevice.loopAreas();
}
TEST(FrictionOnDevice, SlantedPress) {
  kDevice.slantedPress();
}
TEST(FrictionOnDevice, RollingCylinder) {
  kDevice.rollingCylinder();
}
TEST(FrictionOnDevice, RollingSphere) {
  kDevice.rollingSphere();
}
TEST(FrictionOnEveryDriver, SlideStopSlideBack) {
  kDevice.slideStopSlideBack();
}
TEST(FrictionOnDevice, SlipTurnsTowardsTheMotion) {
  kDevice.slipTurnsTowardsTheMotion();
}
TEST(FrictionOnDevice, ElasticLayerSticksAndSlips) {
  kDevice.elasticLayerSticksAndSlips();
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
      const Model model(support::sharedDevice(), {.sensor = sensor, .objects = {Object(Sphere{0.02})}});
      Simulator simulator(model, {});
      for (const double slide : {0.0, 0.3e-3}) {
        support::setTouches(simulator, {{{0}, {{.position = {-4e-3 + slide, 2e-3 + slide / 3, 0.0193}}}}});
        simulator.step(kDt);
        simulator.read();
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

// Separation releases the springs.
TEST(FrictionOnDevice, SeparationClearsShear) {
  Sensor sensor = support::gridSensor();
  sensor.skin.friction = {1e8, 0.6};
  const std::vector<Push> pushes = pushesOf(sensor, Object(Sphere{0.01}),
                                            {{.position = {0, 0, 0.0095}},
                                             {.position = {0.1e-3, 0, 0.0095}},
                                             {.position = {0.1e-3, 0, 0.0101}},
                                             {.position = {0.1e-3, 0, 0.0095}}});
  EXPECT_GT(pushes[1].wrench[0], 0.1);
  EXPECT_EQ(pushes[2].wrench[0], 0);
  EXPECT_EQ(pushes[3].wrench[0], 0);
}

// Slid far under a load along x of S over level patches, in one tile and over several: all of the contact slips.
TEST(FrictionOnEveryDriver, SlidingLoadShearsWithMuTimesTheLoad) {
  for (const int num_patches : {1, 2}) {
    Sensor sensor = support::gridSensor();
    for (int p = 1; p < num_patches; ++p) {
      sensor.patches.push_back(sensor.patches[0]);
      sensor.patches.back().X_SP.position = {6 * 3.4e-3, 0, 0};
    }
    sensor.skin.friction = {1e8, 0.6};
    const Model model(support::sharedDevice(), {.sensor = sensor, .objects = {Object(Sphere{0.02})}});
    Simulator simulator(model, {});
    simulator.setLoad(0, 3.0f);
    for (int n = 0; n < 40; ++n) {
      support::setTouches(simulator, {{{0}, {{.position = {0.1e-3 * n, 0, 0.03}}}}});
      simulator.step(kDt);
      const auto wrench = simulator.read().ground_truth.contact_wrench;
      constexpr double kCarried = 1e-4;  // of the load, by the search
      EXPECT_NEAR(wrench[2], -3, 3 * kCarried);
      EXPECT_NEAR(wrench[1], 0, 0.01 * 3);
      // Springs at the leading edge may still stick; they carry little.
      const double slips = n == 0 ? 0 : 1;
      if (n > 30 || n == 0) {
        EXPECT_NEAR(wrench[0], 0.6 * 3 * slips, 0.01 * 3 * slips);
      }
    }
  }
}

// Jumps of several taxels over an array of several tiles, from one of which the object moves to the next: nothing stays behind for the
// spread.
TEST(FrictionOnDevice, ShearUnderALoadAddsUpBetweenTiles) {
  Sensor sensor = support::gridSensor({.num_rows = 6, .num_cols = 96});
  sensor.skin.friction = {1e8, 0.6};
  sensor.psf = gaussianPsf(2, 9);
  const Model model(support::sharedDevice(), {.sensor = sensor, .objects = {Object(Sphere{0.01})}});
  Simulator simulator(model, {});
  simulator.setLoad(0, 2.0f);
  constexpr int kNumFrames = 60;
  for (int n = 0; n < kNumFrames; ++n) {
    const double y = (n - kNumFrames / 2) * 5e-3 + (n % 2) * 1e-3;
    support::setTouches(simulator, {{{0}, {{.position = {0, y, 0.0095}}}}});
    simulator.step(kDt);
    const FrameView frame = simulator.read();
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
