#include "episodes/device_servos.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/sin_cos.h"
#include "control/chain.h"
#include "control/robots.h"
#include "scene/skin_ranges.h"
#include "sensor/skin.h"

namespace taxelsim {
namespace {

bool isZero(const Range& range) {
  return range.min == 0 && range.max == 0;
}

std::string_view whyOnHost(const TactileServo& servo, bool is_free_flying, double dt) {
  if (servo.jacobian != TactileJacobianSource::kNominal) return "a servo inverts the measured Jacobian";
  if (servo.edge_angle_source == EdgeAngleSource::kExact) return "a servo reads the exact edge angle";
  // A difference of line angles is reduced once.
  if (std::abs(servo[ServoFeature::kEdgeAngle].reference.value_or(0)) > std::numbers::pi / 2) return "a reference angle is too large";
  // The exponential takes the sine of half the rotation.
  if (is_free_flying && !(servo.max_angular_velocity * dt <= kLargestReducedAngle)) return "a servo may rotate too far in a step";
  return {};
}

// Largest angle or position that a joint can reach in an episode.
double reachOf(const Joint& joint, double step, double duration) {
  const double moved = std::abs(joint.initial_position) + step + joint.max_velocity * duration;
  return std::min(std::max(std::abs(joint.lower), std::abs(joint.upper)), moved);
}

std::string_view whyOnHost(const Manipulator& robot, double duration) {
  if (robot.sensors.size() > 1) return "the robot carries several sensors";
  const MountedSensor& sensor = robot.sensors.front();
  if (sensor.chain.empty()) return "no joint moves the sensor";
  for (const ChainJoint& joint : sensor.chain) {
    const double reach = reachOf(robot.joints[static_cast<std::size_t>(joint.joint)], robot.drive.position_step, duration);
    const double largest = std::abs(joint.multiplier) * reach + std::abs(joint.offset);
    if (joint.type == JointType::kRevolute && !(largest <= kLargestReducedAngle)) return "a joint may turn too far";
  }
  return {};
}

}  // namespace

std::string_view whyOnHost(const SlicePlan& plan) {
  const Scene& scene = plan.scene;
  if (!plan.servos) return "the scene's servos do not command";
  const auto* const manipulator = std::get_if<Manipulator>(&scene.robot);
  if (manipulator != nullptr) {
    const std::string_view why = whyOnHost(*manipulator, plan.num_frames * plan.dt);
    if (!why.empty()) return why;
  }
  if (scene.contact_points) return "contact points are recorded";
  if (scene.objects.empty()) return "no objects";
  if (std::any_of(scene.objects.begin(), scene.objects.end(), [](const SceneObject& object) { return object.motion.has_value(); })) {
    return "an object moves";
  }
  if (hasFriction(scene.sensor.skin)) return "the skin has friction";
  if (foundationOf(scene.sensor.skin).normal_exponent != 1) return "the skin's pressure is not proportional to depth";
  if (!isZero(scene.randomization.linear_action_noise) || !isZero(scene.randomization.angular_action_noise)) return "actions have noise";
  if (variesMounting(scene.randomization)) return "the mounting varies";
  for (int c = 0; c < static_cast<int>(scene.controllers.size()); ++c) {
    if (plan.servos->servo && *plan.servos->servo != c) continue;
    const std::string_view why = whyOnHost(scene.controllers[static_cast<std::size_t>(c)].servo, manipulator == nullptr, plan.dt);
    if (!why.empty()) return why;
  }
  return {};
}

std::optional<LoopRobot> loopRobotOf(const Robot& robot) {
  const auto* const manipulator = std::get_if<Manipulator>(&robot);
  if (manipulator == nullptr) return {};
  Robots rest(robot, 1);
  rest.reset(0, Pose{});
  LoopRobot start{.robot = *manipulator,
                  .X_WB = rest.X_WB()[0],
                  .X_WS = rest.X_WS()[0],
                  .positions = {rest.jointPositions().begin(), rest.jointPositions().end()},
                  .commands = {},
                  .jacobian = std::vector<double>(6 * manipulator->joints.size())};
  for (const Joint& joint : manipulator->joints) start.commands.push_back(joint.initial_position);
  Chain(manipulator->sensors.front(), rest.numJoints()).poseAt(start.positions.data(), start.jacobian.data());
  return start;
}

DeviceServoController::DeviceServoController(const ServoPlan& servos, const EpisodePlan& episodes, ServoLoop& loop)
    : servos_(servos), scene_(episodes.scene), loop_(loop), starts_(static_cast<std::size_t>(loop.numInstances())) {}

void DeviceServoController::start(int instance, const EpisodeDraw& draw) {
  const int servo = servos_.servo.value_or(draw.controller);
  LoopStart& start = starts_[static_cast<std::size_t>(instance)];
  start = {.object = draw.object,
           .X_WO = draw.X_SO,
           .servo = servo,
           .exploration_velocity =
               draw.exploration_velocity.value_or(scene_.controllers[static_cast<std::size_t>(servo)].servo.exploration_velocity),
           .start_force = draw.load};
  loop_.start(instance, start);
}

void DeviceServoController::describe(int instance, EpisodeRecord& record) const {
  const LoopStart& start = starts_[static_cast<std::size_t>(instance)];
  record.controller = start.servo;
  record.exploration_velocity = static_cast<float>(start.exploration_velocity);
}

}  // namespace taxelsim
