// Policies of the caller in evaluate().
#include "taxelsim/policy.h"

#include "episodes/example_scene.h"
#include "episodes/servo_input.h"
#include "support/input_error.h"
#include "support/test.h"
#include "taxelsim/error.h"
#include "taxelsim/evaluate.h"

namespace taxelsim {
namespace {

using ::testing::HasSubstr;

Scene taskScene() {
  Scene scene = exampleScene();
  scene.num_steps = 20;
  scene.num_episodes = 12;
  scene.randomization.linear_action_noise = {0, 1e-3};
  scene.randomization.angular_action_noise = {0, 0.05};
  scene.task = Task{.hold = 0.05};
  (*scene.task)[TaskMeasure::kTotalForce] = TaskCriterion{.tolerance = 0.3};
  (*scene.task)[TaskMeasure::kCenter] = TaskCriterion{.tolerance = 3e-3};
  return scene;
}

// The scene's first servo. Its loops have neither integral nor derivative, so it is a pure function of the observation.
Policy servoPolicy(const Scene& scene) {
  Policy policy{.name = "twin"};
  policy.act = [&scene](const PolicyInput& input, std::span<Twist> twists) {
    const EnvironmentView& view = input.view;
    TactileServoController controller(scene.controllers[0].servo, scene.sensor, static_cast<int>(view.active.size()));
    controller.command(servoInputOf(view), 1 / scene.control_rate, twists);
  };
  return policy;
}

void expectSame(const std::vector<Verdict>& a, const std::vector<Verdict>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t e = 0; e < a.size(); ++e) {
    EXPECT_EQ(a[e].success, b[e].success) << e;
    EXPECT_EQ(std::memcmp(a[e].start_error.data(), b[e].start_error.data(), sizeof a[e].start_error), 0) << e;
    EXPECT_EQ(std::memcmp(a[e].steady_error.data(), b[e].steady_error.data(), sizeof a[e].steady_error), 0) << e;
    EXPECT_EQ(std::memcmp(&a[e].settling_time, &b[e].settling_time, sizeof(float)), 0) << e;
    EXPECT_EQ(a[e].travel, b[e].travel) << e;
    EXPECT_EQ(a[e].peak_force, b[e].peak_force) << e;
    EXPECT_EQ(a[e].robot, b[e].robot) << e;
  }
}

std::string refusalOf(const Scene& scene, const Policy& policy) {
  return support::refusal([&] { evaluate(Device::open(), scene, {}, {.batch_size = 5, .on_progress = {}, .policy = policy}); });
}

TEST(EvaluatePolicy, ThatIsTheServoHasItsVerdictsInAnyBatch) {
  const Scene scene = taskScene();
  const Device device = Device::open();
  const std::vector<Evaluation> both =
      evaluate(device, scene, {"tactile_servo"}, {.batch_size = 12, .num_slices = 1, .on_progress = {}, .policy = servoPolicy(scene)});
  ASSERT_EQ(both.size(), 2u);
  EXPECT_EQ(both[0].controller, "twin");
  EXPECT_EQ(both[1].controller, "tactile_servo");
  expectSame(both[0].verdicts, both[1].verdicts);
  EXPECT_GT(both[0].total.num_successes, 0u);
  const std::vector<Evaluation> cut =
      evaluate(device, scene, {}, {.batch_size = 5, .num_slices = 2, .on_progress = {}, .policy = servoPolicy(scene)});
  ASSERT_EQ(cut.size(), 1u) << "controllers of the scene run only if they are named";
  expectSame(both[0].verdicts, cut[0].verdicts);
}

TEST(EvaluatePolicy, IsCalledOncePerSliceAndTickForAllDueInstances) {
  const Scene scene = taskScene();
  std::set<int> instances;
  int num_calls = 0;
  std::size_t num_actions = 0;
  Policy policy{.name = "rest"};
  policy.act = [&](const PolicyInput& input, std::span<Twist> twists) {
    ++num_calls;
    num_actions += input.instances.size();
    std::size_t num_due = 0;
    for (const std::uint8_t due : input.view.control_due) num_due += due;
    EXPECT_EQ(input.instances.size(), num_due);
    EXPECT_EQ(twists.size(), input.view.active.size());
    for (const int i : input.instances) {
      EXPECT_EQ(input.view.frame_numbers[static_cast<std::size_t>(i)] % 2, 0) << "50 Hz of 100 Hz";
      instances.insert(input.first_instance + i);
      twists[static_cast<std::size_t>(i)] = {};
    }
  };
  evaluate(Device::open(), scene, {}, {.batch_size = 6, .num_slices = 2, .on_progress = {}, .policy = policy});
  EXPECT_EQ(instances, (std::set<int>{0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(num_calls, 2 * 2 * 10) << "slices x episodes of an instance x ticks";
  EXPECT_EQ(num_actions, 12u * 10);
}

TEST(EvaluatePolicy, ExceptionsEndTheRun) {
  Policy policy{.name = "broken"};
  policy.act = [](const PolicyInput& input, std::span<Twist> twists) {
    if (input.view.frame_numbers[0] == 4) throw std::runtime_error("no weights");
    std::fill(twists.begin(), twists.end(), Twist{});
  };
  try {
    evaluate(Device::open(), taskScene(), {}, {.on_progress = {}, .policy = policy});
    FAIL() << "no error";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "no weights");
  }
}

TEST(EvaluatePolicy, RefusesActionsThatAreNotFinite) {
  Policy policy{.name = "net"};
  policy.act = [](const PolicyInput& input, std::span<Twist> twists) {
    for (const int i : input.instances) {
      Twist& twist = twists[static_cast<std::size_t>(i)];
      twist = {};
      if (input.view.episodes[static_cast<std::size_t>(i)] == 3) twist.v[2] = std::numeric_limits<double>::infinity();
    }
  };
  // Two slices of 3 and 2 instances: episode 3 starts on the first instance of the second.
  EXPECT_EQ(refusalOf(taskScene(), policy), "policy net: action of instance 3 (episode 3): v_z = inf is not allowed: finite");
  policy.act = [](const PolicyInput&, std::span<Twist>) {};
  EXPECT_THAT(refusalOf(taskScene(), policy), HasSubstr("policy net: action of instance 0 (episode 0): v_x = nan is not allowed: finite"));
}

TEST(EvaluatePolicy, RefusesPoliciesThatCannotAct) {
  const Scene scene = taskScene();
  const auto rest = [](const PolicyInput&, std::span<Twist>) {};
  const auto rest_joints = [](const PolicyInput&, std::span<double>) {};
  EXPECT_THAT(refusalOf(scene, {.name = "tactile_servo", .act = rest}), HasSubstr("a controller of the scene has the same name"));
  EXPECT_THAT(refusalOf(scene, {.name = "", .act = rest}), HasSubstr("policy: the name is empty"));
  EXPECT_THAT(refusalOf(scene, {.name = "p"}), HasSubstr("policy p: exactly one of act and act_joints must be set"));
  EXPECT_THAT(refusalOf(scene, {.name = "p", .act = rest, .act_joints = rest_joints}), HasSubstr("exactly one of"));
  EXPECT_THAT(refusalOf(scene, {.name = "p", .act_joints = rest_joints}), HasSubstr("the robot of the scene has no joints"));
  EXPECT_THAT(refusalOf(scene, {.name = "p", .max_regions = 1, .act = rest}), HasSubstr("max_regions: 1 is not allowed: 0"));
}

// One policy asks for all outputs that frames have, one for none.
TEST(EvaluatePolicy, GetsEveryOutputThatItAsksFor) {
  Scene scene = taskScene();
  scene.num_episodes = 1;
  scene.num_steps = 1;
  scene.task->hold = 1 / scene.simulation_rate;
  scene.sensor.skin.friction = {.tangential_stiffness = 5e7, .friction_coefficient = 0.5};
  scene.sensor.readout.three_axis.emplace();
  for (std::size_t axis = 0; axis < 3; ++axis) scene.sensor.readout.three_axis->gain[axis][axis] = 1000;
  const std::size_t num_taxels = static_cast<std::size_t>(numTaxels(scene.sensor)), num_rows = 2;  // sensor and patch
  struct Case {
    const char* name;
    bool OutputOptions::*output;
    std::size_t size;
    std::size_t (*found)(const FrameView&);
  };
  using View = const FrameView&;
  const std::vector<Case> cases{
      {"tactile_normal_force", &OutputOptions::tactile_normal_force, num_taxels,
       [](View view) { return view.ground_truth.tactile_normal_force.size(); }},
      {"tactile_shear_force", &OutputOptions::tactile_shear_force, 2 * num_taxels,
       [](View view) { return view.ground_truth.tactile_shear_force.size(); }},
      {"penetration_depth", &OutputOptions::penetration_depth, num_taxels,
       [](View view) { return view.ground_truth.penetration_depth.size(); }},
      {"taxel_counts", &OutputOptions::taxel_counts, 3 * num_taxels, [](View view) { return view.taxel_counts.size(); }},
      {"contact_features", &OutputOptions::contact_features, num_rows, [](View view) { return view.contact.total_force.size(); }},
      {"clean_contact_features", &OutputOptions::clean_contact_features, num_rows,
       [](View view) { return view.ground_truth.contact.total_force.size(); }},
      {"tactile_jacobian", &OutputOptions::tactile_jacobian, 6 * num_rows, [](View view) { return view.jacobian.total_force.size(); }},
      {"clean_tactile_jacobian", &OutputOptions::clean_tactile_jacobian, 36,
       [](View view) { return view.ground_truth.jacobian.contact_wrench.size(); }},
      {"taxel_jacobian", &OutputOptions::taxel_jacobian, 6 * num_taxels,
       [](View view) { return view.ground_truth.taxel_jacobian.size(); }}};
  for (const bool is_asked : {true, false}) {
    Policy policy{.name = "outputs"};
    for (const Case& output : cases) policy.outputs.*output.output = is_asked;
    policy.act = [&](const PolicyInput& input, std::span<Twist> twists) {
      std::fill(twists.begin(), twists.end(), Twist{});
      for (const Case& output : cases) EXPECT_EQ(output.found(input.view.frame), is_asked ? output.size : 0) << output.name;
    };
    evaluate(Device::open(), scene, {}, {.on_progress = {}, .policy = policy});
  }
}

TEST(EvaluatePolicy, CommandsJointsInAnyBatch) {
  Scene scene = taskScene();
  scene.robot = panTilt({});
  Policy policy{.name = "joints"};
  policy.act_joints = [](const PolicyInput& input, std::span<double> velocities) {
    for (const int i : input.instances) {
      const auto row = static_cast<std::size_t>(i);
      velocities[2 * row] = 0.05 * input.view.frame.edge_angle[row];
      velocities[2 * row + 1] = 0.02;
    }
  };
  const Device device = Device::open();
  const auto verdicts = [&](int batch_size, int num_slices) {
    return evaluate(device, scene, {}, {.batch_size = batch_size, .num_slices = num_slices, .on_progress = {}, .policy = policy})[0]
        .verdicts;
  };
  const std::vector<Verdict> whole = verdicts(12, 1);
  expectSame(whole, verdicts(5, 2));
  for (const Verdict& verdict : whole) EXPECT_GT(verdict.travel, 0);
}

}  // namespace
}  // namespace taxelsim
