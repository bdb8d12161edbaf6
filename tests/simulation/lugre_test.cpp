// The law lugre on the device: closed forms, and bounds at any speed.
#include "simulation/comparison.h"
#include "support/cases.h"
#include "support/random_scene.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using support::Random;
using support::Touch;

constexpr LuGre kLuGre{.normal_contact_stiffness = 1.73e8};
constexpr double kDepth = 0.5e-3;  // m
// Error of shear over normal force, both summed over the same samples: about twenty roundings of bristles of about 1, plus the bend by a
// displacement error of 32 roundings (of 1e-6 m and of positions of a few millimetres, as in the tests of friction).
constexpr double kRounding = 100 * support::kUlp;

Sensor sensorWith(const LuGre& law) {
  Sensor sensor = support::gridSensor();
  sensor.skin.law = law;
  return sensor;
}

// A flat punch on whole samples of one or two patches slides along x by `ways` (m) in steps of `dt` (s) each. Returns shear over normal
// force along x.
std::vector<double> slide(const LuGre& law, const std::vector<double>& ways, const std::vector<double>& dt) {
  Simulator simulator = support::makeSimulator(sensorWith(law), {Object(Box{{3.4e-3, 6.8e-3, 0.01}})});
  Touch touch{{0}, {{.position = {1.7e-3, 0, 5e-3 - kDepth}}}};
  support::stepOnce(simulator, {touch}, 1e-3);
  std::vector<double> shares;
  for (std::size_t n = 0; n < ways.size(); ++n) {
    touch.X_SO[0].position[0] += ways[n];
    const auto wrench = support::stepOnce(simulator, {touch}, dt[n]).ground_truth.contact_wrench;
    EXPECT_NEAR(wrench[1], 0, kRounding);
    shares.push_back(wrench[0] / -wrench[2]);
  }
  return shares;
}

TEST(LuGreOnDevice, SteadySlidingFollowsTheStribeckCurve) {
  for (const double speed : {1e-5, 1e-4, 5e-4, 1e-3, 2e-3, 1e-2, 0.1, 1.0}) {
    // After 20 steps of 1e-5 m the initial bend has decayed to e^-13.
    const double expected = std::min(1 + 0.5 * std::exp(-speed * speed / 1e-6) + 0.4 * speed, 1.5);
    const std::vector<double> shares = slide(kLuGre, std::vector(20, 1e-5), std::vector(20, 1e-5 / speed));
    EXPECT_NEAR(shares.back(), expected, kRounding + 2 * std::exp(-20 / 1.5)) << speed;
  }
}

// The same path at two speeds. A rate-independent spring would give equal shear.
TEST(LuGreOnDevice, PresetShearsMoreAtLowSpeed) {
  const std::vector<double> path(30, 1e-5);
  EXPECT_NEAR(slide(kLuGre, path, std::vector(30, 0.1)).back(), 1.49506, 1e-5);
  EXPECT_NEAR(slide(kLuGre, path, std::vector(30, 1e-3)).back(), 1.00400, 1e-5);
}

TEST(LuGreOnDevice, ConstantVelocityFromRestGivesAnExponential) {
  LuGre law = kLuGre;
  law.bristle_damping = 0;
  for (const double speed : {1e-4, 1e-3, 1e-2}) {
    for (const double way : {1e-8, 1e-7, 1e-6, 5e-6, 3e-5}) {
      const double g = 1 + 0.5 * std::exp(-speed * speed / 1e-6);
      const auto at = [&](double slid) { return -g * std::expm1(-1e5 * slid / g) + 0.4 * speed; };
      const std::vector<double> shares = slide(law, std::vector(4, way), std::vector(4, way / speed));
      for (int n = 0; n < 4; ++n) {
        const double expected = std::min(at((n + 1) * way), 1.5);
        EXPECT_NEAR(shares[n], expected, kRounding * std::max(expected, 0.01)) << speed << " " << way;
      }
    }
  }
}

// A flat punch that lands while it slides, in contact for half of the travel.
TEST(LuGreOnDevice, LandingBendsByTheTravelAfterTouch) {
  LuGre law = kLuGre;
  law.bristle_damping = 0;
  Simulator simulator = support::makeSimulator(sensorWith(law), {Object(Box{{3.4e-3, 6.8e-3, 0.01}})});
  for (const double way : {0.0, 5e-6}) {
    support::stepOnce(simulator, {{{0}, {{.position = {1.7e-3 + way, 0, 5e-3 + (way > 0 ? -kDepth : kDepth)}}}}}, 5e-3);
  }
  const auto wrench = simulator.read().ground_truth.contact_wrench;
  const double g = 1 + 0.5 * std::exp(-1.0), share = -g * std::expm1(-1e5 * 2.5e-6 / g) + 0.4e-3;
  // The share of the travel has the relative error of the depth.
  EXPECT_NEAR(wrench[0] / -wrench[2], share, (support::kMarginZ / kDepth + kRounding) * share);
}

// Without the cone the force after a jump from rest to 0.1 m/s would be 31.7 times the load.
TEST(LuGreOnEveryDriver, VelocityJumpKeepsCoulombsBound) {
  const std::vector<double> shares = slide(kLuGre, {1e-7, 1e-7, -1e-7, 0}, {1e-6, 1e-6, 1e-6, 1e-6});
  EXPECT_NEAR(shares[0], 1.5, kRounding);
  EXPECT_NEAR(shares[1], 1.5, kRounding);
  EXPECT_NEAR(shares[2], -1.5, kRounding);
  EXPECT_LT(std::abs(shares[3]), 0.02) << "what the bristles hold at rest";
}

// |shear| <= mu_s normal force per taxel, and all values finite, with parameters six orders of magnitude off and steps from 1 ns to 1000 s.
TEST(LuGreOnDevice, ShearStaysInsideTheConeAtAnyParameters) {
  // Products with four factors and sums of up to 64 samples and 81 neighbours, each rounded.
  constexpr double kConeRounding = 300 * support::kUlp;
  Random random(11);
  double most = 0;
  for (int scene = 0; scene < support::numCases(5, 16); ++scene) {
    const auto around = [&](double value) { return scene == 0 ? value : value * std::pow(10, random.integer(-2, 2) * 3.0); };
    LuGre law{1.73e8, around(1e5), around(316), around(0.4), 0, scene == 0 ? 1.0 : std::pow(10, random.uniform(-6, 2.5)), around(1e-3)};
    law.static_friction = law.coulomb_friction * random.uniform(1, 3);
    Sensor sensor = support::randomSensor(random, {.max_rows = 6, .max_cols = 8, .max_patches = 2, .max_patch_tilt = 0.3});
    sensor.skin.law = law;
    sensor.skin.thickness = 1e-3;
    const Object object = random.chance(0.5) ? support::randomSolid(random, 0.02) : support::randomMeshObject(random, 0.02);
    Simulator simulator = support::makeSimulator(sensor, {object}, {.num_instances = 2});
    simulator.setLoad(1, 0.5f);
    Touch touch{{0}, {support::randomContact(random, sensor, object)}};
    for (int step = 0; step < 6; ++step) {
      support::setTouches(simulator, {touch, touch});
      simulator.step(std::pow(10, random.uniform(-9, 3)));
      const FrameView frame = simulator.read();
      support::expectWellFormed(frame, sensor, 2);
      const auto normal = frame.ground_truth.tactile_normal_force, shear = frame.ground_truth.tactile_shear_force;
      std::size_t num_outside = 0;
      for (std::size_t t = 0; t < normal.size(); ++t) {
        const double size = std::hypot(shear[2 * t], shear[2 * t + 1]), cone = law.static_friction * normal[t];
        num_outside += size > cone * (1 + kConeRounding) ? 1 : 0;
        if (normal[t] > 1e-3) most = std::max(most, size / cone);
      }
      EXPECT_EQ(num_outside, 0u) << "scene " << scene;
      const double way = std::pow(10, random.uniform(-9, -2));
      for (double& coordinate : touch.X_SO[0].position)
        coordinate += way * random.uniform(-1, 1) * (&coordinate == &touch.X_SO[0].position[2] ? 0.01 : 1);
    }
  }
  EXPECT_GT(most, 0.99) << "the bound is reached";
}

}  // namespace
}  // namespace taxelsim
