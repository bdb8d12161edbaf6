#include "control/robots.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <string>

#include "base/field_checks.h"
#include "control/twist.h"

namespace taxelsim {
namespace {

bool isFinite(const Twist& twist) {
  const auto finite = [](double x) { return std::isfinite(x); };
  return std::all_of(twist.v.begin(), twist.v.end(), finite) && std::all_of(twist.w.begin(), twist.w.end(), finite);
}

// The twist of a sensor by its transposed Jacobian (num_joints x 6).
Twist twistBy(const double* jacobian, std::span<const double> joint_velocities) {
  Twist twist;
  for (std::size_t j = 0; j < joint_velocities.size(); ++j) {
    for (std::size_t k = 0; k < 3; ++k) {
      twist.v[k] += jacobian[6 * j + k] * joint_velocities[j];
      twist.w[k] += jacobian[6 * j + 3 + k] * joint_velocities[j];
    }
  }
  return twist;
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
    setAtRest(i, initial_, X_WB_initial_);
  }
}

void Robots::reset(int i, const Pose& X_WS) {
  if (chains_.empty()) {
    X_WS_[i] = X_WS;
    status_[i] = 0;
  } else {
    std::array<double, kMaxJoints> positions;
    for (int j = 0; j < num_joints_; ++j) positions[j] = quantized(j, initial_[j]);
    setAtRest(i, initial_, X_WS * inverse(chains_[0].poseAt(positions.data())));
  }
}

void Robots::reset(int i, std::span<const double> positions) {
  assert(static_cast<int>(positions.size()) == num_joints_);
  for (int j = 0; j < num_joints_; ++j) {
    const Allowed allowed = Allowed::within(limits_[j].lower, limits_[j].upper, "");
    if (!isAllowed(positions[j], allowed)) {
      failField(elementOf("joint position", static_cast<std::size_t>(j)), numberText(positions[j]), describe(allowed));
    }
  }
  setAtRest(i, positions, X_WB_initial_);
}

void Robots::setAtRest(int i, std::span<const double> positions, const Pose& X_WB) {
  X_WB_[i] = X_WB;
  status_[i] = 0;
  std::copy(positions.begin(), positions.end(), instanceRow(commands_, i));
  std::fill_n(instanceRow(velocities_, i), num_joints_, 0.0);
  double* const joints = instanceRow(positions_, i);
  for (int j = 0; j < num_joints_; ++j) joints[j] = quantized(j, positions[j]);
  for (int k = 0; k < joint_drive_.delay; ++k) std::copy_n(joints, num_joints_, instanceRow(delayed_, k * num_instances_ + i));
  updateSensors(i);
}

void Robots::command(std::span<const Twist> twists, std::span<const double> joint_velocities, std::span<const std::uint8_t> by_joints,
                     double dt, ThreadTeam& team) {
  assert(static_cast<int>(twists.size()) == num_instances_ && dt > 0);
  if (chains_.empty()) {
    return team.run(num_instances_, [&](int first, int last) {
      for (int i = first; i < last; ++i) stepFreeFlying(i, twists[i], dt);
    });
  }
  team.run(num_instances_, [&](int first, int last) {
    for (int i = first; i < last; ++i) {
      if (!by_joints.empty() && by_joints[i]) {
        stepJoints(i, joint_velocities.subspan(static_cast<std::size_t>(i) * num_joints_, num_joints_), dt);
      } else {
        stepManipulator(i, twists[i], dt);
      }
    }
  });
  if (joint_drive_.delay > 0) delay_index_ = (delay_index_ + 1) % joint_drive_.delay;
}

void Robots::stepFreeFlying(int i, const Twist& twist, double dt) {
  status_[i] = kLost;
  if (!isFinite(twist)) return;
  const Pose X_WS = integrate(X_WS_[i], twist, dt);
  if (!isFinite(X_WS)) return;
  X_WS_[i] = X_WS;
  status_[i] = 0;
}

// Steps 1 to 3 of robots.h: velocities (num_joints) of the free joints that respect all limits; 0 for the others. Returns flags of
// RobotStatus.
std::uint8_t Robots::solveVelocities(int i, const double* jacobian, std::array<bool, kMaxJoints> is_free, const Twist& twist, double dt,
                                     double* velocities) const {
  const auto lost = [&] {
    std::fill_n(velocities, num_joints_, 0.0);
    return static_cast<std::uint8_t>(kLost);
  };
  if (!isFinite(twist)) return lost();
  const double* const commands = instanceRow(commands_, i);
  std::array<double, 6> target{twist.v[0], twist.v[1], twist.v[2], twist.w[0], twist.w[1], twist.w[2]};
  std::array<double, kMaxJoints> limited{};  // velocities of joints that are not free: they reach their limit in this tick
  std::uint8_t status = 0;
  for (;;) {
    std::array<double, 6> rest = target;
    for (int j = 0; j < num_joints_; ++j) {
      for (int k = 0; k < 6; ++k) rest[k] -= jacobian[6 * j + k] * limited[j];
    }
    if (solver_[0].solve(jacobian, rest, is_free.data(), velocities)) status |= kSingular;

    double factor = 1;
    for (int j = 0; j < num_joints_; ++j) {
      velocities[j] += limited[j];
      if (!std::isfinite(velocities[j])) return lost();
      if (std::abs(velocities[j]) > limits_[j].max_velocity) factor = std::min(factor, limits_[j].max_velocity / std::abs(velocities[j]));
    }
    if (factor < 1) {
      status |= kVelocityLimit;
      for (double& component : target) component *= factor;
      for (int j = 0; j < num_joints_; ++j) velocities[j] *= factor, limited[j] *= factor;
    }

    bool any_limited = false;
    for (int j = 0; j < num_joints_; ++j) {
      const double next = commands[j] + velocities[j] * dt;
      if (!is_free[j] || (next >= limits_[j].lower && next <= limits_[j].upper)) continue;
      limited[j] = ((next < limits_[j].lower ? limits_[j].lower : limits_[j].upper) - commands[j]) / dt;
      is_free[j] = false;
      any_limited = true;
    }
    if (!any_limited) return status;
    status |= kJointLimit;
  }
}

std::uint8_t Robots::solve(int i, int sensor, const Twist& twist, std::span<const std::uint8_t> follows, double dt,
                           std::span<double> velocities) const {
  assert(static_cast<int>(follows.size()) == num_joints_ && static_cast<int>(velocities.size()) == num_joints_ && dt > 0);
  std::array<double, std::size_t{6} * kMaxJoints> jacobian;
  chains_[sensor].poseAt(instanceRow(positions_, i), jacobian.data());
  std::array<bool, kMaxJoints> is_free{};
  for (int j = 0; j < num_joints_; ++j) is_free[j] = follows[j] != 0;
  return solveVelocities(i, jacobian.data(), is_free, twist, dt, velocities.data());
}

// The drive's target for a command: the nearest multiple of position_step within the limits.
double Robots::quantized(int joint, double command) const {
  const double step = joint_drive_.position_step;
  if (step == 0) return command;
  return std::clamp(std::round(command / step), std::ceil(limits_[joint].lower / step), std::floor(limits_[joint].upper / step)) * step;
}

void Robots::stepManipulator(int i, const Twist& twist, double dt) {
  std::array<double, kMaxJoints> solution{};
  std::array<bool, kMaxJoints> all;
  all.fill(true);
  status_[i] = solveVelocities(i, instanceJacobian(i), all, twist, dt, solution.data());
  drive(i, solution.data(), dt);
}

// Steps 2 and 3 of robots.h for commanded velocities (num_joints). Returns false if one is not finite.
bool Robots::limitVelocities(int i, double dt, double* velocities) {
  double factor = 1;
  for (int j = 0; j < num_joints_; ++j) {
    if (!std::isfinite(velocities[j])) return false;
    if (std::abs(velocities[j]) > limits_[j].max_velocity) factor = std::min(factor, limits_[j].max_velocity / std::abs(velocities[j]));
  }
  if (factor < 1) status_[i] |= kVelocityLimit;
  const double* const commands = instanceRow(commands_, i);
  for (int j = 0; j < num_joints_; ++j) {
    velocities[j] *= factor;
    const double next = commands[j] + velocities[j] * dt;
    const double allowed = std::clamp(next, limits_[j].lower, limits_[j].upper);
    if (next == allowed) continue;
    velocities[j] = (allowed - commands[j]) / dt;
    status_[i] |= kJointLimit;
  }
  return true;
}

void Robots::stepJoints(int i, std::span<const double> joint_velocities, double dt) {
  status_[i] = 0;
  std::array<double, kMaxJoints> velocities{};
  std::copy(joint_velocities.begin(), joint_velocities.end(), velocities.begin());
  if (!limitVelocities(i, dt, velocities.data())) {
    status_[i] = kLost;
    velocities.fill(0);
  }
  drive(i, velocities.data(), dt);
}

Twist Robots::twistOf(int i, std::span<const double> joint_velocities) const {
  return twistBy(jacobians_.data() + static_cast<std::ptrdiff_t>(i) * num_joints_ * 6, joint_velocities);
}

Twist Robots::twistOf(int i, int sensor, std::span<const double> joint_velocities) const {
  std::array<double, std::size_t{6} * kMaxJoints> jacobian;
  chains_[sensor].poseAt(instanceRow(positions_, i), jacobian.data());
  return twistBy(jacobian.data(), joint_velocities);
}

// Step 4 of robots.h: commands and drives at joint velocities (num_joints).
void Robots::drive(int i, const double* joint_velocities, double dt) {
  double* const commands = instanceRow(commands_, i);
  double* const positions = instanceRow(positions_, i);
  double* const velocities = instanceRow(velocities_, i);
  for (int j = 0; j < num_joints_; ++j) {
    const Limits& limits = limits_[j];
    commands[j] = std::clamp(commands[j] + joint_velocities[j] * dt, limits.lower, limits.upper);
    double target = quantized(j, commands[j]);
    if (joint_drive_.delay > 0) std::swap(target, instanceRow(delayed_, delay_index_ * num_instances_ + i)[j]);
    const double before = positions[j];
    const double max_change = limits.max_velocity * dt;
    if (std::abs(target - before) <= max_change) {
      positions[j] = target;
    } else {
      positions[j] = before + std::copysign(max_change, target - before);
      status_[i] |= kVelocityLimit;
    }
    velocities[j] = (positions[j] - before) / dt;
  }
  updateSensors(i);
}

void Robots::updateSensors(int i) {
  const double* const q = instanceRow(positions_, i);
  Pose* const X_WS = X_WS_.data() + static_cast<std::ptrdiff_t>(i) * num_sensors_;
  X_WS[0] = X_WB_[i] * chains_[0].poseAt(q, instanceJacobian(i));
  for (int sensor = 1; sensor < num_sensors_; ++sensor) X_WS[sensor] = X_WB_[i] * chains_[sensor].poseAt(q);
}

}  // namespace taxelsim
