#include "control/tactile_servo.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "base/constants.h"
#include "base/sin_cos.h"
#include "base/vector3.h"
#include "control/line_angle.h"
#include "control/servo_fields.h"

namespace taxelsim {
namespace {

// Approach speed without contact, as a fraction of max_linear_velocity: the sensor must not cross the skin in one control period.
constexpr double kApproachFraction = 0.1;

// A nonlinear law (exponent > 1) is linearised at the mean pressure, but not below the pressure at this depth, since its stiffness at depth
// 0 is 0.
constexpr double kMinLinearizationDepth = 1e-4;  // m

// Scaling of the measured Jacobian: 1 mm and 0.05 rad (3 degrees) of motion count as 1, and so do the changes of center, force and angle
// that they cause. The damping of 0.01 changes the solution of a well-conditioned Jacobian by about 1e-4 (0.01 squared).
constexpr double kLengthScale = 1e-3;  // m
constexpr double kAngleScale = 0.05;   // rad
constexpr double kDamping = 0.01;

constexpr std::size_t at(ServoFeature feature) {
  return static_cast<std::size_t>(feature);
}

double clipped(double value, double limit) {
  return std::clamp(value, -limit, limit);
}

// Velocity of the sensor's origin in a rotation w about the contact's center c: -w x c.
std::array<double, 3> velocityOfRotationAbout(const double* center, const std::array<double, 3>& w) {
  return {w[2] * center[1], -w[2] * center[0], w[1] * center[0] - w[0] * center[1]};
}

bool isCenter(std::size_t feature) {
  return feature <= at(ServoFeature::kCenterAcross);
}

// True if the feature is controlled by rotation of the sensor, false if by translation.
bool isControlledByRotation(const TactileServo& servo, std::size_t feature) {
  return isCenter(feature) ? servo.loops[feature].rolling_radius > 0 : feature >= at(ServoFeature::kEdgeAngle);
}

double forceReference(const TactileServo& servo, double start_force) {
  return servo[ServoFeature::kTotalForce].reference.value_or(start_force);
}

// Direction of the edge (rad). Of the two directions of a line, the one nearer to the reference, so that exploration does not reverse where
// the angle wraps.
double edgeDirection(const TactileServo& servo, double angle) {
  const double reference = servo[ServoFeature::kEdgeAngle].reference.value_or(0);
  return reference + wrapLineAngle(angle - reference);
}

}  // namespace

TactileServo edgeServo() {
  TactileServo servo;
  servo[ServoFeature::kEdgeAngle] = {.selected = true, .kp = 0.8};
  servo[ServoFeature::kTotalForce] = {.selected = true, .kp = 2};
  servo[ServoFeature::kCenterAcross] = {.selected = true, .kp = 1};
  return servo;
}

bool needsContactFeatures(const TactileServo& servo) {
  const EdgeAngleSource source = servo.edge_angle_source;
  return source == EdgeAngleSource::kWindow || source == EdgeAngleSource::kRidge || servo.contact != ServoContact::kWhole ||
         servo[ServoFeature::kTiltX].selected || servo[ServoFeature::kTiltY].selected;
}

bool needsTactileJacobian(const TactileServo& servo) {
  return servo.jacobian == TactileJacobianSource::kMeasured;
}

TactileServoController::PreparedServo::PreparedServo(const TactileServo& servo)
    : TactileServo(servo), exploration{std::cos(servo.exploration_direction), std::sin(servo.exploration_direction)} {}

TactileServoController::TactileServoController(std::span<const TactileServo> servos, const Sensor& sensor, int num_instances)
    : servos_(servos.begin(), servos.end()) {
  assert(!servos_.empty());
  for (const TactileServo& servo : servos_) checkServo(servo);
  pid_states_.resize(static_cast<std::size_t>(num_instances));
  for (int i = 0; i < num_instances; ++i) reset(i);

  const Winkler foundation = foundationOf(sensor.skin);
  stiffness_ = foundation.normal_contact_stiffness;
  exponent_ = foundation.normal_exponent;

  array_center_ = arrayMiddle(sensor);
  taxel_area_ = std::numeric_limits<double>::infinity();
  for (const GridPatch& patch : sensor.patches) taxel_area_ = std::min(taxel_area_, patch.pitch[0] * patch.pitch[1]);
}

void TactileServoController::reset(int instance, int servo, std::optional<double> exploration_velocity) {
  PidState& pid = pid_states_[static_cast<std::size_t>(instance)];
  pid.integral.fill(0);
  pid.error.fill(kNaN);
  pid.servo = servo;
  pid.exploration_velocity = exploration_velocity.value_or(servos_[static_cast<std::size_t>(servo)].exploration_velocity);
}

double TactileServoController::contactStiffness(double force, double area) const {
  area = std::max(area, taxel_area_);
  if (exponent_ == 1) return stiffness_ * area;
  const double pressure = std::max(force / area, stiffness_ * std::pow(kMinLinearizationDepth, exponent_));
  const double depth = std::pow(pressure / stiffness_, 1 / exponent_);
  return exponent_ * pressure * area / depth;
}

// Reference - value of each feature; NaN if the feature is not selected or not available.
TactileServoController::Features TactileServoController::featureErrors(const TactileServo& servo, const ContactState& contact) const {
  Features error;
  error.fill(kNaN);
  const auto set = [&](ServoFeature feature, double default_reference, double value) {
    if (servo[feature].selected) error[at(feature)] = servo[feature].reference.value_or(default_reference) - value;
  };
  set(ServoFeature::kCenterX, array_center_[0], contact.center[0]);
  set(ServoFeature::kCenterY, array_center_[1], contact.center[1]);
  set(ServoFeature::kTotalForce, contact.start_force, contact.force);
  if (contact.tilt_confidence >= servo.min_confidence) {
    set(ServoFeature::kTiltX, 0, contact.tilt[0]);
    set(ServoFeature::kTiltY, 0, contact.tilt[1]);
  }
  if (contact.confidence < servo.min_confidence) return error;
  set(ServoFeature::kCenterAcross, 0,
      (contact.center[1] - array_center_[1]) * contact.edge[0] - (contact.center[0] - array_center_[0]) * contact.edge[1]);
  set(ServoFeature::kEdgeAngle, 0, contact.angle);
  double& angle_error = error[at(ServoFeature::kEdgeAngle)];
  if (!std::isnan(angle_error)) angle_error = wrapLineAngle(angle_error);
  return error;
}

// The inverse of the nominal tactile Jacobian: see tactile_servo.h.
Twist TactileServoController::nominalTwist(const TactileServo& servo, const ContactState& contact, const Features& rate) const {
  Twist twist;
  twist.w = {-rate[at(ServoFeature::kTiltX)], -rate[at(ServoFeature::kTiltY)], -rate[at(ServoFeature::kEdgeAngle)]};
  std::array<double, 2> translation{};
  for (const std::size_t axis : {0, 1}) {
    const double radius = servo.loops[axis].rolling_radius;  // of center_x, center_y
    if (radius > 0) {
      twist.w[1 - axis] += (axis == 0 ? -rate[axis] : rate[axis]) / radius;
    } else {
      translation[axis] = -rate[axis];
    }
  }
  if (contact.confidence >= servo.min_confidence) {
    const double rate_across = rate[at(ServoFeature::kCenterAcross)];
    translation[0] += rate_across * contact.edge[1];
    translation[1] -= rate_across * contact.edge[0];
  } else if (servo[ServoFeature::kCenterAcross].selected) {
    // Without a known edge, both directions are controlled.
    const double kp = servo[ServoFeature::kCenterAcross].kp;
    translation[0] += kp * (contact.center[0] - array_center_[0]);
    translation[1] += kp * (contact.center[1] - array_center_[1]);
  }
  const std::array<double, 3> rotation_velocity = velocityOfRotationAbout(contact.center, twist.w);
  twist.v = {rotation_velocity[0] + translation[0], rotation_velocity[1] + translation[1],
             rotation_velocity[2] + rate[at(ServoFeature::kTotalForce)] / contactStiffness(contact.force, contact.area)};
  return twist;
}

// Damped least squares, restricted to the motions that the selected features are controlled by. Features and motions are scaled
// to similar magnitudes.
Twist TactileServoController::measuredTwist(const TactileServo& servo, const ContactState& contact, const Features& rate) const {
  using Row = Eigen::Matrix<double, 1, 6>;
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::RowMajor, kNumServoFeatures, 6>;
  using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kNumServoFeatures, kNumServoFeatures>;
  using Column = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kNumServoFeatures, 1>;
  Row motion_scale;  // of v and w; 0 for motions that no selected feature is controlled by
  motion_scale << 0, 0, 0, 0, 0, 0;
  Rows rows(kNumServoFeatures, 6);
  Column target_rates(kNumServoFeatures);
  int count = 0;
  const auto addRow = [&](ServoFeature feature, const Row& row, double feature_scale) {
    rows.row(count) = row / feature_scale;
    target_rates[count++] = rate[at(feature)] / feature_scale;
  };
  const auto rotationRow = [](int axis) {
    Row row = Row::Zero();
    row[3 + axis] = -1;
    return row;
  };
  const auto measured = [](const float* values) { return Row(Eigen::Map<const Eigen::Matrix<float, 1, 6>>(values).cast<double>()); };
  const Row center[2] = {measured(contact.center_jacobian), measured(contact.center_jacobian + 6)};
  for (const std::size_t axis : {0, 1}) {
    if (!servo.loops[axis].selected) continue;
    motion_scale[servo.loops[axis].rolling_radius > 0 ? 4 - static_cast<int>(axis) : static_cast<int>(axis)] = 1;
    addRow(static_cast<ServoFeature>(axis), center[axis], kLengthScale);
  }
  if (servo[ServoFeature::kCenterAcross].selected) {
    motion_scale[0] = motion_scale[1] = 1;
    if (contact.confidence >= servo.min_confidence) {
      addRow(ServoFeature::kCenterAcross, -contact.edge[1] * center[0] + contact.edge[0] * center[1], kLengthScale);
    }
  }
  if (servo[ServoFeature::kTotalForce].selected) {
    motion_scale[2] = 1;
    addRow(ServoFeature::kTotalForce, measured(contact.force_jacobian), kLengthScale * contactStiffness(contact.force, contact.area));
  }
  if (servo[ServoFeature::kEdgeAngle].selected) {
    motion_scale[5] = 1;
    // Angles from other sources are assumed to rotate with the object: they change by -w_z.
    addRow(ServoFeature::kEdgeAngle,
           servo.edge_angle_source == EdgeAngleSource::kPrincipalAxis ? measured(contact.angle_jacobian) : rotationRow(2), kAngleScale);
  }
  for (const int axis : {0, 1}) {
    const ServoFeature feature = axis == 0 ? ServoFeature::kTiltX : ServoFeature::kTiltY;
    if (!servo[feature].selected) continue;
    motion_scale[3 + axis] = 1;
    addRow(feature, rotationRow(axis), kAngleScale);
  }
  motion_scale.head<3>() *= kLengthScale;
  motion_scale.tail<3>() *= kAngleScale;
  const Rows scaled = rows.topRows(count) * motion_scale.asDiagonal();
  const Square normal = scaled * scaled.transpose() + kDamping * kDamping * Square::Identity(count, count);
  const Row motion = (scaled.transpose() * normal.ldlt().solve(target_rates.head(count))).transpose().cwiseProduct(motion_scale);
  Twist twist{{motion[0], motion[1], motion[2]}, {motion[3], motion[4], motion[5]}};
  // Directions of translation without a feature keep the contact center in place.
  const std::array<double, 3> rotation_velocity = velocityOfRotationAbout(contact.center, twist.w);
  for (const int axis : {0, 1}) {
    if (motion_scale[axis] == 0) twist.v[axis] = rotation_velocity[axis];
  }
  return twist;
}

// Velocity at the exploration direction relative to the edge; zero if the edge is not known.
Twist TactileServoController::explorationTwist(const PreparedServo& servo, const ContactState& contact, double velocity) const {
  if (contact.confidence < servo.min_confidence) return {};
  const auto [c, s] = servo.exploration;
  return {{velocity * (c * contact.edge[0] - s * contact.edge[1]), velocity * (s * contact.edge[0] + c * contact.edge[1]), 0}, {}};
}

Twist TactileServoController::commandInstance(const PreparedServo& servo, const ContactState& contact, double dt, PidState& pid) const {
  if (contact.force <= 0 || contact.area <= 0) {
    pid.error.fill(kNaN);
    Twist twist;
    if (servo[ServoFeature::kTotalForce].selected && forceReference(servo, contact.start_force) > 0) {
      twist.v[2] = kApproachFraction * servo.max_linear_velocity;
    }
    return twist;
  }
  const Features error = featureErrors(servo, contact);
  // PID output: the commanded rate of each feature; 0 if its error is undefined.
  Features rate{}, integral = pid.integral;
  for (std::size_t f = 0; f < error.size(); ++f) {
    if (std::isnan(error[f])) continue;
    const FeatureLoop& loop = servo.loops[f];
    const double bounded = clipped(error[f], loop.error_limit);
    integral[f] = clipped(integral[f] + bounded * dt, loop.integral_limit);
    const double derivative = std::isnan(pid.error[f]) ? 0 : clipped((error[f] - pid.error[f]) / dt, loop.derivative_limit);
    rate[f] = loop.kp * bounded + loop.ki * integral[f] + loop.kd * derivative;
  }
  Twist twist = contact.center_jacobian ? measuredTwist(servo, contact, rate) : nominalTwist(servo, contact, rate);
  twist.v = add(twist.v, explorationTwist(servo, contact, pid.exploration_velocity).v);

  // Anti-windup: integrals that would increase a saturated velocity are held.
  const double angular_speed = length(twist.w);
  const bool is_translation_saturated = length(twist.v) > servo.max_linear_velocity,
             is_rotation_saturated = angular_speed > servo.max_angular_velocity;
  for (std::size_t f = 0; f < error.size(); ++f) {
    const bool saturated = isControlledByRotation(servo, f) ? is_rotation_saturated : is_translation_saturated;
    if (!(saturated && rate[f] * error[f] > 0)) pid.integral[f] = integral[f];
  }
  pid.error = error;

  if (is_rotation_saturated) {
    // Reduce the rotation about the contact center, including the velocity that belongs to it.
    const std::array<double, 3> before = velocityOfRotationAbout(contact.center, twist.w);
    for (double& component : twist.w) component *= servo.max_angular_velocity / angular_speed;
    const std::array<double, 3> after = velocityOfRotationAbout(contact.center, twist.w);
    for (std::size_t k = 0; k < 3; ++k) twist.v[k] += after[k] - before[k];
  }
  const double speed = length(twist.v);
  if (speed > servo.max_linear_velocity) {
    for (double& component : twist.v) component *= servo.max_linear_velocity / speed;
  }
  return twist;
}

TactileServoController::ContactState TactileServoController::contactState(const TactileServo& servo, const ServoInput& input,
                                                                          std::size_t i) const {
  const std::size_t row = i * static_cast<std::size_t>(input.num_rows) +
                          static_cast<std::size_t>(servo.contact == ServoContact::kLargestRegion ? input.region_row : input.whole_row);
  const ContactFeatureView& features = input.features;
  ContactState contact{.angle = features.edge_angle[row],
                       .confidence = features.edge_confidence[row],
                       .force = features.total_force[row],
                       .area = features.contact_area[row],
                       .center = {features.center_of_pressure[3 * row], features.center_of_pressure[3 * row + 1]},
                       .tilt = {0, 0},
                       .tilt_confidence = 0,
                       .start_force = input.start_force[i],
                       .edge = {0, 0},
                       .center_jacobian = nullptr,
                       .force_jacobian = nullptr,
                       .angle_jacobian = nullptr};
  if (needsTactileJacobian(servo)) {
    const std::size_t jacobian_row = i * static_cast<std::size_t>(input.num_jacobian_rows) + static_cast<std::size_t>(input.jacobian_row);
    contact.center_jacobian = &input.jacobian.center_of_pressure[18 * jacobian_row];
    contact.force_jacobian = &input.jacobian.total_force[6 * jacobian_row];
    contact.angle_jacobian = &input.jacobian.edge_angle[6 * jacobian_row];
  }
  if (servo[ServoFeature::kTiltX].selected || servo[ServoFeature::kTiltY].selected) {
    contact.tilt[0] = features.tilt[2 * row];
    contact.tilt[1] = features.tilt[2 * row + 1];
    contact.tilt_confidence = features.tilt_confidence[row];
  }
  if (servo.edge_angle_source == EdgeAngleSource::kWindow) {
    contact.angle = features.windowed_edge_angle[row];
    contact.confidence = features.windowed_edge_confidence[row];
  } else if (servo.edge_angle_source == EdgeAngleSource::kRidge) {
    contact.angle = features.ridge_edge_angle[row];
    contact.confidence = features.ridge_edge_confidence[row];
  } else if (servo.edge_angle_source == EdgeAngleSource::kExact) {
    const bool known = !std::isnan(input.exact_edge_angle[i]);
    contact.angle = known ? input.exact_edge_angle[i] : 0;
    contact.confidence = known ? 1 : 0;
  }
  if (contact.confidence >= servo.min_confidence) {
    const double along = edgeDirection(servo, contact.angle);
    const auto [sine, cosine] = sinCos(along);
    contact.edge[0] = cosine;
    contact.edge[1] = sine;
  }
  return contact;
}

void TactileServoController::command(const ServoInput& input, double dt, std::span<Twist> twists, int first, int last) {
  [[maybe_unused]] const std::size_t num_instances = twists.size();
  [[maybe_unused]] const std::size_t num_rows = num_instances * static_cast<std::size_t>(input.num_rows);
  assert(num_instances == pid_states_.size());
  [[maybe_unused]] const FeatureView& features = input.features;
  assert(features.edge_angle.size() == num_rows && features.edge_confidence.size() == num_rows);
  assert(features.total_force.size() == num_rows && features.center_of_pressure.size() == 3 * num_rows);
  assert(features.contact_area.size() == num_rows && input.start_force.size() == num_instances);
  assert(input.due.size() == num_instances);
  for (auto i = static_cast<std::size_t>(first); i < static_cast<std::size_t>(last); ++i) {
    if (!input.due[i]) continue;
    const PreparedServo& servo = servos_[static_cast<std::size_t>(pid_states_[i].servo)];
    const ContactState contact = contactState(servo, input, i);
    const double sum = contact.angle + contact.confidence + contact.force + contact.area + contact.center[0] + contact.center[1] +
                       contact.tilt[0] + contact.tilt[1] + contact.tilt_confidence + contact.start_force;
    twists[i] = std::isfinite(sum) ? commandInstance(servo, contact, dt, pid_states_[i]) : Twist{};
  }
}

}  // namespace taxelsim
