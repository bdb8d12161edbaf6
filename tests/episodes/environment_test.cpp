#include "taxelsim/environment.h"

#include <thread>

#include "episodes/batch.h"
#include "episodes/example_scene.h"
#include "episodes/recording.h"
#include "episodes/servo_input.h"
#include "simulation/host_threads.h"
#include "support/input_error.h"
#include "support/test.h"
#include "taxelsim/error.h"
#include "taxelsim/evaluate.h"

namespace taxelsim {
namespace {

using ::testing::HasSubstr;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

template <typename Call>
std::string refusal(const Call& call) {
  return support::refusal([&] { call(); });
}

// The scene's first servo as a caller of an Environment.
class ServoDriver {
 public:
  explicit ServoDriver(const Environment& environment)
      : period_(environment.controlPeriod() * environment.dt()),
        controller_(environment.scene().controllers[0].servo, environment.scene().sensor, environment.numInstances()),
        twists_(static_cast<std::size_t>(environment.numInstances())) {}

  void reset(int instance) { controller_.reset(instance); }

  std::span<const Twist> command(const EnvironmentView& view) {
    controller_.command(servoInputOf(view), period_, twists_);
    return twists_;
  }

 private:
  double period_;
  TactileServoController controller_;
  std::vector<Twist> twists_;
};

// Runs the episodes 0 to num_episodes - 1. Instances start at different times: instance i in turn i % 3, and whenever its episode has
// ended, while the others hold.
Recording recordEnvironment(Environment& environment, std::uint64_t num_episodes) {
  const auto num_instances = static_cast<std::size_t>(environment.numInstances());
  ServoDriver servo(environment);
  Recording recording;
  std::uint64_t next = 0;
  std::vector<std::uint8_t> mask(num_instances);
  std::vector<std::uint64_t> episodes(num_instances);
  std::vector<std::uint8_t> idle(num_instances, 1);
  for (std::size_t turn = 0;; ++turn) {
    for (std::size_t i = 0; i < num_instances; ++i) {
      mask[i] = idle[i] && next < num_episodes && turn >= i % 3;
      if (!mask[i]) continue;
      episodes[i] = next++;
      servo.reset(static_cast<int>(i));
    }
    environment.reset(mask, episodes);
    const EnvironmentView view = environment.observe();
    bool any_active = false;
    for (std::size_t i = 0; i < num_instances; ++i) {
      if (view.active[i]) recording[view.episodes[i]].push_back(bitsOf(view, i));
      any_active = any_active || view.active[i];
      idle[i] = !view.active[i] || view.frame_numbers[i] == environment.numFrames() - 1;
    }
    if (!any_active) return recording;
    environment.act(servo.command(view));
    environment.step();
  }
}

Recording recordSlice(const Model& model, const Scene& scene, int num_instances, int host_threads = 1) {
  SlicePlan plan(scene, kNoOutputs);
  plan.host_threads = host_threads;
  RecordingSink sink(scene.num_episodes, num_instances);
  std::vector<std::unique_ptr<Slice>> slices;
  slices.push_back(std::make_unique<Slice>(model, plan, num_instances, sink));
  runEpisodes(model.device(), slices, nullptr, [](const Slice::Stats&) {});
  return sink.recording();
}

struct Kind {
  const char* name;
  void (*change)(Scene&);
};

void usePanTilt(Scene& scene) {
  PanTilt platform;
  platform.drive.delay = 2;
  scene.robot = panTilt(platform);
}

void useTwoSensors(Scene& scene) {
  PanTilt platform;
  platform.sensors.push_back({"pan", {{0.01, 0, 0.02}, {1, 0, 0, 0}}});
  scene.robot = panTilt(platform);
}

void moveObjects(Scene& scene) {
  for (SceneObject& object : scene.objects) object.motion = Sinusoid{.amplitude = 1e-3};
  scene.randomization.linear_action_noise = {0, 1e-3};
  scene.randomization.angular_action_noise = {0, 0.1};
  scene.sensor.readout.delay = 0.02;
}

class EnvironmentTrajectory : public ::testing::TestWithParam<Kind> {};

TEST_P(EnvironmentTrajectory, IsThatOfASliceForAnyNumberOfInstances) {
  Scene scene = exampleScene();
  GetParam().change(scene);
  const Model model(Device::open(), modelOptionsOf(scene));
  const Recording expected = recordSlice(model, scene, 5);
  ASSERT_EQ(expected.size(), scene.num_episodes);
  for (const int num_instances : {1, 7, 64}) {
    Environment environment(model, scene, {.num_instances = num_instances});
    const Recording found = recordEnvironment(environment, scene.num_episodes);
    ASSERT_EQ(found.size(), expected.size()) << num_instances;
    for (const auto& [episode, frames] : expected) {
      ASSERT_EQ(found.at(episode).size(), frames.size());
      for (std::size_t k = 0; k < frames.size(); ++k) {
        ASSERT_EQ(found.at(episode)[k], frames[k]) << num_instances << " instances, episode " << episode << ", frame " << k;
      }
    }
  }
}

TEST_P(EnvironmentTrajectory, HasTheSameBitsForAnyNumberOfHostThreads) {
  Scene scene = exampleScene();
  GetParam().change(scene);
  const Model model(Device::open(), modelOptionsOf(scene));
  const Recording expected = recordSlice(model, scene, 7, 1);
  ASSERT_EQ(expected.size(), scene.num_episodes);
  for (const int host_threads : {2, 3, 8}) EXPECT_EQ(recordSlice(model, scene, 7, host_threads), expected) << host_threads << " threads";
}

TEST(HostThreads, AreOneOnASoftwareDeviceAndForSmallBatches) {
  EXPECT_EQ(hostThreads(DeviceType::kCpu, 1 << 20), 1);
  EXPECT_EQ(hostThreads(DeviceType::kDiscrete, 1023), 1);
  EXPECT_GE(hostThreads(DeviceType::kDiscrete, 1 << 20), 1);
  EXPECT_LE(hostThreads(DeviceType::kDiscrete, 1 << 20), 8);
}

TEST(SliceStats, CountOneSubmitPerFrameAndTimesOfAllParts) {
  const Scene scene = exampleScene();
  const Model model(Device::open(), modelOptionsOf(scene));
  const SlicePlan plan(scene, {});
  RecordingSink sink(scene.num_episodes, 5);
  std::vector<std::unique_ptr<Slice>> slices;
  slices.push_back(std::make_unique<Slice>(model, plan, 5, sink));
  HostTimes sums;
  int num_frames = 0;
  runEpisodes(model.device(), slices, nullptr, [&](const Slice::Stats& stats) {
    ++num_frames;
    EXPECT_EQ(stats.traffic.num_submits, 1u);
    EXPECT_GE(stats.traffic.bytes_to_device, 5u * (64 + 32) + 192);
    for (const auto part : {&HostTimes::inputs, &HostTimes::submit, &HostTimes::read, &HostTimes::episodes, &HostTimes::controller,
                            &HostTimes::sink, &HostTimes::robots, &HostTimes::objects}) {
      EXPECT_GE(stats.host.*part, 0);
      sums.*part += stats.host.*part;
    }
  });
  EXPECT_GT(num_frames, scene.num_steps);
  for (const double sum : {sums.submit, sums.controller, sums.sink}) EXPECT_GT(sum, 0);
}

INSTANTIATE_TEST_SUITE_P(Kinds, EnvironmentTrajectory,
                         ::testing::Values(Kind{"flying", [](Scene&) {}}, Kind{"pan_tilt", usePanTilt}, Kind{"two_sensors", useTwoSensors},
                                           Kind{"moving", moveObjects}),
                         [](const auto& param) { return std::string(param.param.name); });

// One environment of 4 instances, in frame 2.
class EnvironmentCalls : public ::testing::Test {
 protected:
  static Scene scene() {
    Scene scene = exampleScene();
    scene.task = Task{.hold = 0.02};
    (*scene.task)[TaskMeasure::kTotalForce] = TaskCriterion{.tolerance = 0.5};
    (*scene.task)[TaskMeasure::kCenter] = TaskCriterion{.tolerance = 5e-3};
    return scene;
  }

  EnvironmentCalls() {
    environment.reset(all, episodes);
    for (int k = 0; k < 2; ++k) environment.step();
  }

  const std::vector<std::uint8_t> all = std::vector<std::uint8_t>(4, 1);
  const std::vector<std::uint64_t> episodes{10, 11, 12, 13};
  Environment environment = Environment(Device::open(), scene(), {.num_instances = 4});
};

TEST_F(EnvironmentCalls, ResetByMaskKeepsTheOtherInstances) {
  const EnvironmentView view = environment.observe();
  std::vector<std::vector<std::uint64_t>> before;
  for (std::size_t i = 0; i < 4; ++i) before.push_back(bitsOf(view, i));
  const std::vector<std::uint8_t> mask{0, 1, 0, 0};
  environment.reset(mask, episodes);
  const EnvironmentView after = environment.observe();
  EXPECT_THAT(std::vector<int>(after.frame_numbers.begin(), after.frame_numbers.end()), ::testing::ElementsAre(2, 0, 2, 2));
  for (const std::size_t i : {0, 2, 3}) EXPECT_EQ(bitsOf(after, i), before[i]) << i;
  EXPECT_NE(bitsOf(after, 1), before[1]);
}

TEST_F(EnvironmentCalls, RefusesActionsThatAreNotFinite) {
  std::vector<Twist> twists(4, Twist{.v = {0, 0, 1e-3}, .w = {}});
  environment.act(twists);
  environment.step();
  environment.step();  // frame 4, a control tick
  twists[2].w[1] = kNan;
  EXPECT_THAT(refusal([&] { environment.act(twists); }), HasSubstr("action of instance 2 (episode 12): w_y = nan is not allowed: finite"));
  // Nothing has changed: the robots keep their previous twist.
  const Pose before = environment.observe().X_WS[0];
  environment.step();
  EXPECT_NEAR(environment.observe().X_WS[0].position[2] - before.position[2], 1e-5, 1e-12);
  // Between ticks no action is taken, so none is checked.
  environment.act(twists);
}

TEST_F(EnvironmentCalls, RefusesWrongLengthsAndUnknownInstances) {
  const std::vector<Twist> twists(3);
  EXPECT_THAT(refusal([&] { environment.act(twists); }), HasSubstr("twists: 3 values are not allowed: 4"));
  EXPECT_THAT(refusal([&] { environment.reset(std::vector<std::uint8_t>(5), episodes); }), HasSubstr("mask: 5 values are not allowed: 4"));
  EXPECT_THAT(refusal([&] { environment.reset(all, std::vector<std::uint64_t>(1)); }), HasSubstr("episodes: 1 values are not allowed: 4"));
  EXPECT_THAT(refusal([&] { environment.actJoints({}); }), HasSubstr("this robot has no joints"));
  EXPECT_THAT(refusal([&] { environment.judge(4); }), HasSubstr("instance: 4 is not allowed: 0 to 3"));
}

TEST_F(EnvironmentCalls, MovesWithItsState) {
  Environment moved = std::move(environment);
  EXPECT_EQ(moved.observe().frame_numbers[3], 2);
  environment = std::move(moved);
  environment.step();
  EXPECT_EQ(environment.observe().frame_numbers[3], 3);
}

TEST_F(EnvironmentCalls, InstancesAreIdleAfterTheirLastFrame) {
  for (int k = 2; k < environment.numFrames() - 1; ++k) environment.step();
  EXPECT_EQ(environment.observe().active[0], 1);
  EXPECT_EQ(environment.observe().frame_numbers[0], environment.numFrames() - 1);
  environment.step();
  EXPECT_EQ(environment.observe().active[0], 0);
  environment.step();
  environment.reset(all, episodes);
  EXPECT_EQ(environment.observe().frame_numbers[0], 0);
}

TEST_F(EnvironmentCalls, NeedsAResetFirst) {
  Environment fresh(environment.model(), environment.scene(), {.num_instances = 2});
  const std::vector<Twist> twists(2);
  EXPECT_THROW(fresh.observe(), std::logic_error);
  EXPECT_THROW(fresh.act(twists), std::logic_error);
  EXPECT_THROW(fresh.step(), std::logic_error);
  EXPECT_THROW(fresh.judge(0), std::logic_error);
  fresh.reset(std::vector<std::uint8_t>{1, 0}, std::vector<std::uint64_t>{3, 0});
  EXPECT_EQ(fresh.judge(0).episode, 3u);
  EXPECT_THROW(fresh.judge(1), std::logic_error);
}

TEST(Environment, JudgesAsEvaluateDoes) {
  Scene scene = exampleScene();
  scene.num_steps = 30;
  scene.num_episodes = 6;
  scene.task = Task{.hold = 0.05};
  (*scene.task)[TaskMeasure::kTotalForce] = TaskCriterion{.tolerance = 0.3};
  (*scene.task)[TaskMeasure::kCenter] = TaskCriterion{.tolerance = 2e-3};
  const Device device = Device::open();
  const std::vector<Verdict> expected = evaluate(device, scene)[0].verdicts;

  Environment environment(device, scene, {.num_instances = 6});
  ServoDriver servo(environment);
  environment.reset(std::vector<std::uint8_t>(6, 1), std::vector<std::uint64_t>{0, 1, 2, 3, 4, 5});
  for (int k = 1; k < environment.numFrames(); ++k) {
    EXPECT_FALSE(environment.judge(0).success) << "before the last frame";
    environment.act(servo.command(environment.observe()));
    environment.step();
  }
  const TaskState state = environment.taskState();
  int num_successes = 0;
  for (int i = 0; i < 6; ++i) {
    const Verdict verdict = environment.judge(i);
    const auto& of = expected[static_cast<std::size_t>(i)];
    EXPECT_EQ(verdict.success, of.success);
    EXPECT_EQ(verdict.peak_force, of.peak_force);
    EXPECT_EQ(verdict.travel, of.travel);
    EXPECT_EQ(verdict.steady_error[1], of.steady_error[1]);
    EXPECT_EQ(verdict.start_error[2], of.start_error[2]);
    EXPECT_TRUE(verdict.settling_time == of.settling_time || (std::isnan(verdict.settling_time) && std::isnan(of.settling_time)));
    num_successes += verdict.success;
    const double* errors = &state.errors[static_cast<std::size_t>(i) * kNumTaskMeasures];
    EXPECT_TRUE(std::isnan(errors[0]) && std::isnan(errors[3])) << "no criterion";
    EXPECT_EQ(state.within[static_cast<std::size_t>(i)], errors[1] <= 0.3 && errors[2] <= 2e-3);
    EXPECT_EQ(state.contact[static_cast<std::size_t>(i)], 1);
  }
  EXPECT_GT(num_successes, 0);
  EXPECT_LT(num_successes, 6);
}

TEST(Environment, RefusesScenesAndModelsThatDoNotFit) {
  const Device device = Device::open();
  EXPECT_THAT(refusal([&] { Environment(device, exampleContacts(), {}); }), HasSubstr("kind: contacts found, an environment needs servo"));
  EXPECT_THAT(refusal([&] { Environment(device, exampleScene(), {.num_instances = 0}); }), HasSubstr("num_instances: 0 is not allowed"));
  EXPECT_THAT(refusal([&] { Environment(device, exampleScene(), {.max_regions = 2}); }),
              HasSubstr("max_regions: 2 is not allowed: 0 without contact features"));
  Scene other = exampleScene();
  other.objects.pop_back();
  const Model model(device, modelOptionsOf(other));
  EXPECT_EQ(refusal([&] { Environment(model, exampleScene(), {}); }),
            "model: 1 objects are not allowed: the scene has 2; make the model from modelOptionsOf(scene)");
  Environment environment(model, other, {});
  EXPECT_THAT(refusal([&] {
                environment.reset(std::vector<std::uint8_t>{1}, std::vector<std::uint64_t>{0});
                environment.taskState();
              }),
              HasSubstr("this scene has no `task`"));
}

TEST(Environment, RefusesModelsThatGiveOtherResults) {
  const Device device = Device::open();
  const Scene scene = exampleScene();
  const auto refusalOf = [&](void (*change)(ModelOptions&)) {
    ModelOptions options = modelOptionsOf(scene);
    change(options);
    const Model model(device, options);
    return refusal([&] { Environment(model, scene, {}); });
  };
  EXPECT_EQ(
      refusalOf([](ModelOptions& options) { options.sensor.readout.trigger = 0.03; }),
      "model: another sensor than the scene's: readout.trigger: 0.03 there, 0.02 requested; make the model from modelOptionsOf(scene)");
  using Options = ModelOptions;
  for (void (*change)(Options&) :
       {+[](Options& options) { std::get<Winkler>(options.sensor.skin.law).normal_contact_stiffness *= 1.01; },
        +[](Options& options) { options.sensor.patches[0].pitch[1] *= 1.01; },
        +[](Options& options) { options.sensor.samples_per_taxel = 3; }, +[](Options& options) { options.sensor.psf = {}; },
        +[](Options& options) { options.sensor.frame_rate = 50; }}) {
    EXPECT_THAT(refusalOf(change), HasSubstr("model: another sensor than the scene's: "));
  }
  EXPECT_EQ(refusalOf([](Options& options) { options.objects[1].shape = Sphere{0.0123}; }),
            "model: object 1 (ball) differs from the scene's; make the model from modelOptionsOf(scene)");
  EXPECT_THAT(refusalOf([](Options& options) { options.objects[0].shape = Capsule{8e-3, 0.1}; }), HasSubstr("object 0 (bar) differs"));
  EXPECT_EQ(refusalOf([](Options& options) {
              options.sensor.name = "twin";
              options.objects[1].name = "twin";
            }),
            "no refusal");
}

TEST(EpisodeKey, DependsOnSeedInstanceAndResets) {
  // Stored values: part of the interface, so that a seed gives the same episodes in every version.
  EXPECT_EQ(episodeKey(0, 0, 0), 5085108024689182621u);
  EXPECT_EQ(episodeKey(7, 3, 2), 11805590387805899064u);
  std::set<std::uint64_t> keys;
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    for (std::uint32_t instance = 0; instance < 32; ++instance) {
      for (std::uint64_t resets = 0; resets < 32; ++resets) keys.insert(episodeKey(seed, instance, resets));
    }
  }
  keys.insert(episodeKey(std::uint64_t{1} << 32, 0, 0));
  keys.insert(episodeKey(0, 0, std::uint64_t{1} << 32));
  EXPECT_EQ(keys.size(), 4u * 32 * 32 + 2);
}

TEST(Environment, RunInTwoThreadsGivesTheSameFrames) {
  const Scene scene = exampleScene();
  const Model model(Device::open(), modelOptionsOf(scene));
  Recording recordings[2];
  const auto run = [&](int k) {
    Environment environment(model, scene, {.num_instances = 3});
    recordings[k] = recordEnvironment(environment, 6);
  };
  std::thread first(run, 0), second(run, 1);
  first.join();
  second.join();
  EXPECT_EQ(recordings[0], recordings[1]);
  EXPECT_EQ(recordings[0].size(), 6u);
}

}  // namespace
}  // namespace taxelsim
