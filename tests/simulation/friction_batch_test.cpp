// State of the skin (friction, bristles, relaxation): independent of batch, workgroup and speed.
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
  support::expectIndependentOfBatch(sensor, support::randomPaths(sensor, 13, kind.num_slots, true), {{0, 0}, {32, 64}, {128, 16}});
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

}  // namespace
}  // namespace taxelsim
