// Evaluation of grasps: the judge against closed forms, a played scene against its frames, independence of the batch size, refusals.
#include "taxelsim/grasp_evaluation.h"

#include "episodes/grasp_batch.h"
#include "episodes/grasp_judge.h"
#include "support/input_error.h"
#include "support/test.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

const Device& device() {
  static const Device opened = Device::open();
  return opened;
}

// Jaws touch the box after 50 frames.
Scene scene(std::uint64_t num_episodes, int num_steps = 110) {
  Scene loaded = loadScene(std::filesystem::path(TAXELSIM_SOURCE_DIR) / "scenes/gripper_grasp.yaml", {.num_episodes = num_episodes});
  loaded.num_steps = num_steps;
  loaded.grasp->task.hold = 0.2;
  return loaded;
}

constexpr double kRounding = 1e-12;  // relative; sums of 100 terms in double

// A force that approaches its target by the factor q a frame.
struct Approach {
  double target = 2, error = 2, q = 0.9;  // N

  GraspJudge::Touch touch(int frame) const { return {.force = target - error * std::pow(q, frame), .center = {}}; }
};

GraspVerdict judged(const GraspTask& task, const Approach& approach, int num_frames) {
  GraspJudge judge(task, num_frames, 0.01, 7, std::array{approach.target});
  for (int n = 0; n < num_frames; ++n) judge.frame(std::array{approach.touch(n)});
  return judge.verdict();
}

TEST(GraspJudge, DecayingErrorHasTheTimesOfItsClosedForm) {
  const Approach approach;
  const GraspVerdict verdict = judged({.tolerance = 0.1, .hold = 0.5}, approach, 100);
  const FingerVerdict& finger = verdict.fingers.at(0);
  // The error is 2 N 0.9^n, within 0.2 N from n = log(0.1) / log(0.9) = 21.9 on.
  EXPECT_NEAR(finger.settling_time, std::ceil(std::log(0.1) / std::log(0.9)) * 0.01, kRounding);
  // Mean of squares over the frames 50 to 99: a geometric series of ratio q^2.
  const double q2 = approach.q * approach.q;
  const double sum = 4 * std::pow(q2, 50) * (1 - std::pow(q2, 50)) / (1 - q2);
  EXPECT_NEAR(finger.force_error, std::sqrt(sum / 50), kRounding);
  EXPECT_NEAR(finger.peak_force, 2 - 2 * std::pow(0.9, 99), kRounding);
  EXPECT_EQ(verdict.episode, 7u);
  EXPECT_TRUE(verdict.success);
}

TEST(GraspJudge, HoldsOnlyIfTheWholeEndIsWithinTolerance) {
  const Approach approach;
  // Within 10 % from frame 22 on: an end that begins with frame 22 is held, one that begins with frame 21 is not.
  EXPECT_TRUE(judged({.tolerance = 0.1, .hold = 0.28}, approach, 50).success);
  EXPECT_FALSE(judged({.tolerance = 0.1, .hold = 0.29}, approach, 50).success);
  EXPECT_FALSE(judged({.tolerance = 1e-3, .hold = 0.1}, approach, 50).success);
  EXPECT_TRUE(std::isnan(judged({.tolerance = 1e-3, .hold = 0.1}, approach, 50).fingers[0].settling_time));
}

TEST(GraspJudge, DriftIsTheLargestDistanceSinceTheEndBegan) {
  GraspTask task{.tolerance = 1, .hold = 0.1};
  const auto play = [&] {
    GraspJudge judge(task, 20, 0.01, 0, std::array{1.0, 1.0});
    // On a circle of 1 mm: the end goes half a quarter forth in five frames, and back. Before it, the way is longer.
    for (int n = 0; n < 20; ++n) {
      const double angle = (n < 15 ? n - 10 : 20 - n) * 0.1 * M_PI / 2;
      judge.frame(std::array{GraspJudge::Touch{.force = 1, .center = {1e-3 * std::cos(angle), 1e-3 * std::sin(angle)}},
                             GraspJudge::Touch{.force = 1, .center = {}}});
    }
    return judge.verdict();
  };
  const double chord = 2e-3 * std::sin(0.25 * M_PI / 2);
  EXPECT_NEAR(play().fingers[0].drift, chord, kRounding);
  EXPECT_EQ(play().fingers[1].drift, 0);
  task.drift = chord * 0.999;
  EXPECT_FALSE(play().success);
  EXPECT_FALSE(play().fingers[0].held);
  EXPECT_TRUE(play().fingers[1].held);
  task.drift = chord * 1.001;
  EXPECT_TRUE(play().success);
}

TEST(GraspJudge, LossesAreCountedAndHaveNoDrift) {
  GraspJudge judge({.tolerance = 1, .hold = 0.05}, 10, 0.01, 0, std::array{1.0});
  for (const double force : {0.0, 1.0, 0.0, 1.0, 1.0, 1.0, 1.0, 0.0, 1.0, 1.0}) {
    judge.frame(std::array{GraspJudge::Touch{.force = force, .center = {force * 1e-3, 0}}});
  }
  const FingerVerdict finger = judge.verdict().fingers[0];
  EXPECT_EQ(finger.num_losses, 2);
  EXPECT_TRUE(std::isnan(finger.drift));
  EXPECT_TRUE(finger.held);  // a tolerance of 100 % includes no force, and the drift is not judged
}

bool sameVerdicts(const GraspEvaluation& a, const GraspEvaluation& b) {
  const auto same = [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); };
  if (a.verdicts.size() != b.verdicts.size()) return false;
  for (std::size_t e = 0; e < a.verdicts.size(); ++e) {
    if (a.verdicts[e].episode != b.verdicts[e].episode || a.verdicts[e].success != b.verdicts[e].success) return false;
    for (std::size_t f = 0; f < a.verdicts[e].fingers.size(); ++f) {
      const FingerVerdict &x = a.verdicts[e].fingers[f], &y = b.verdicts[e].fingers[f];
      if (x.held != y.held || x.target != y.target || !same(x.force_error, y.force_error) || !same(x.settling_time, y.settling_time) ||
          x.peak_force != y.peak_force || !same(x.drift, y.drift) || x.num_losses != y.num_losses)
        return false;
    }
  }
  return true;
}

TEST(EvaluateGrasp, VerdictsDoNotDependOnTheBatchSize) {
  const Scene grasp = scene(5);
  const std::vector<GraspEvaluation> whole = evaluateGrasp(device(), grasp);
  ASSERT_EQ(whole.size(), 1u);
  EXPECT_EQ(whole[0].verdicts.size(), 5u);
  EXPECT_EQ(whole[0].verdicts[4].episode, 4u);
  for (const int batch_size : {1, 2})
    EXPECT_TRUE(sameVerdicts(whole[0], evaluateGrasp(device(), grasp, {}, {.batch_size = batch_size})[0]));
}

// The frames of an episode, read here and judged by plain loops.
TEST(EvaluateGrasp, VerdictsAreThoseOfTheFrames) {
  const Scene grasp = scene(3);
  const GraspVerdict found = evaluateGrasp(device(), grasp)[0].verdicts[2];
  GraspBatch batch(device(), grasp, {}, 1);
  batch.begin(2, 1);
  std::vector<std::vector<double>> forces(2);
  for (int frame = 0; frame < grasp.num_steps; ++frame) {
    batch.step();
    for (std::size_t f = 0; f < 2; ++f) {
      const int sensor = grasp.grasp->fingers[f].sensor;
      forces[f].push_back(batch.robots().frame(sensor).ground_truth.total_force[batch.robots().row(sensor, 0)]);
    }
  }
  for (std::size_t f = 0; f < 2; ++f) {
    const double target = batch.targetForces()[f];
    double sum = 0;
    for (int frame = 90; frame < 110; ++frame) sum += std::pow(forces[f][static_cast<std::size_t>(frame)] - target, 2);
    EXPECT_EQ(found.fingers[f].target, target);
    EXPECT_NEAR(found.fingers[f].force_error, std::sqrt(sum / 20), kRounding);
    EXPECT_EQ(found.fingers[f].peak_force, *std::max_element(forces[f].begin(), forces[f].end()));
  }
}

TEST(EvaluateGrasp, GainsPlayTheSameEpisodesAndAHigherOneSettlesEarlier) {
  const std::vector<GraspEvaluation> found = evaluateGrasp(device(), scene(2, 150), {5, 20});
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].gain, 5);
  EXPECT_EQ(found[1].gain, 20);
  for (std::size_t e = 0; e < 2; ++e) EXPECT_EQ(found[0].verdicts[e].fingers[0].target, found[1].verdicts[e].fingers[0].target);
  EXPECT_LT(found[1].total.settling_time.median, found[0].total.settling_time.median);
  EXPECT_EQ(found[1].total.num_held, 2u);
  EXPECT_EQ(found[1].fingers.at(0).name, "left");
  EXPECT_EQ(found[1].fingers.at(1).name, "below");
  // Of both fingers together: the larger value.
  const GraspVerdict& first = found[1].verdicts[0];
  EXPECT_GE(found[1].total.force_error.max, std::max(first.fingers[0].force_error, first.fingers[1].force_error));
}

TEST(EvaluateGrasp, StopsAndKeepsWhatIsComplete) {
  std::atomic<bool> stop = false;
  const std::vector<GraspEvaluation> found =
      evaluateGrasp(device(), scene(2, 60), {10, 20}, {.on_evaluation = [&](const GraspEvaluation&) { stop = true; }, .stop = &stop});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].gain, 10);
}

std::string refusalOf(const Scene& refused, const std::vector<double>& gains = {}, int batch_size = 1) {
  return support::refusal([&] { evaluateGrasp(device(), refused, gains, {.batch_size = batch_size}); });
}

TEST(EvaluateGrasp, RefusesWhatItCannotJudge) {
  EXPECT_EQ(refusalOf(scene(1), {0}), "gain: 0 is not allowed: a number > 0 and <= 100 1/s");
  EXPECT_EQ(refusalOf(scene(1), {101}), "gain: 101 is not allowed: a number > 0 and <= 100 1/s");
  EXPECT_EQ(refusalOf(scene(1), {}, 0), "batch size: 0 is not allowed: at least 1");
  Scene refused = scene(1);
  refused.grasp->task.hold = 1.2;
  EXPECT_EQ(refusalOf(refused), "task.hold: 1.2 is not allowed: a number > 0 and <= 1.1 s, the duration of an episode");
  refused = scene(1);
  refused.grasp->task.tolerance = 0;
  EXPECT_EQ(refusalOf(refused), "task.tolerance: 0 is not allowed: a number > 0 and <= 1");
  refused.grasp.reset();
  EXPECT_NE(refusalOf(refused), support::kNoRefusal);
  refused = scene(1);
  refused.num_episodes = (1 << 24) + 1;
  EXPECT_NE(refusalOf(refused).find("16777217 is not allowed: at most 16777216"), std::string::npos);
}

}  // namespace
}  // namespace taxelsim
