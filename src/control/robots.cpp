#include "control/robots.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <string>

#include "control/twist.h"
#include "control/values.h"

namespace taxelsim {
namespace {

bool isFinite(const Twist& twist) {
  const auto finite = [](double x) { return std::isfinite(x); };
  return std::all_of(twist.v.begin(), twist.v.end(), finite) && std::all_of(twist.w.begin(), twist.w.end(), finite);
}

bool isFinite(const Pose& X) {
  const auto finite = [](double x) { return std::isfinite(x); };
  return std::all_of(X.position.begin(), X.position.end(), finite) && std::all_of(X.rotation.begin(), X.rotation.end(), finite);
}

}  // namespace

Robots::Robots(const Robot& robot, int num_instances)
    : num_instances_(num_instances), X_WB_(num_instances), X_WS_(num_instances), status_(num_instances, 0) {
  checkRobot(robot);
  if (const auto* manipulator = std::get_if<Manipulator>(&robot)) {
    num_joints_ = static_cast<int>(manipulator->joints.size());
    num_sensors_ = static_cast<int>(manipulator->sensors.size());
    for (const MountedSensor& sensor : manipulator->sensors) chains_.emplace_back(sensor, num_joints_);
    solver_.emplace_back(*manipulator);
    for (const Joint& joint : manipulator->joints) {
      limits_.push_back({joint.lower, joint.upper, joint.max_velocity});
      initial_.push_back(joint.initial_position);
    }
    joint_drive_ = manipulator->drive;
    X_WB_initial_ = manipulator->X_WB;
    const std::size_t num_values = static_cast<std::size_t>(num_instances) * num_joints_;
    X_WS_.resize(static_cast<std::size_t>(num_instances) * num_sensors_);
    positions_.resize(num_values);
    velocities_.resize(num_values);
    commands_.resize(num_values);
    delayed_.resize(num_values * joint_drive_.delay);
    jacobians_.resize(num_values * 6);
  }
  for (int i = 0; i < num_instances; ++i) reset(i);
}

void Robots::reset(int i) {
  if (chains_.empty()) {
    reset(i, Pose{});
  } else {
    stand(i, initial_, X_WB_initial_);
  }
}

void Robots::reset(int i, const Pose& X_WS) {
  if (chains_.empty()) {
    X_WS_[i] = X_WS;
    status_[i] = 0;
  } else {
    std::array<double, kMaxJoints> positions;
    for (int j = 0; j < num_joints_; ++j) positions[j] = goalOf(j, initial_[j]);
    stand(i, initial_, X_WS * inverse(chains_[0].poseAt(positions.data())));
  }
}

void Robots::reset(int i, std::span<const double> positions) {
  assert(static_cast<int>(positions.size()) == num_joints_);
  for (int j = 0; j < num_joints_; ++j) {
    const bool is_within = positions[j] >= limits_[j].lower && positions[j] <= limits_[j].upper && std::isfinite(positions[j]);
    requireValue(is_within, "robot", "joint position", positions[j], "within the joint's limits");
  }
  stand(i, positions, X_WB_initial_);
}

void Robots::stand(int i, std::span<const double> positions, const Pose& X_WB) {
  X_WB_[i] = X_WB;
  status_[i] = 0;
  std::copy(positions.begin(), positions.end(), jointsOf(commands_, i));
  std::fill_n(jointsOf(velocities_, i), num_joints_, 0.0);
  double* const at = jointsOf(positions_, i);
  for (int j = 0; j < num_joints_; ++j) at[j] = goalOf(j, positions[j]);
  for (int slot = 0; slot < joint_drive_.delay; ++slot) std::copy_n(at, num_joints_, jointsOf(delayed_, slot * num_instances_ + i));
  placeSensors(i);
}

void Robots::command(std::span<const Twist> twists, double dt) {
  assert(static_cast<int>(twists.size()) == num_instances_ && dt > 0);
  for (int i = 0; i < num_instances_; ++i) {
    if (chains_.empty()) {
      fly(i, twists[i], dt);
    } else {
      drive(i, twists[i], dt);
    }
  }
  if (joint_drive_.delay > 0) tick_ = (tick_ + 1) % joint_drive_.delay;
}

void Robots::fly(int i, const Twist& twist, double dt) {
  const Pose X_WS = isFinite(twist) ? integrate(X_WS_[i], twist, dt) : X_WS_[i];
  status_[i] = isFinite(twist) && isFinite(X_WS) ? 0 : kLost;
  if (status_[i] == 0) X_WS_[i] = X_WS;
}

// The velocities (num_joints) with which the joints' commands follow the twist. False when there are no finite ones.
bool Robots::follow(int i, const Twist& twist, double dt, double* velocities) {
  const double* const jacobian = jacobianOf(i);
  const double* const commands = jointsOf(commands_, i);
  std::array<double, 6> wanted{twist.v[0], twist.v[1], twist.v[2], twist.w[0], twist.w[1], twist.w[2]};
  std::array<bool, kMaxJoints> free;
  std::array<double, kMaxJoints> stopping{};  // velocities of joints that go to a limit, and stay there
  free.fill(true);
  for (;;) {
    std::array<double, 6> rest = wanted;
    for (int j = 0; j < num_joints_; ++j) {
      for (int k = 0; k < 6; ++k) rest[k] -= jacobian[6 * j + k] * stopping[j];
    }
    if (solver_[0].solve(jacobian, rest, free.data(), velocities)) status_[i] |= kSingular;

    double part = 1;
    for (int j = 0; j < num_joints_; ++j) {
      velocities[j] += stopping[j];
      if (!std::isfinite(velocities[j])) return false;
      if (std::abs(velocities[j]) > limits_[j].max_velocity) part = std::min(part, limits_[j].max_velocity / std::abs(velocities[j]));
    }
    if (part < 1) {
      status_[i] |= kVelocityLimit;
      for (double& component : wanted) component *= part;
      for (int j = 0; j < num_joints_; ++j) velocities[j] *= part, stopping[j] *= part;
    }

    bool any_stops = false;
    for (int j = 0; j < num_joints_; ++j) {
      const double next = commands[j] + velocities[j] * dt;
      if (!free[j] || (next >= limits_[j].lower && next <= limits_[j].upper)) continue;
      stopping[j] = ((next < limits_[j].lower ? limits_[j].lower : limits_[j].upper) - commands[j]) / dt;
      free[j] = false;
      any_stops = true;
    }
    if (!any_stops) return true;
    status_[i] |= kJointLimit;
  }
}

// Where the drive sends a joint.
double Robots::goalOf(int joint, double command) const {
  const double step = joint_drive_.position_step;
  if (step == 0) return command;
  return std::clamp(std::round(command / step), std::ceil(limits_[joint].lower / step), std::floor(limits_[joint].upper / step)) * step;
}

void Robots::drive(int i, const Twist& twist, double dt) {
  status_[i] = 0;
  std::array<double, kMaxJoints> wanted{};
  if (!isFinite(twist) || !follow(i, twist, dt, wanted.data())) {
    status_[i] = kLost;
    wanted.fill(0);
  }
  double* const commands = jointsOf(commands_, i);
  double* const positions = jointsOf(positions_, i);
  double* const velocities = jointsOf(velocities_, i);
  for (int j = 0; j < num_joints_; ++j) {
    const Limits& limits = limits_[j];
    commands[j] = std::clamp(commands[j] + wanted[j] * dt, limits.lower, limits.upper);
    double goal = goalOf(j, commands[j]);
    if (joint_drive_.delay > 0) std::swap(goal, jointsOf(delayed_, tick_ * num_instances_ + i)[j]);
    const double before = positions[j];
    const double reach = limits.max_velocity * dt;
    if (std::abs(goal - before) <= reach) {
      positions[j] = goal;
    } else {
      positions[j] = before + std::copysign(reach, goal - before);
      status_[i] |= kVelocityLimit;
    }
    velocities[j] = (positions[j] - before) / dt;
  }
  placeSensors(i);
}

void Robots::placeSensors(int i) {
  const double* const q = jointsOf(positions_, i);
  Pose* const X_WS = X_WS_.data() + static_cast<std::ptrdiff_t>(i) * num_sensors_;
  X_WS[0] = X_WB_[i] * chains_[0].poseAt(q, jacobianOf(i));
  for (int sensor = 1; sensor < num_sensors_; ++sensor) X_WS[sensor] = X_WB_[i] * chains_[sensor].poseAt(q);
}

}  // namespace taxelsim
