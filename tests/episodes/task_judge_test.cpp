// Verdicts on frames made by hand: one instance over an object with a ring as contour.
#include "episodes/task_judge.h"

#include "control/robots.h"
#include "episodes/example_scene.h"
#include "support/test.h"

namespace taxelsim {
namespace {

constexpr double kRadius = 0.05;  // m

// An episode of `num_frames` frames at 100 Hz.
Scene judgedScene(const Task& task, int num_frames = 6) {
  Scene scene = exampleScene();
  SceneObject ring{.object = Object("ring", Sphere{.radius = kRadius})};
  for (int k = 0; k < 360; ++k) {
    const double angle = k * std::numbers::pi / 180;
    ring.contour.push_back({kRadius * std::cos(angle), kRadius * std::sin(angle), 0});
  }
  scene.objects = {ring};
  scene.randomization.tilt = {0, 0};
  scene.num_steps = num_frames;
  scene.simulation_rate = 100;
  scene.task = task;
  return scene;
}

struct JudgedFrame {
  float force = 1;   // N
  double angle = 0;  // rad, of the sensor on the ring
};

class Judged {
 public:
  explicit Judged(Scene scene) : scene_(std::move(scene)), plan_(scene_, {}, 0), judge_(plan_, 1), robots_(FreeFlying{}, 1) {}

  Verdict run(const std::vector<JudgedFrame>& frames) {
    judge_.begin(0, {.episode = episode_++, .start_force = 1});
    double time = 0;
    for (std::size_t k = 0; k < frames.size(); ++k, time = static_cast<double>(k) * plan_.dt) frame(frames[k], time);
    return judge_.verdict(0);
  }
  Verdict run(const std::vector<float>& forces) {
    std::vector<JudgedFrame> frames;
    for (const float force : forces) frames.push_back({.force = force});
    return run(frames);
  }
  const TaskJudge& judge() const { return judge_; }

 private:
  void frame(const JudgedFrame& judged, double time) {
    const std::uint8_t active = 1;
    const float saturated = 0;
    const std::vector<float> center(3, 0.0f);
    const Pose X_SO = inverse(Pose{{kRadius * std::cos(judged.angle), kRadius * std::sin(judged.angle), 0}, {1, 0, 0, 0}});
    FrameView view;
    view.saturated = {&saturated, 1};
    view.ground_truth.total_force = {&judged.force, 1};
    view.ground_truth.center_of_pressure = center;
    judge_.frame(view, {.active = {&active, 1},
                        .times = {&time, 1},
                        .X_SO = {&X_SO, 1},
                        .X_WO = {},
                        .actions = {},
                        .controller_actions = {},
                        .X_WS = robots_.X_WS(),
                        .joint_positions = robots_.jointPositions(),
                        .joint_velocities = robots_.jointVelocities(),
                        .robot_status = robots_.status()});
  }

  Scene scene_;  // the plan refers to it
  EpisodePlan plan_;
  TaskJudge judge_;
  Robots robots_;
  std::uint64_t episode_ = 0;
};

Task forceTask() {
  Task task{.hold = 0.03};
  task[TaskMeasure::kTotalForce] = TaskCriterion{.tolerance = 0.1};
  return task;
}

Task contourTask(double laps) {
  Task task{.hold = 0.02, .laps = laps};
  task[TaskMeasure::kContour] = TaskCriterion{.tolerance = 1e-3};
  return task;
}

// Frames on the ring from angle 0 in equal steps (rad).
std::vector<JudgedFrame> along(int num_frames, double step) {
  std::vector<JudgedFrame> frames;
  for (int k = 0; k < num_frames; ++k) frames.push_back({.angle = k * step});
  return frames;
}

TEST(TaskJudge, SucceedsOnlyWithinToleranceForTheWholeHold) {
  Judged judged(judgedScene(forceTask()));
  const Verdict settled = judged.run({5, 5, 5, 1, 1, 1});
  EXPECT_TRUE(settled.success);
  EXPECT_FLOAT_EQ(settled.settling_time, 0.03f);
  EXPECT_EQ(settled.peak_force, 5);
  EXPECT_FALSE(judged.run({5, 5, 5, 5, 1, 1}).success) << "a frame too late";
  const Verdict disturbed = judged.run({1, 1, 1, 1, 5, 1});
  EXPECT_FALSE(disturbed.success);
  EXPECT_FLOAT_EQ(disturbed.settling_time, 0.05f);
  EXPECT_FALSE(judged.run({1, 1, 1, 1, 1}).success) << "before the last frame";
}

TEST(TaskJudge, NeedsTheTravel) {
  const double step = 0.1, length = 5 * 2 * kRadius * std::sin(step / 2);
  for (const double share : {0.99, 1.01}) {
    Task task = forceTask();
    task.travel = share * length;
    Judged judged(judgedScene(task));
    const Verdict verdict = judged.run(along(6, step));
    EXPECT_NEAR(verdict.travel, length, 1e-6);
    EXPECT_EQ(verdict.success, share < 1);
    EXPECT_EQ(judged.run(along(6, 0)).travel, 0) << "of the next episode";
  }
}

TEST(TaskJudge, NeedsTheLapsInEitherDirection) {
  constexpr int kNumFrames = 42;  // 41 steps of a fortieth
  const double step = 2 * std::numbers::pi / 40;
  Judged judged(judgedScene(contourTask(1), kNumFrames));
  for (const double direction : {1.0, -1.0}) {
    const Verdict lap = judged.run(along(kNumFrames, direction * step));
    EXPECT_TRUE(lap.success);
    EXPECT_NEAR(lap.laps, 41.0 / 40, 1e-3);
  }
  const Verdict part = judged.run(along(kNumFrames, step * 0.9));
  EXPECT_FALSE(part.success) << "every episode begins at 0";
  EXPECT_NEAR(part.laps, 0.9 * 41 / 40, 1e-3);
}

TEST(TaskJudge, CountsLossesOfContactWithinTheEpisode) {
  Judged judged(judgedScene(forceTask()));
  const Verdict twice = judged.run({1, 0, 1, 0, 0, 1});
  EXPECT_EQ(twice.num_losses, 2);
  EXPECT_FALSE(twice.success);
  EXPECT_EQ(judged.run({0, 0, 0, 1, 1, 1}).num_losses, 0) << "the episode before ended in contact";
}

TEST(TaskJudge, ErrorsAreInfiniteWithoutContact) {
  Judged judged(judgedScene(contourTask(0)));
  EXPECT_FALSE(judged.run({1, 1, 1, 1, 1, 0}).success);
  EXPECT_TRUE(std::isinf(judged.judge().errors()[static_cast<std::size_t>(TaskMeasure::kContour)]));
  EXPECT_EQ(judged.judge().within()[0], 0);
  EXPECT_TRUE(judged.run({1, 1, 1, 1, 1, 1}).success);
  EXPECT_NEAR(judged.judge().errors()[static_cast<std::size_t>(TaskMeasure::kContour)], 0, 1e-9);
}

}  // namespace
}  // namespace taxelsim
