// State of the skin (friction, bristles, relaxation): independent of batch and workgroup, at rest, and inside the friction cone.
#include "simulation/comparison.h"
#include "simulation/friction_paths.h"
#include "support/random_scene.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using support::Touch;

constexpr double kDt = 1e-3;  // s

struct StateKind {
  int num_slots = 1;
  int num_patches = 2;
  bool has_friction = true;
  bool relaxes = false;
  bool bristles = false;
};

class StateBatch : public ::testing::TestWithParam<StateKind> {};

TEST_P(StateBatch, IndependentOfBatchAndWorkgroup) {
  const StateKind kind = GetParam();
  Sensor sensor = kind.bristles ? support::bristleSensor() : support::frictionSensor();
  sensor.patches.resize(static_cast<std::size_t>(kind.num_patches));
  if (!kind.has_friction) sensor.skin.friction = {};
  if (kind.relaxes) {
    if (Winkler* law = std::get_if<Winkler>(&sensor.skin.law)) law->normal_damping = 0;
    sensor.skin.relaxation = {{0.3, 1e-3}, {0.4, 0.01}, {0.1, 1}};
  }
  constexpr int kNumInstances = 13;
  const support::ObjectPaths paths = support::randomPaths(sensor, kNumInstances, kind.num_slots, true);
  const auto model = [&](int contact_workgroup, int image_workgroup) {
    return Model(support::sharedDevice(),
                 {.sensor = sensor, .objects = paths.objects, .contact_workgroup = contact_workgroup, .image_workgroup = image_workgroup});
  };
  const Model usual = model(0, 0);
  const auto together = support::runPaths(usual, paths, support::upTo(kNumInstances));
  std::vector<int> backwards = support::upTo(kNumInstances);
  std::reverse(backwards.begin(), backwards.end());
  const auto reversed = support::runPaths(usual, paths, backwards);
  for (int i = 0; i < kNumInstances; ++i) EXPECT_EQ(together[i], reversed[kNumInstances - 1 - i]) << "instance " << i;
  for (const int i : {0, 2, 7}) EXPECT_EQ(together[i], support::runPaths(usual, paths, {i})[0]) << "instance " << i;
  EXPECT_EQ(support::runPaths(model(32, 64), paths, support::upTo(kNumInstances)), together);
  EXPECT_EQ(support::runPaths(model(128, 16), paths, support::upTo(kNumInstances)), together);
}

INSTANTIATE_TEST_SUITE_P(Kinds, StateBatch,
                         ::testing::Values(StateKind{}, StateKind{.num_slots = 2}, StateKind{.has_friction = false, .relaxes = true},
                                           StateKind{.num_patches = 1, .has_friction = false, .relaxes = true},
                                           StateKind{.num_slots = 2, .num_patches = 1, .relaxes = true}, StateKind{.relaxes = true},
                                           StateKind{.bristles = true}, StateKind{.num_slots = 2, .relaxes = true, .bristles = true}));

// Without damping the result does not depend on dt.
TEST(FrictionOnDevice, IndependentOfSpeed) {
  Sensor sensor = support::frictionSensor();
  sensor.skin.law = Winkler{1.73e8, 1, 0};
  const support::ObjectPaths paths = support::randomPaths(sensor, 5, 1, false);
  const Model model(support::sharedDevice(), {.sensor = sensor, .objects = paths.objects});
  const auto slow = support::runPaths(model, paths, support::upTo(5), {0.5, 2});
  EXPECT_EQ(support::runPaths(model, paths, support::upTo(5), {1e-4}), slow);
}

TEST(FrictionOnDevice, ObjectAtRestDoesNotCreep) {
  const Sensor sensor = support::gridSensor();
  Sensor with_friction = sensor;
  with_friction.skin.friction = {1e8, 0.6};
  const Model model(support::sharedDevice(), {.sensor = with_friction, .objects = {Object(Sphere{0.01})}});
  Simulator simulator(model, {.num_instances = 2});
  // Far from the origin of S and rotated, where rounding of float32 poses would show as motion.
  const Pose start{{4e-3, 17e-3, 0.0094}, axisAngle({1, 2, 3}, 1.1)};
  Pose slid = start;
  slid.position[0] += 0.05e-3;
  const auto stepTo = [&](const Pose& X_SO) {
    support::setTouches(simulator, {{{0}, {X_SO}}, {{0}, {X_SO}}});
    simulator.step(kDt);
    return support::bitsOf(simulator.read(), 1, 2);
  };
  simulator.setLoad(1, 2.0f);
  stepTo(start);
  const auto bits = stepTo(slid);
  for (int n = 0; n < 100; ++n) ASSERT_EQ(stepTo(slid), bits) << "step " << n;
  EXPECT_GT(simulator.read().ground_truth.contact_wrench[6], 0.1f);
}

// |shear| <= mu normal force, per taxel and after the PSF, which spreads both with the same weights.
TEST(FrictionOnDevice, ShearStaysInsideTheConeAtAnyStiffness) {
  // Products with four factors and sums of up to 64 samples and 81 neighbours, each rounded.
  constexpr double kRounding = 300 * support::kUlp;
  for (const double stiffness : {1e-6, 1.0, 1e6}) {
    for (const double mu : {1e-3, 10.0}) {
      Sensor sensor = support::frictionSensor();
      sensor.skin.friction = {stiffness * 0.4e8, mu};
      const Model model(support::sharedDevice(), {.sensor = sensor, .objects = support::randomPaths(sensor, 4, 1, true).objects});
      for (const double step_size : {1e-6, 0.3e-3, 0.02}) {
        const support::ObjectPaths paths = support::randomPaths(sensor, 4, 1, true, step_size);  // the same objects
        Simulator simulator(model, {.num_instances = 4});
        simulator.setLoads(paths.loads);
        for (const std::vector<Touch>& touches : paths.touches) {
          support::setTouches(simulator, touches);
          simulator.step(kDt);
          const FrameView frame = simulator.read();
          support::expectWellFormed(frame, sensor, 4);
          const auto normal = frame.ground_truth.tactile_normal_force, shear = frame.ground_truth.tactile_shear_force;
          std::size_t num_outside = 0;
          for (std::size_t t = 0; t < normal.size(); ++t) {
            num_outside += std::hypot(shear[2 * t], shear[2 * t + 1]) > mu * normal[t] * (1 + kRounding) ? 1 : 0;
          }
          EXPECT_EQ(num_outside, 0u) << stiffness << " " << mu << " " << step_size;
        }
      }
    }
  }
}

}  // namespace
}  // namespace taxelsim
