#include "control/edge_servo.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

#include "control/values.h"

namespace taxelsim {
namespace {

// Speed without contact, as a part of max_linear_velocity: slow enough that one control period does not cross the skin.
constexpr double kApproachFraction = 0.1;

// Smallest mean pressure at which a curved law (exponent > 1) is linearised, as the depth it stands for: at no depth it has no stiffness.
constexpr double kLinearisationDepth = 1e-4;  // m

// The representative in (-pi/2, pi/2] of an angle between lines.
double wrapLineAngle(double angle) {
  const double wrapped = std::remainder(angle, std::numbers::pi);
  return wrapped <= -std::numbers::pi / 2 ? wrapped + std::numbers::pi : wrapped;
}

}  // namespace

EdgeServoController::EdgeServoController(const EdgeServo& servo, const Sensor& sensor) : servo_(servo) {
  requireValue(isAtLeastZero(servo.angle_gain), "controller", "angle_gain", servo.angle_gain, "a number >= 0");
  requireValue(isAtLeastZero(servo.force_gain), "controller", "force_gain", servo.force_gain, "a number >= 0");
  requireValue(isAtLeastZero(servo.centre_gain), "controller", "centre_gain", servo.centre_gain, "a number >= 0");
  requireValue(std::isfinite(servo.target_angle), "controller", "target_angle", servo.target_angle, "a finite angle");
  requireValue(std::isfinite(servo.exploration_velocity), "controller", "exploration_velocity", servo.exploration_velocity,
               "a finite velocity");
  requireValue(isPositive(servo.max_angular_velocity), "controller", "max_angular_velocity", servo.max_angular_velocity, "a number > 0");
  requireValue(isPositive(servo.max_linear_velocity), "controller", "max_linear_velocity", servo.max_linear_velocity, "a number > 0");
  requireValue(servo.min_confidence >= 0 && servo.min_confidence <= 1, "controller", "min_confidence", servo.min_confidence, "0 to 1");

  const Winkler foundation = foundationOf(sensor.skin);
  stiffness_ = foundation.normal_contact_stiffness;
  exponent_ = foundation.normal_exponent;

  // Grids lie centred on their patch frames, so the mean over taxels is the mean of the patch origins, weighted by size.
  taxel_area_ = std::numeric_limits<double>::infinity();
  double num_taxels = 0;
  middle_[0] = middle_[1] = 0;
  for (const GridPatch& patch : sensor.patches) {
    const double size = static_cast<double>(patch.num_rows) * patch.num_cols;
    taxel_area_ = std::min(taxel_area_, patch.pitch[0] * patch.pitch[1]);
    middle_[0] += size * patch.X_SP.position[0];
    middle_[1] += size * patch.X_SP.position[1];
    num_taxels += size;
  }
  middle_[0] /= num_taxels;
  middle_[1] /= num_taxels;
}

double EdgeServoController::contactStiffness(double force, double area) const {
  area = std::max(area, taxel_area_);
  if (exponent_ == 1) return stiffness_ * area;
  const double pressure = std::max(force / area, stiffness_ * std::pow(kLinearisationDepth, exponent_));
  const double depth = std::pow(pressure / stiffness_, 1 / exponent_);
  return exponent_ * pressure * area / depth;
}

Twist EdgeServoController::commandOne(double angle, double confidence, double force, const float* center, double area,
                                      double target_force) const {
  Twist twist;
  if (force <= 0 || area <= 0) {
    if (target_force > 0) twist.v[2] = kApproachFraction * servo_.max_linear_velocity;
    return twist;
  }

  const double off[2] = {center[0] - middle_[0], center[1] - middle_[1]};
  if (confidence >= servo_.min_confidence) {
    const double error = wrapLineAngle(angle - servo_.target_angle);
    const double w = std::clamp(servo_.angle_gain * error, -servo_.max_angular_velocity, servo_.max_angular_velocity);
    twist.w[2] = w;
    // A line has two directions; the one nearer the target's is kept, so that exploration does not turn back where `angle` wraps.
    const double u[2] = {std::cos(servo_.target_angle + error), std::sin(servo_.target_angle + error)};
    const double across = servo_.centre_gain * (off[1] * u[0] - off[0] * u[1]);
    twist.v[0] = w * center[1] - across * u[1] + servo_.exploration_velocity * u[0];
    twist.v[1] = -w * center[0] + across * u[0] + servo_.exploration_velocity * u[1];
  } else {
    // No edge to go along: every direction is across it.
    twist.v[0] = servo_.centre_gain * off[0];
    twist.v[1] = servo_.centre_gain * off[1];
  }
  twist.v[2] = servo_.force_gain * (target_force - force) / contactStiffness(force, area);

  const double speed_squared = twist.v[0] * twist.v[0] + twist.v[1] * twist.v[1] + twist.v[2] * twist.v[2];
  if (speed_squared > servo_.max_linear_velocity * servo_.max_linear_velocity) {
    const double scale = servo_.max_linear_velocity / std::sqrt(speed_squared);
    for (double& component : twist.v) component *= scale;
  }
  return twist;
}

void EdgeServoController::command(const EdgeServoInput& input, std::span<Twist> twists) const {
  const std::size_t num_instances = twists.size();
  assert(input.edge_angle.size() == num_instances && input.edge_confidence.size() == num_instances);
  assert(input.total_force.size() == num_instances && input.center_of_pressure.size() == 3 * num_instances);
  assert(input.contact_area.size() == num_instances && input.target_force.size() == num_instances);
  assert(input.due.size() == num_instances);
  for (std::size_t i = 0; i < num_instances; ++i) {
    if (!input.due[i]) continue;
    twists[i] = commandOne(input.edge_angle[i], input.edge_confidence[i], input.total_force[i], &input.center_of_pressure[3 * i],
                           input.contact_area[i], input.target_force[i]);
  }
}

}  // namespace taxelsim
