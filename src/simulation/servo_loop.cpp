#include "simulation/servo_loop.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sensor/skin.h"
#include "simulation/batch_plan.h"
#include "simulation/simulator_access.h"
#include "simulation/simulator_impl.h"

namespace taxelsim {
namespace {

static_assert(layout::kServoFeatures == kNumServoFeatures && layout::kServoTiltY == static_cast<unsigned>(ServoFeature::kTiltY) &&
              layout::kServoEdgeAngle == static_cast<unsigned>(ServoFeature::kEdgeAngle));

layout::FeatureLoopRecord packLoop(const FeatureLoop& loop) {
  return {.gains = {loop.kp, loop.ki},
          .error = {loop.reference.value_or(0), loop.error_limit},
          .integral = {loop.integral_limit, loop.rolling_radius},
          .change = {loop.kd, loop.derivative_limit}};
}

layout::ServoRecord packServo(const TactileServo& servo) {
  layout::ServoRecord record{};
  for (unsigned f = 0; f < kNumServoFeatures; ++f) {
    const FeatureLoop& loop = servo.loops[f];
    record.loops[f] = packLoop(loop);
    if (loop.selected) record.flags.x |= 1u << f;
    if (loop.reference) record.flags.y |= 1u << f;
  }
  record.exploration = {std::cos(servo.exploration_direction), std::sin(servo.exploration_direction)};
  record.limits = {servo.max_linear_velocity, servo.max_angular_velocity};
  record.confidence = {servo.min_confidence, 0.0};
  if (servo.edge_angle_source == EdgeAngleSource::kWindow) record.flags.z |= layout::kServoFlagWindow;
  if (servo.edge_angle_source == EdgeAngleSource::kRidge) record.flags.z |= layout::kServoFlagRidge;
  if (servo.contact == ServoContact::kLargestRegion) record.flags.z |= layout::kServoFlagRegion;
  return record;
}

layout::LoopRecord packLoops(const ServoLoopPlan& plan, const Sensor& sensor, const NearSlots& near) {
  double taxel_area = std::numeric_limits<double>::infinity();
  for (const GridPatch& patch : sensor.patches) taxel_area = std::min(taxel_area, patch.pitch[0] * patch.pitch[1]);
  const Vector3 center = arrayMiddle(sensor);
  return {.time = {plan.dt, plan.control_period * plan.dt},
          .skin = {foundationOf(sensor.skin).normal_contact_stiffness, taxel_area},
          .array_center = {center[0], center[1]},
          .base = near.skinBase()};
}

static_assert(layout::kLoopJoints == kMaxJoints && layout::kLoopChainJoints == kMaxChainJoints);

void packPose(const Pose& X, glm::dvec2 (&values)[4]) {
  const auto& [p, q] = X;
  values[0] = {p[0], p[1]};
  values[1] = {p[2], q[0]};
  values[2] = {q[1], q[2]};
  values[3] = {q[3], 0.0};
}

layout::JointRecord packJoint(const LoopRobot& start, std::size_t j) {
  const Joint& joint = start.robot.joints[j];
  const double step = start.robot.drive.position_step;
  const double* const jacobian = &start.jacobian[6 * j];
  return {.limits = {joint.lower, joint.upper},
          .steps = {std::ceil(joint.lower / step), std::floor(joint.upper / step)},
          .velocity = {joint.max_velocity, 0},
          .start = {start.positions[j], start.commands[j]},
          .jacobian = {{jacobian[0], jacobian[1]}, {jacobian[2], jacobian[3]}, {jacobian[4], jacobian[5]}}};
}

layout::RobotRecord packRobot(const LoopRobot& start) {
  const Manipulator& robot = start.robot;
  const MountedSensor& sensor = robot.sensors.front();
  layout::RobotRecord record{};
  for (std::size_t j = 0; j < robot.joints.size(); ++j) record.joints[j] = packJoint(start, j);
  for (std::size_t k = 0; k < sensor.chain.size(); ++k) {
    const ChainJoint& joint = sensor.chain[k];
    packPose(joint.X_PJ, record.chain[k].X_PJ);
    record.chain[k].position = {joint.multiplier, joint.offset};
    record.chain[k].keys = {static_cast<std::uint32_t>(joint.joint), joint.type == JointType::kPrismatic ? 1u : 0u, 0u, 0u};
  }
  packPose(sensor.X_JS, record.X_JS);
  packPose(start.X_WB, record.X_WB);
  packPose(start.X_WS, record.X_WS);
  record.singular = {robot.singular_threshold * robot.singular_threshold, robot.max_damping * robot.max_damping};
  record.drive = {robot.drive.position_step, 0.0};
  unsigned num_rows = 0;
  for (unsigned row = 0; row < robot.selection.size(); ++row) {
    if (!robot.selection[row]) continue;
    record.rows[num_rows / 4][num_rows % 4] = row;
    ++num_rows;
  }
  return record;
}

static_assert(sizeof(Pose) == 7 * sizeof(double) && sizeof(Twist) == 6 * sizeof(double), "laid out like the arrays of the device");

template <typename Block, typename T>
std::span<const T> rowsOf(const Simulator::Impl& simulator, bool is_output, int width = 1) {
  if (!is_output || width == 0) return {};
  const auto* const first = reinterpret_cast<const T*>(simulator.buffers.output<Block>().data());
  return {first, static_cast<std::size_t>(simulator.options.num_instances) * static_cast<std::size_t>(width)};
}

}  // namespace

bool ServoLoop::isSupported(const Model& model) {
  return implOf(model).data.profile.canRunServos();
}

bool ServoLoop::isFaster(const Model& model) {
  return implOf(model).data.profile.prefersServosOnDevice();
}

MemoryPlan ServoLoop::planMemory(const Model& model, const SimulatorOptions& options, const ServoLoopPlan& plan) {
  return planBatch(implOf(model).data, {options, plan});
}

ServoLoop::ServoLoop(Simulator& simulator)
    : simulator_(SimulatorAccess::impl(simulator)),
      num_instances_(simulator.numInstances()),
      status_(simulator_.options.loop->outputs.robot_status ? static_cast<std::size_t>(num_instances_) : 0) {
  const ServoLoopPlan& plan = *simulator_.options.loop;
  const std::span<layout::ServoRecord> records = simulator_.buffers.input<block::Servos>();
  std::transform(plan.servos.begin(), plan.servos.end(), records.begin(), packServo);
  simulator_.buffers.input<block::Loop>()[0] = packLoops(plan, simulator.model().sensor(), simulator_.near);
  simulator_.traffic.bytes_to_device += records.size_bytes() + sizeof(layout::LoopRecord);
  if (!plan.robot) return;
  simulator_.buffers.input<block::Robot>()[0] = packRobot(*plan.robot);
  simulator_.traffic.bytes_to_device += sizeof(layout::RobotRecord);
}

void ServoLoop::start(int instance, const LoopStart& start) {
  const auto& [p, q] = start.X_WO;
  layout::LoopStartRecord record{};
  record.X_WO[0] = {p[0], p[1]};
  record.X_WO[1] = {p[2], q[0]};
  record.X_WO[2] = {q[1], q[2]};
  record.X_WO[3] = {q[3], start.exploration_velocity};
  record.start_force.x = start.start_force;
  record.keys = {1u, static_cast<std::uint32_t>(start.servo), static_cast<std::uint32_t>(start.object), 0u};
  simulator_.buffers.input<block::LoopStarts>()[static_cast<std::size_t>(instance)] = record;
  simulator_.traffic.bytes_to_device += sizeof(record);
}

void ServoLoop::stop(int instance) {
  simulator_.buffers.input<block::LoopStarts>()[static_cast<std::size_t>(instance)].keys.x = 0;
  simulator_.traffic.bytes_to_device += sizeof(std::uint32_t);
}

std::span<const Pose> ServoLoop::X_SO() const {
  return rowsOf<block::ObjectPoses, Pose>(simulator_, simulator_.options.loop->outputs.object_poses);
}

std::span<const Pose> ServoLoop::X_WS() const {
  return rowsOf<block::SensorPoses, Pose>(simulator_, simulator_.options.loop->outputs.sensor_poses);
}

std::span<const Twist> ServoLoop::actions() const {
  return rowsOf<block::Actions, Twist>(simulator_, simulator_.options.loop->outputs.actions);
}

std::span<const double> ServoLoop::jointPositions() const {
  const ServoLoopPlan& plan = *simulator_.options.loop;
  return rowsOf<block::JointPositions, double>(simulator_, plan.outputs.joints, plan.numJoints());
}

std::span<const double> ServoLoop::jointVelocities() const {
  const ServoLoopPlan& plan = *simulator_.options.loop;
  return rowsOf<block::JointVelocities, double>(simulator_, plan.outputs.joints, plan.numJoints());
}

void ServoLoop::read() {
  if (status_.empty()) return;
  const std::span<const std::uint32_t> words = simulator_.buffers.output<block::RobotStatuses>().first(status_.size());
  std::transform(words.begin(), words.end(), status_.begin(), [](std::uint32_t word) { return static_cast<std::uint8_t>(word); });
}

}  // namespace taxelsim
