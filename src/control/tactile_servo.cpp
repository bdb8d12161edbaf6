#include "control/tactile_servo.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "control/values.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

// Speed without contact, as a part of max_linear_velocity: slow enough that one control period does not cross the skin.
constexpr double kApproachFraction = 0.1;

// Smallest mean pressure at which a curved law (exponent > 1) is linearised, as the depth it stands for: at no depth it has no stiffness.
constexpr double kLinearisationDepth = 1e-4;  // m

constexpr const char* kFeatureNames[kNumServoFeatures] = {"center_x", "center_y", "center_across", "total_force", "edge_angle"};

constexpr std::size_t at(ServoFeature feature) {
  return static_cast<std::size_t>(feature);
}

double clipped(double value, double limit) {
  return std::clamp(value, -limit, limit);
}

double speedOf(const Twist& twist) {
  return std::sqrt(twist.v[0] * twist.v[0] + twist.v[1] * twist.v[1] + twist.v[2] * twist.v[2]);
}

// The representative in (-pi/2, pi/2] of an angle between lines.
double wrapLineAngle(double angle) {
  const double wrapped = std::remainder(angle, std::numbers::pi);
  return wrapped <= -std::numbers::pi / 2 ? wrapped + std::numbers::pi : wrapped;
}

void checkLoop(const FeatureLoop& loop, const char* feature) {
  const std::string where = std::string("controller: ") + feature;
  const char* what = where.c_str();
  if (loop.reference) requireValue(std::isfinite(*loop.reference), what, "reference", *loop.reference, "a finite number");
  requireValue(isAtLeastZero(loop.kp), what, "kp", loop.kp, "a number >= 0");
  requireValue(isAtLeastZero(loop.ki), what, "ki", loop.ki, "a number >= 0");
  requireValue(loop.kd >= 0 && loop.kd < 1, what, "kd", loop.kd, "a number >= 0 and < 1");
  requireValue(loop.error_limit > 0, what, "error_limit", loop.error_limit, "a number > 0");
  requireValue(loop.integral_limit > 0, what, "integral_limit", loop.integral_limit, "a number > 0");
  requireValue(loop.derivative_limit > 0, what, "derivative_limit", loop.derivative_limit, "a number > 0");
}

void checkServo(const TactileServo& servo) {
  bool any = false;
  for (std::size_t f = 0; f < servo.loops.size(); ++f) {
    if (servo.loops[f].selected) checkLoop(servo.loops[f], kFeatureNames[f]);
    any = any || servo.loops[f].selected;
  }
  if (!any) throw Error(ErrorKind::kInput, "controller: no feature is selected");
  if (servo[ServoFeature::kCenterAcross].selected && (servo[ServoFeature::kCenterX].selected || servo[ServoFeature::kCenterY].selected)) {
    throw Error(ErrorKind::kInput, "controller: center_across is selected beside center_x or center_y, which hold the same contact");
  }
  requireValue(std::isfinite(servo.exploration_velocity), "controller", "exploration_velocity", servo.exploration_velocity,
               "a finite velocity");
  requireValue(isPositive(servo.max_angular_velocity), "controller", "max_angular_velocity", servo.max_angular_velocity, "a number > 0");
  requireValue(isPositive(servo.max_linear_velocity), "controller", "max_linear_velocity", servo.max_linear_velocity, "a number > 0");
  requireValue(servo.min_confidence >= 0 && servo.min_confidence <= 1, "controller", "min_confidence", servo.min_confidence, "0 to 1");
}

}  // namespace

TactileServo edgeServo() {
  TactileServo servo;
  servo[ServoFeature::kEdgeAngle] = {.selected = true, .kp = 0.8};
  servo[ServoFeature::kTotalForce] = {.selected = true, .kp = 2};
  servo[ServoFeature::kCenterAcross] = {.selected = true, .kp = 1};
  return servo;
}

TactileServoController::TactileServoController(const TactileServo& servo, const Sensor& sensor, int num_instances) : servo_(servo) {
  checkServo(servo);
  memory_.resize(static_cast<std::size_t>(num_instances));
  for (int i = 0; i < num_instances; ++i) reset(i);

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

void TactileServoController::reset(int instance) {
  Memory& memory = memory_[static_cast<std::size_t>(instance)];
  memory.integral.fill(0);
  memory.error.fill(kUnknown);
}

double TactileServoController::contactStiffness(double force, double area) const {
  area = std::max(area, taxel_area_);
  if (exponent_ == 1) return stiffness_ * area;
  const double pressure = std::max(force / area, stiffness_ * std::pow(kLinearisationDepth, exponent_));
  const double depth = std::pow(pressure / stiffness_, 1 / exponent_);
  return exponent_ * pressure * area / depth;
}

double TactileServoController::forceReference(const Felt& felt) const {
  return servo_[ServoFeature::kTotalForce].reference.value_or(felt.start_force);
}

// The edge's direction. A line has two; the one nearer the reference is kept, so that nothing turns back where the angle wraps.
double TactileServoController::directionOf(const Felt& felt) const {
  const double reference = servo_[ServoFeature::kEdgeAngle].reference.value_or(0);
  return reference + wrapLineAngle(felt.angle - reference);
}

// Reference - value of each feature; NaN where it is not selected or not known.
TactileServoController::Features TactileServoController::errorsOf(const Felt& felt) const {
  Features error;
  error.fill(kUnknown);
  const auto set = [&](ServoFeature feature, double otherwise, double value) {
    if (isSelected(feature)) error[at(feature)] = servo_[feature].reference.value_or(otherwise) - value;
  };
  set(ServoFeature::kCenterX, middle_[0], felt.center[0]);
  set(ServoFeature::kCenterY, middle_[1], felt.center[1]);
  set(ServoFeature::kTotalForce, felt.start_force, felt.force);
  if (felt.confidence < servo_.min_confidence) return error;
  const double along = directionOf(felt), n[2] = {-std::sin(along), std::cos(along)};
  set(ServoFeature::kCenterAcross, 0, (felt.center[0] - middle_[0]) * n[0] + (felt.center[1] - middle_[1]) * n[1]);
  set(ServoFeature::kEdgeAngle, 0, felt.angle);
  error[at(ServoFeature::kEdgeAngle)] = wrapLineAngle(error[at(ServoFeature::kEdgeAngle)]);
  return error;
}

// How fast each feature shall move; 0 where its error is not known.
TactileServoController::Features TactileServoController::ratesOf(const Features& error, double dt, const Memory& before,
                                                                 Memory& after) const {
  Features rate{};
  after = {before.integral, error};
  for (std::size_t f = 0; f < error.size(); ++f) {
    if (std::isnan(error[f])) continue;
    const FeatureLoop& loop = servo_.loops[f];
    const double bounded = clipped(error[f], loop.error_limit);
    after.integral[f] = clipped(before.integral[f] + bounded * dt, loop.integral_limit);
    const double derivative = std::isnan(before.error[f]) ? 0 : clipped((error[f] - before.error[f]) / dt, loop.derivative_limit);
    rate[f] = loop.kp * bounded + loop.ki * after.integral[f] + loop.kd * derivative;
  }
  return rate;
}

// The inverse of the nominal tactile Jacobian: see tactile_servo.h.
Twist TactileServoController::twistOf(const Felt& felt, const Features& rate) const {
  Twist twist;
  const double w = -rate[at(ServoFeature::kEdgeAngle)];
  twist.w[2] = w;
  twist.v[0] = w * felt.center[1] - rate[at(ServoFeature::kCenterX)];
  twist.v[1] = -w * felt.center[0] - rate[at(ServoFeature::kCenterY)];
  if (felt.confidence >= servo_.min_confidence) {
    const double along = directionOf(felt), u[2] = {std::cos(along), std::sin(along)};
    const double across = rate[at(ServoFeature::kCenterAcross)];
    twist.v[0] += across * u[1] + servo_.exploration_velocity * u[0];
    twist.v[1] += -across * u[0] + servo_.exploration_velocity * u[1];
  } else if (isSelected(ServoFeature::kCenterAcross)) {
    // No edge to go along: every direction is across it.
    const double kp = servo_[ServoFeature::kCenterAcross].kp;
    twist.v[0] += kp * (felt.center[0] - middle_[0]);
    twist.v[1] += kp * (felt.center[1] - middle_[1]);
  }
  twist.v[2] = rate[at(ServoFeature::kTotalForce)] / contactStiffness(felt.force, felt.area);
  return twist;
}

Twist TactileServoController::commandOne(const Felt& felt, double dt, Memory& memory) const {
  if (felt.force <= 0 || felt.area <= 0) {
    memory.error.fill(kUnknown);
    Twist twist;
    if (isSelected(ServoFeature::kTotalForce) && forceReference(felt) > 0) {
      twist.v[2] = kApproachFraction * servo_.max_linear_velocity;
    }
    return twist;
  }
  const Features error = errorsOf(felt);
  Memory after;
  const Features rate = ratesOf(error, dt, memory, after);
  Twist twist = twistOf(felt, rate);

  // An integral that would press further against a limit waits.
  const bool too_fast = speedOf(twist) > servo_.max_linear_velocity, turns_too_fast = std::abs(twist.w[2]) > servo_.max_angular_velocity;
  for (std::size_t f = 0; f < error.size(); ++f) {
    const bool saturated = f == at(ServoFeature::kEdgeAngle) ? turns_too_fast : too_fast;
    if (saturated && rate[f] * error[f] > 0) after.integral[f] = memory.integral[f];
  }
  memory = after;

  if (turns_too_fast) {
    // About the same contact, more slowly.
    const double w = clipped(twist.w[2], servo_.max_angular_velocity);
    twist.v[0] += (w - twist.w[2]) * felt.center[1];
    twist.v[1] -= (w - twist.w[2]) * felt.center[0];
    twist.w[2] = w;
  }
  const double speed = speedOf(twist);
  if (speed > servo_.max_linear_velocity) {
    for (double& component : twist.v) component *= servo_.max_linear_velocity / speed;
  }
  return twist;
}

void TactileServoController::command(const ServoInput& input, double dt, std::span<Twist> twists) {
  const std::size_t num_instances = twists.size();
  assert(num_instances == memory_.size());
  assert(input.edge_angle.size() == num_instances && input.edge_confidence.size() == num_instances);
  assert(input.total_force.size() == num_instances && input.center_of_pressure.size() == 3 * num_instances);
  assert(input.contact_area.size() == num_instances && input.start_force.size() == num_instances);
  assert(input.due.size() == num_instances);
  for (std::size_t i = 0; i < num_instances; ++i) {
    if (!input.due[i]) continue;
    const Felt felt{.angle = input.edge_angle[i],
                    .confidence = input.edge_confidence[i],
                    .force = input.total_force[i],
                    .area = input.contact_area[i],
                    .center = {input.center_of_pressure[3 * i], input.center_of_pressure[3 * i + 1]},
                    .start_force = input.start_force[i]};
    const double sum = felt.angle + felt.confidence + felt.force + felt.area + felt.center[0] + felt.center[1] + felt.start_force;
    twists[i] = std::isfinite(sum) ? commandOne(felt, dt, memory_[i]) : Twist{};
  }
}

}  // namespace taxelsim
