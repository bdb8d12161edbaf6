// Joint velocities as actions.
#include <Eigen/Dense>

#include "control/chain.h"
#include "episodes/example_scene.h"
#include "support/input_error.h"
#include "support/test.h"
#include "taxelsim/environment.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// A twist that differs by instance and frame; m/s and rad/s.
Twist twistAt(int instance, int frame) {
  Twist twist;
  for (std::size_t k = 0; k < 3; ++k) {
    const double phase = 0.7 * frame + 1.3 * instance + static_cast<double>(k);
    twist.v[k] = 0.01 * std::sin(phase);
    twist.w[k] = 0.1 * std::cos(phase);
  }
  return twist;
}

// J^+ twist in the posture `positions` (num_joints), by a singular value decomposition.
Eigen::VectorXd jointVelocities(const Manipulator& robot, const double* positions, const Twist& twist) {
  const auto num_joints = static_cast<Eigen::Index>(robot.joints.size());
  Eigen::MatrixXd transposed(6, num_joints);  // column-major, so its memory is that of J^T (num_joints x 6) by rows
  Chain(robot.sensors[0], static_cast<int>(num_joints)).poseAt(positions, transposed.data());
  const Eigen::Vector<double, 6> v{twist.v[0], twist.v[1], twist.v[2], twist.w[0], twist.w[1], twist.w[2]};
  std::vector<Eigen::Index> rows;
  for (Eigen::Index k = 0; k < 6; ++k) {
    if (robot.selection[static_cast<std::size_t>(k)]) rows.push_back(k);
  }
  const Eigen::MatrixXd J = transposed(rows, Eigen::all);
  return J.jacobiSvd(Eigen::ComputeThinU | Eigen::ComputeThinV).solve(Eigen::VectorXd(v(rows)));
}

class JointActionsOf : public ::testing::TestWithParam<const char*> {};

TEST_P(JointActionsOf, PseudoInverseTimesTwistMoveAsTheTwist) {
  constexpr int kNumInstances = 3, kNumFrames = 60;
  Scene scene = exampleScene();
  scene.robot = loadScene(TAXELSIM_SOURCE_DIR "/scenes/experiments/paper/" + std::string(GetParam())).robot;
  auto& robot = std::get<Manipulator>(scene.robot);
  robot.drive = {};  // a rounding drive could amplify the last bit to a step
  scene.num_steps = kNumFrames + 1;
  scene.control_rate = scene.simulation_rate;  // J at every frame, as the twist has it
  const Model model(Device::open(), modelOptionsOf(scene));
  Environment by_twists(model, scene, {.num_instances = kNumInstances}), by_joints(model, scene, {.num_instances = kNumInstances});
  for (Environment* environment : {&by_twists, &by_joints}) {
    environment->reset(std::vector<std::uint8_t>(kNumInstances, 1), std::vector<std::uint64_t>{0, 1, 2});
  }
  const std::size_t num_joints = robot.joints.size();
  double travel = 0, largest = 0;
  for (int frame = 0; frame < kNumFrames; ++frame) {
    std::vector<Twist> twists;
    std::vector<double> velocities;
    const std::span<const double> positions = by_joints.observe().joint_positions;
    for (int i = 0; i < kNumInstances; ++i) {
      twists.push_back(twistAt(i, frame));
      const Eigen::VectorXd q = jointVelocities(robot, &positions[static_cast<std::size_t>(i) * num_joints], twists.back());
      velocities.insert(velocities.end(), q.begin(), q.end());
    }
    by_twists.act(twists);
    by_joints.actJoints(velocities);
    by_twists.step();
    by_joints.step();
    const EnvironmentView expected = by_twists.observe(), found = by_joints.observe();
    for (std::size_t k = 0; k < expected.joint_positions.size(); ++k) {
      largest = std::max(largest, std::abs(found.joint_positions[k] - expected.joint_positions[k]));
      travel = std::max(travel, std::abs(expected.joint_positions[k] - robot.joints[k % num_joints].initial_position));
    }
    for (const std::uint8_t status : expected.robot_status) ASSERT_EQ(status, 0) << "no limit and no damping, which J^+ does not have";
  }
  // Two solvers in double: the relative error of a velocity is at most about kappa(J)^2 2^-52 (normal equations), with kappa < 100 without
  // damping (singular_threshold 0.05, |J| < 2). Velocities stay below 1 rad/s, so 0.6 s give at most 0.6 1e4 2^-52.
  EXPECT_LT(largest, 0.6 * 1e4 * std::numeric_limits<double>::epsilon());
  EXPECT_GT(travel, 1e-3);
}

INSTANTIATE_TEST_SUITE_P(Robots, JointActionsOf, ::testing::Values("pan_tilt_scene.yaml", "cartesian_hand_scene.yaml"),
                         [](const auto& param) { return std::string(param.param).substr(0, 3); });

TEST(JointActions, MoveTheJoints) {
  Scene scene = exampleScene();
  PanTilt platform;
  platform.drive = {};
  scene.robot = panTilt(platform);
  Environment environment(Device::open(), scene, {.num_instances = 2});
  ASSERT_EQ(environment.numJoints(), 2);
  environment.reset(std::vector<std::uint8_t>(2, 1), std::vector<std::uint64_t>{0, 1});
  std::vector<double> velocities{0.1, -0.2, 0, 1e9};
  environment.actJoints(velocities);
  environment.step();
  const EnvironmentView view = environment.observe();
  EXPECT_NEAR(view.joint_velocities[0], 0.1, 1e-12);
  EXPECT_NEAR(view.joint_velocities[1], -0.2, 1e-12);
  EXPECT_NEAR(view.joint_positions[1], -0.2 * environment.dt(), 1e-12);
  EXPECT_NEAR(view.joint_velocities[3], platform.max_velocity, 1e-9);
  EXPECT_EQ(view.robot_status[0], 0);
  EXPECT_EQ(view.robot_status[1], 2);
  environment.step();
  velocities[3] = kNan;
  EXPECT_THAT(support::inputError([&] { environment.actJoints(velocities); }),
              ::testing::HasSubstr("action of instance 1 (episode 1): velocity of joint tilt = nan"));
}

TEST(JointActions, EndWithTheNextTwist) {
  Scene scene = exampleScene();
  PanTilt platform;
  platform.drive = {};
  scene.robot = panTilt(platform);
  scene.control_rate = scene.simulation_rate;
  Environment environment(Device::open(), scene, {.num_instances = 1});
  environment.reset(std::vector<std::uint8_t>{1}, std::vector<std::uint64_t>{0});
  environment.actJoints(std::vector<double>{0.1, -0.2});
  environment.step();
  environment.act(std::vector<Twist>{Twist{}});
  environment.step();
  EXPECT_EQ(environment.observe().joint_velocities[0], 0);
  EXPECT_EQ(environment.observe().joint_velocities[1], 0);
}

// Revolute joints have the scene's angular action noise, drawn for (episode, frame, joint).
TEST(JointActions, HaveActionNoise) {
  Scene scene = exampleScene();
  PanTilt platform;
  platform.drive = {};
  scene.robot = panTilt(platform);
  constexpr double kDeviation = 0.01;  // rad/s
  scene.randomization.angular_action_noise = {kDeviation, kDeviation};
  constexpr std::size_t kNumInstances = 64;
  Environment environment(Device::open(), scene, {.num_instances = kNumInstances});
  std::vector<std::uint64_t> episodes(kNumInstances);
  for (std::size_t i = 0; i < kNumInstances; ++i) episodes[i] = i / 2;
  environment.reset(std::vector<std::uint8_t>(kNumInstances, 1), episodes);
  environment.actJoints(std::vector<double>(2 * kNumInstances, 0.1));
  environment.step();
  const std::span<const double> velocities = environment.observe().joint_velocities;
  double squares = 0;
  for (std::size_t k = 0; k < velocities.size(); ++k) {
    squares += std::pow(velocities[k] - 0.1, 2);
    if (k / 2 % 2 == 1) {
      EXPECT_EQ(velocities[k], velocities[k - 2]) << "of the same episode";
    }
  }
  EXPECT_NE(velocities[0], velocities[1]);
  EXPECT_NE(velocities[0], velocities[4]);
  // 64 independent numbers: five standard deviations of their standard deviation, 5 / sqrt(2 64).
  EXPECT_NEAR(std::sqrt(squares / static_cast<double>(velocities.size())), kDeviation, 0.44 * kDeviation);
}

}  // namespace
}  // namespace taxelsim
