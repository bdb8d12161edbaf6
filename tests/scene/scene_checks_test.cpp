// Scenes that are built in C++: the ranges of files, and messages with the path of the field.
#include "scene/scene_checks.h"

#include "scene_text.h"
#include "support/test.h"

namespace taxelsim {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Scene scene() {
  const testing::TemporaryDirectory directory;
  return loadScene(directory.write("scene.yaml", kScene));
}

template <typename Change>
std::string refused(Change change) {
  Scene changed = scene();
  change(changed);
  return refusal("", [&] { checkScene(changed); });
}

TEST(CheckScene, AcceptsALoadedScene) {
  EXPECT_EQ(refused([](Scene&) {}), "was accepted");
}

TEST(CheckScene, RejectsScalarsOutOfRange) {
  EXPECT_EQ(refused([](Scene& s) { s.num_episodes = 0; }), "episodes: 0 is not allowed: a whole number from 1 to 1099511627776");
  EXPECT_EQ(refused([](Scene& s) { s.num_steps = -1; }), "num_steps: -1 is not allowed: a whole number from 1 to 1000000");
  EXPECT_EQ(refused([](Scene& s) { s.simulation_rate = kNan; }), "simulation_rate: nan is not allowed: a number > 0 and <= 1e+06 Hz");
  EXPECT_EQ(refused([](Scene& s) { s.control_rate = 30; }),
            "control_rate: 30 Hz is not allowed: simulation_rate (100 Hz) divided by a whole number");
  EXPECT_EQ(refused([](Scene& s) { s.episodes_per_shard = 0; }), "episodes_per_shard: 0 is not allowed: a whole number from 1 to 1000000");
  EXPECT_EQ(refused([](Scene& s) { s.compression = 10; }), "compression: 10 is not allowed: a whole number from 0 to 9");
  EXPECT_EQ(refused([](Scene& s) { s.max_regions = 9; }), "max_regions: 9 is not allowed: a whole number from 0 to 8");
  EXPECT_EQ(refused([](Scene& s) { s.kind = Scene::Kind::kContacts; }), "num_steps: 20 is not allowed: 1 in a scene of kind contacts");
}

TEST(CheckScene, RejectsObjectsAndControllers) {
  EXPECT_EQ(refused([](Scene& s) { s.objects.clear(); }), "objects: an empty list is not allowed: at least one");
  EXPECT_EQ(refused([](Scene& s) { s.objects[1].weight = -1; }), "objects[1].weight: -1 is not allowed: a number >= 0");
  EXPECT_EQ(refused([](Scene& s) { s.objects[0].weight = s.objects[1].weight = 0; }),
            "objects: every weight is 0: at least one must be chosen");
  EXPECT_EQ(refused([](Scene& s) { s.objects[1].motion = Sinusoid{.frequency = 0}; }),
            "objects[1].motion.sinusoid.frequency: 0 is not allowed: a number > 0 Hz");
  EXPECT_EQ(refused([](Scene& s) { s.controllers.clear(); }), "controllers: an empty list is not allowed: at least one");
  EXPECT_EQ(refused([](Scene& s) { s.controllers[0].servo[ServoFeature::kEdgeAngle].kp = -1; }),
            "controllers[0].tactile_servo.edge_angle.kp: -1 is not allowed: a number >= 0 1/s");
  EXPECT_EQ(refused([](Scene& s) { s.controllers[0].servo.max_linear_velocity = 0; }),
            "controllers[0].tactile_servo.max_linear_velocity: 0 is not allowed: a number > 0 m/s");
}

TEST(CheckScene, RejectsRandomRanges) {
  EXPECT_EQ(refused([](Scene& s) { s.randomization.x.max = 2; }), "randomization.x.max: 2 is not allowed: a number from -1 to 1 m");
  EXPECT_EQ(refused([](Scene& s) {
              s.randomization.gain = {2, 1};
            }),
            "randomization.gain: [2, 1] is not allowed: [min, max] with min <= max");
  EXPECT_EQ(refused([](Scene& s) { s.randomization.depth = Range{}; }), "randomization: exactly one of load and depth must be set");
  EXPECT_EQ(refused([](Scene& s) {
              s.randomization.exploration_velocity = Range{kNan, 1};
            }),
            "randomization.exploration_velocity.min: nan is not allowed: a number m/s");
  EXPECT_EQ(refused([](Scene& s) { s.randomization.linear_action_noise.min = -1; }),
            "randomization.linear_action_noise.min: -1 is not allowed: a number >= 0 m/s");
}

TEST(CheckScene, RejectsSkinsThatTheSensorCannotHave) {
  EXPECT_EQ(refused([](Scene& s) {
              s.randomization.stiffness = Range{0.5, 40};
            }),
            "randomization.stiffness.max: 40 is not allowed: a number from 0.05 to 20");
  EXPECT_EQ(refused([](Scene& s) {
              s.randomization.hysteresis = Range{0.5, 2};
            }),
            "randomization.hysteresis: 0.5 is not allowed: 1, because the sensor has no hysteresis");
  EXPECT_EQ(refused([](Scene& s) {
              s.randomization.mounting_yaw = Range{0, 1};
            }),
            "randomization.mounting_yaw.max: 1 is not allowed: a number from -0.5235987755982988 to 0.5235987755982988 rad");
}

TEST(CheckScene, RejectsTasks) {
  const auto task = [](auto change) {
    return refused([&](Scene& s) {
      s.task = Task{.hold = 0.1};
      (*s.task)[TaskMeasure::kCenter] = TaskCriterion{.tolerance = 0.001};
      change(*s.task);
    });
  };
  EXPECT_EQ(task([](Task&) {}), "was accepted");
  EXPECT_EQ(task([](Task& t) { t[TaskMeasure::kCenter]->tolerance = 0; }), "task.center.tolerance: 0 is not allowed: a number > 0 m");
  EXPECT_EQ(task([](Task& t) { t.hold = 0.3; }), "task.hold: 0.3 is not allowed: a number > 0 and <= 0.2 s, the duration of an episode");
  EXPECT_EQ(task([](Task& t) { t.laps = 1; }), "task.laps: needs a contour of every object of the scene");
  EXPECT_EQ(task([](Task& t) { t.travel = kNan; }), "task.travel: nan is not allowed: a number from 0 to 1000 m");
  EXPECT_EQ(refused([](Scene& s) { s.task = Task{.hold = 0.1}; }),
            "task: no success criterion: at least one of edge_angle, total_force, center, contour");
}

TEST(CheckScene, RejectsSensorAndRobotWithTheirPaths) {
  EXPECT_EQ(refused([](Scene& s) { s.sensor.skin.thickness = 0; }), "sensor.skin.thickness: 0 is not allowed: a number > 0 m");
  EXPECT_EQ(refused([](Scene& s) {
              Manipulator platform = panTilt({});
              platform.joints[1].max_velocity = 0;
              s.robot = platform;
            }),
            "robot.joints[1].max_velocity: 0 is not allowed: a number > 0 rad/s or m/s");
}

}  // namespace
}  // namespace taxelsim
