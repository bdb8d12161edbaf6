#include "taxelsim/evaluate.h"

#include <sys/resource.h>

#include "episodes/example_scene.h"
#include "support/input_error.h"
#include "support/test.h"
#include "taxelsim/error.h"
#include "taxelsim/generate.h"

namespace taxelsim {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kGain = 6;  // 1/s
constexpr double kTolerance = 5 * kDegree;

// Aligns a cylinder with the array; one controller knows the exact angle, one ignores it.
Scene alignScene() {
  Scene scene = exampleScene();
  scene.objects.resize(1);
  scene.objects[0].edge = Vector3{0, 0, 1};
  scene.sensor.readout.noise = 0;
  scene.num_steps = 120;
  scene.control_rate = scene.simulation_rate;
  scene.num_episodes = 24;
  scene.randomization = {};
  scene.randomization.yaw = {-60 * kDegree, 60 * kDegree};
  scene.randomization.load = Range{2, 4};
  TactileServo exact;
  exact.edge_angle_source = EdgeAngleSource::kExact;
  exact.max_angular_velocity = 100;
  exact[ServoFeature::kEdgeAngle] = {.selected = true, .reference = std::numbers::pi / 2, .kp = kGain};
  TactileServo idle;
  idle[ServoFeature::kEdgeAngle] = {.selected = true, .kp = 0};
  scene.controllers = {{"exact", 1, exact}, {"idle", 1, idle}};
  Task task{.hold = 0.2};
  task[TaskMeasure::kEdgeAngle] = TaskCriterion{.tolerance = kTolerance, .reference = std::numbers::pi / 2};
  scene.task = task;
  return scene;
}

bool sameBytes(const Verdict& a, const Verdict& b) {
  return a.episode == b.episode && a.object == b.object && a.success == b.success && a.num_losses == b.num_losses && a.robot == b.robot &&
         std::memcmp(a.start_error.data(), b.start_error.data(), sizeof a.start_error) == 0 &&
         std::memcmp(a.steady_error.data(), b.steady_error.data(), sizeof a.steady_error) == 0 &&
         std::memcmp(&a.settling_time, &b.settling_time, sizeof(float)) == 0 && a.travel == b.travel && a.peak_force == b.peak_force;
}

// An exact angle decays by 1 - K T per frame, which gives a closed form of the settling time.
TEST(Evaluate, SettlesWhenTheClosedFormDoes) {
  const Scene scene = alignScene();
  const double dt = 1 / scene.simulation_rate, decay = 1 - kGain * dt;
  const std::vector<Evaluation> evaluations = evaluate(Device::open(), scene);
  ASSERT_EQ(evaluations.size(), 2u);
  int num_far = 0;
  for (std::size_t e = 0; e < scene.num_episodes; ++e) {
    const Verdict &exact = evaluations[0].verdicts[e], &idle = evaluations[1].verdicts[e];
    EXPECT_EQ(exact.episode, e);
    // The same episodes for both.
    EXPECT_EQ(exact.start_error[0], idle.start_error[0]);
    const double start = exact.start_error[0];
    EXPECT_LE(start, 60 * kDegree * (1 + 1e-6));
    const double frames = start > kTolerance ? std::ceil(std::log(kTolerance / start) / std::log(decay)) : 0;
    EXPECT_NEAR(exact.settling_time, frames * dt, 1.001 * dt);  // angles pass through float32: a frame more or less at the border
    EXPECT_TRUE(exact.success);
    const double last = start * std::pow(decay, scene.num_steps - 1), first_held = start * std::pow(decay, scene.num_steps - 20);
    EXPECT_GE(exact.steady_error[0], last * 0.99);
    EXPECT_LE(exact.steady_error[0], first_held * 1.01 + 1e-7);
    EXPECT_EQ(idle.success, start <= kTolerance);
    EXPECT_NEAR(idle.steady_error[0], start, 1e-6);
    EXPECT_TRUE(std::isnan(exact.steady_error[1]));  // not part of the task
    EXPECT_GT(exact.peak_force, 0);
    num_far += start > kTolerance ? 1 : 0;
  }
  EXPECT_GT(num_far, 12);
  EXPECT_EQ(evaluations[0].total.num_successes, scene.num_episodes);
  EXPECT_EQ(evaluations[1].total.num_successes, scene.num_episodes - static_cast<std::uint64_t>(num_far));
  std::uint64_t by_start = 0;
  for (const Score& score : evaluations[0].by_start) by_start += score.num_episodes;
  EXPECT_EQ(by_start, scene.num_episodes);
  EXPECT_EQ(evaluations[0].by_object.size(), 1u);
}

TEST(Evaluate, VerdictsDependOnNeitherBatchNorSlices) {
  Scene scene = alignScene();
  scene.controllers = {SceneController{}};
  scene.randomization.linear_action_noise = {0, 1e-3};
  scene.randomization.angular_action_noise = {0, 0.1};
  scene.randomization.noise = {0, 10};
  scene.num_steps = 30;
  const Device device = Device::open();
  const std::vector<Evaluation> whole = evaluate(device, scene, {}, {.batch_size = 24, .num_slices = 1, .on_progress = {}});
  const std::vector<Evaluation> cut = evaluate(device, scene, {}, {.batch_size = 7, .num_slices = 3, .on_progress = {}});
  for (std::size_t e = 0; e < scene.num_episodes; ++e) EXPECT_TRUE(sameBytes(whole[0].verdicts[e], cut[0].verdicts[e])) << e;
}

// The caller's thread keeps its priority and receives exceptions of the other thread.
TEST(Evaluate, EpisodesRunInTheBackground) {
  const int before = ::getpriority(PRIO_PROCESS, 0);
  const Device device = Device::open();
  int there = 0;
  const auto listen = [&](const Progress&) {
    there = ::getpriority(PRIO_PROCESS, 0);
    throw std::runtime_error("enough");
  };
  try {
    evaluate(device, alignScene(), {}, {.on_progress = listen});
    FAIL() << "no error";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "enough");
  }
  EXPECT_EQ(::getpriority(PRIO_PROCESS, 0), before);
  EXPECT_EQ(there, device.info().type == DeviceType::kCpu ? std::min(before + 10, 19) : before);
}

TEST(Evaluate, ReportsLostContact) {
  Scene scene = alignScene();
  scene.controllers.erase(scene.controllers.begin());
  scene.objects[0].motion = ConstantTwist{.twist = {.v = {0, 0, 0.02}, .w = {}}};  // off the skin, 2 mm deep at most, within 0.1 s
  Task task{.hold = 0.2};
  task[TaskMeasure::kTotalForce] = TaskCriterion{.tolerance = 1000};
  scene.task = task;
  const std::vector<Evaluation> evaluations = evaluate(Device::open(), scene);
  for (const Verdict& verdict : evaluations[0].verdicts) {
    EXPECT_EQ(verdict.num_losses, 1);
    EXPECT_FALSE(verdict.success);
    EXPECT_TRUE(std::isnan(verdict.settling_time));
    EXPECT_TRUE(std::isinf(verdict.steady_error[1]));
    EXPECT_NEAR(verdict.travel, 0.02 * (scene.num_steps - 1) / scene.simulation_rate, 1e-6);
  }
  EXPECT_EQ(evaluations[0].total.num_lost, scene.num_episodes);
  EXPECT_TRUE(std::isnan(evaluations[0].total.steady_error[1].median));
}

// Intervals from published tables of Wilson's: 0, 8 and 10 of 10.
TEST(Evaluate, IntervalsOfTheSuccessRate) {
  constexpr double kPrinted = 5e-5;
  const auto score = [](int num_successes) {
    std::vector<Verdict> verdicts(10);
    for (int k = 0; k < num_successes; ++k) verdicts[static_cast<std::size_t>(k)].success = true;
    return scoreOf("", verdicts);
  };
  EXPECT_NEAR(score(0).success_high, 0.2775, kPrinted);
  EXPECT_NEAR(score(8).success_low, 0.4902, kPrinted);
  EXPECT_NEAR(score(8).success_high, 0.9433, kPrinted);
  EXPECT_NEAR(score(10).success_low, 0.7225, kPrinted);
  EXPECT_EQ(scoreOf("", {}).num_episodes, 0u);
}

TEST(Evaluate, QuantilesIgnoreUndefinedValues) {
  std::vector<Verdict> verdicts(20);
  for (std::size_t k = 0; k < verdicts.size(); ++k) {
    verdicts[k].settling_time = k < 10 ? static_cast<float>(k + 1) : std::numeric_limits<float>::quiet_NaN();
  }
  const Quantiles quantiles = scoreOf("", verdicts).settling_time;
  EXPECT_EQ(quantiles.median, 5);
  EXPECT_EQ(quantiles.p95, 10);
  EXPECT_EQ(quantiles.max, 10);
}

TEST(Evaluate, RejectsUnknownControllersAndScenesWithoutTask) {
  const Device device = Device::open();
  const auto refusal = [&](const Scene& scene, const std::vector<std::string>& controllers) {
    return support::refusal([&] { evaluate(device, scene, controllers); });
  };
  EXPECT_THAT(refusal(alignScene(), {"none"}), ::testing::HasSubstr("controller none: not in this scene; it has exact, idle"));
  Scene scene = alignScene();
  scene.task.reset();
  EXPECT_THAT(refusal(scene, {}), ::testing::HasSubstr("this scene has no `task`"));
}

// Episodes are independent: extreme gains give NaN or diverge without effect on other episodes.
TEST(Evaluate, DivergingControllerDoesNotAffectOtherEpisodes) {
  Scene scene = alignScene();
  scene.num_steps = 40;
  scene.record = {"features", "poses", "actions"};
  TactileServo wild = scene.controllers[0].servo;
  wild[ServoFeature::kTotalForce] = {.selected = true, .kp = 1e300};
  wild[ServoFeature::kEdgeAngle].kp = 1e300;
  wild.max_linear_velocity = wild.max_angular_velocity = 1e300;
  Scene with_wild = scene;
  with_wild.controllers[1].servo = wild;
  const Device device = Device::open();
  const std::vector<Evaluation> evaluations = evaluate(device, with_wild, {"idle"});
  for (const Verdict& verdict : evaluations[0].verdicts) EXPECT_FALSE(std::isnan(verdict.steady_error[0]));

  const TestDirectory directory;
  std::vector<std::vector<double>> angles, controllers;
  for (const Scene* each : {&scene, &with_wild}) {
    const std::filesystem::path path = directory.path() / std::to_string(angles.size());
    ASSERT_TRUE(generate(device, *each, path, {.on_progress = {}, .stop = nullptr}).complete);
    const DatasetReader reader(path);
    angles.push_back(reader.readAsDouble("data/edge_angle", 0, reader.numFrames()));
    controllers.push_back(reader.readAsDouble("meta/controller", 0, scene.num_episodes));
  }
  EXPECT_EQ(controllers[0], controllers[1]);
  const auto num_wild = std::count(controllers[0].begin(), controllers[0].end(), 1.0);
  EXPECT_GT(num_wild, 3);  // of 24, each chosen half of the time
  EXPECT_LT(num_wild, 21);
  for (std::size_t e = 0; e < scene.num_episodes; ++e) {
    if (controllers[0][e] == 1) continue;
    const auto first = static_cast<std::ptrdiff_t>(e) * scene.num_steps;
    EXPECT_TRUE(std::equal(angles[0].begin() + first, angles[0].begin() + first + scene.num_steps, angles[1].begin() + first)) << e;
  }
}

// A data set draws one of the controllers for each episode.
TEST(Evaluate, SuccessColumnOfADataSetHasTheVerdicts) {
  Scene scene = alignScene();
  scene.record = {"features"};
  const Device device = Device::open();
  const std::vector<Evaluation> evaluations = evaluate(device, scene);
  const TestDirectory directory;
  for (const int batch_size : {5, 64}) {
    const std::filesystem::path path = directory.path() / std::to_string(batch_size);
    ASSERT_TRUE(generate(device, scene, path, {.batch_size = batch_size, .on_progress = {}, .stop = nullptr}).complete);
    const DatasetReader reader(path);
    const std::vector<double> controller = reader.readAsDouble("meta/controller", 0, scene.num_episodes);
    const std::vector<double> success = reader.readAsDouble("meta/success", 0, scene.num_episodes);
    for (std::size_t e = 0; e < success.size(); ++e)
      EXPECT_EQ(success[e], evaluations[static_cast<std::size_t>(controller[e])].verdicts[e].success) << e;
    const auto num_successes = std::count(success.begin(), success.end(), 1.0);
    EXPECT_GT(num_successes, 0);
    EXPECT_LT(num_successes, static_cast<std::ptrdiff_t>(scene.num_episodes));
  }
}

// Commanded - requested twist is white noise with the standard deviation drawn for the episode.
TEST(Evaluate, ActionNoiseHasItsStandardDeviation) {
  Scene scene = alignScene();
  scene.num_steps = 200;
  scene.record = {"actions"};
  scene.randomization.linear_action_noise = {1e-3, 2e-3};
  scene.randomization.angular_action_noise = {0.1, 0.1};
  scene.randomization.exploration_velocity = Range{0, 0.01};
  const TestDirectory directory;
  ASSERT_TRUE(generate(Device::open(), scene, directory.path(), {.on_progress = {}, .stop = nullptr}).complete);
  const DatasetReader reader(directory.path());
  const std::vector<double> action = reader.readAsDouble("data/action", 0, reader.numFrames());
  const std::vector<double> wanted = reader.readAsDouble("data/controller_action", 0, reader.numFrames());
  const std::vector<double> linear = reader.readAsDouble("meta/linear_action_noise", 0, scene.num_episodes);
  const std::vector<double> explored = reader.readAsDouble("meta/exploration_velocity", 0, scene.num_episodes);
  // Over 24 x 200 frames x 3 components: the relative error of a standard deviation is 1 / sqrt(2 n) = 0.6 %; five times that.
  constexpr double kSampling = 0.03;
  double sums[2] = {0, 0}, neighbours = 0;
  for (std::size_t row = 0; row < reader.numFrames(); ++row) {
    for (std::size_t k = 0; k < 6; ++k) {
      const double sd = k < 3 ? linear[row / 200] : 0.1;
      const auto noise = [&](std::size_t r) { return (action[6 * r + k] - wanted[6 * r + k]) / sd; };
      sums[k / 3] += noise(row) * noise(row);
      if (row % 200 > 0) neighbours += noise(row) * noise(row - 1);
    }
  }
  const double n = 3.0 * static_cast<double>(reader.numFrames());
  EXPECT_NEAR(std::sqrt(sums[0] / n), 1, kSampling);
  EXPECT_NEAR(std::sqrt(sums[1] / n), 1, kSampling);
  EXPECT_NEAR(neighbours / (2 * n), 0, kSampling);
  for (const double sd : linear) EXPECT_TRUE(sd >= 1e-3 && sd <= 2e-3 + 1e-9);
  EXPECT_NE(explored[0], explored[1]);
}

}  // namespace
}  // namespace taxelsim
