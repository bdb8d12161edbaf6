// What a step of some instances refuses, and that nothing changes then.
#include "simulation/comparison.h"
#include "support/input_error.h"
#include "support/random_scene.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using support::Touch;
using Bits = std::vector<std::uint32_t>;
using Selected = std::vector<std::uint8_t>;

struct OneBall {
  Model model{support::sharedDevice(), {.sensor = support::gridSensor(), .objects = {Object("ball", Sphere{6e-3})}}};
  Simulator simulator{model, {.num_instances = 3}};

  OneBall() { support::setTouches(simulator, std::vector<Touch>(3, {{0}, {{.position = {0, 0, 5.5e-3}}}})); }
  Bits bits() {
    const FrameView frame = simulator.read();
    return support::bitsOf(frame, 1, 3);
  }
};

TEST(HeldInstancesErrors, RejectsInstancesThatHaveTakenAStep) {
  OneBall scene;
  scene.simulator.step(0.01);
  const Bits before = scene.bits();
  scene.simulator.reset(0, 1);
  try {
    scene.simulator.step(0.01, Selected{1, 0, 1});
    ADD_FAILURE() << "nothing was thrown";
  } catch (const std::logic_error& error) {
    EXPECT_STREQ(error.what(), "instance 2 was not reset before a step of some instances");
  }
  EXPECT_EQ(scene.bits(), before);
  scene.simulator.step(0.01, Selected{1, 0, 0});
  EXPECT_EQ(scene.bits(), before);
}

TEST(HeldInstancesErrors, RejectsAnotherNumberOfInstances) {
  OneBall scene;
  for (const std::size_t length : {0u, 2u, 4u}) {
    const std::string message = support::inputError([&] { scene.simulator.step(0.01, Selected(length, 1)); });
    EXPECT_EQ(message, "instances: " + std::to_string(length) + " values are not allowed: 3");
  }
}

TEST(HeldInstancesErrors, RejectsAStepBeforeTheLastOneIsRead) {
  OneBall scene;
  scene.simulator.step(0.01, Selected{1, 0, 0});
  EXPECT_THROW(scene.simulator.step(0.01, Selected{0, 1, 0}), std::logic_error);
  scene.simulator.read();
  scene.simulator.step(0.01, Selected{0, 1, 0});
  EXPECT_GT(scene.simulator.read().ground_truth.total_force[1], 0);
}

TEST(HeldInstancesErrors, NoInstanceSelectedDoesNothing) {
  OneBall scene;
  scene.simulator.step(0.01);
  const Bits before = scene.bits();
  scene.simulator.step(0.01, Selected{0, 0, 0});
  scene.simulator.step(0.01, Selected{0, 0, 0});  // nothing runs that had to be read
  EXPECT_EQ(scene.bits(), before);
}

}  // namespace
}  // namespace taxelsim
