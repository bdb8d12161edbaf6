#include "control/tactile_servo.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "base/vector3.h"
#include "control/values.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

// Speed without contact, as a part of max_linear_velocity: slow enough that one control period does not cross the skin.
constexpr double kApproachFraction = 0.1;

// Smallest mean pressure at which a curved law (exponent > 1) is linearised, as the depth it stands for: at no depth it has no stiffness.
constexpr double kLinearisationDepth = 1e-4;  // m

// Of the measured Jacobian: a millimetre of motion and what it makes of centre and force are of size 1, so are 3 degrees; damping is a
// hundredth of that, so that it costs a regular Jacobian a ten thousandth.
constexpr double kUnitLength = 1e-3, kUnitAngle = 0.05, kDamping = 0.01;

constexpr const char* kFeatureNames[kNumServoFeatures] = {"center_x",   "center_y", "center_across", "total_force",
                                                          "edge_angle", "tilt_x",   "tilt_y"};

constexpr std::size_t at(ServoFeature feature) {
  return static_cast<std::size_t>(feature);
}

double clipped(double value, double limit) {
  return std::clamp(value, -limit, limit);
}

double lengthOf(const std::array<double, 3>& v) {
  return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

// The velocity at the sensor's origin of a turn w that leaves the contact's middle where it is: -w x c.
std::array<double, 3> turnAbout(const double* center, const std::array<double, 3>& w) {
  return {w[2] * center[1], -w[2] * center[0], w[1] * center[0] - w[0] * center[1]};
}

bool isCenter(std::size_t feature) {
  return feature <= at(ServoFeature::kCenterAcross);
}

// Whether the feature is held by turning the sensor.
bool isTurned(const TactileServo& servo, std::size_t feature) {
  return isCenter(feature) ? servo.loops[feature].rolling_radius > 0 : feature >= at(ServoFeature::kEdgeAngle);
}

double forceReference(const TactileServo& servo, double start_force) {
  return servo[ServoFeature::kTotalForce].reference.value_or(start_force);
}

// The representative in (-pi/2, pi/2] of an angle between lines.
double wrapLineAngle(double angle) {
  if (std::abs(angle) < std::numbers::pi / 2) return angle;
  const double wrapped = std::remainder(angle, std::numbers::pi);
  return wrapped <= -std::numbers::pi / 2 ? wrapped + std::numbers::pi : wrapped;
}

// The edge's direction. A line has two; the one nearer the reference is kept, so that nothing turns back where the angle wraps.
double directionOf(const TactileServo& servo, double angle) {
  const double reference = servo[ServoFeature::kEdgeAngle].reference.value_or(0);
  return reference + wrapLineAngle(angle - reference);
}

void checkLoop(const FeatureLoop& loop, std::size_t feature) {
  const std::string where = std::string("controller: ") + kFeatureNames[feature];
  const char* what = where.c_str();
  if (loop.reference) requireValue(std::isfinite(*loop.reference), what, "reference", *loop.reference, "a finite number");
  requireValue(isAtLeastZero(loop.kp), what, "kp", loop.kp, "a number >= 0");
  requireValue(isAtLeastZero(loop.ki), what, "ki", loop.ki, "a number >= 0");
  requireValue(loop.kd >= 0 && loop.kd < 1, what, "kd", loop.kd, "a number >= 0 and < 1");
  requireValue(loop.error_limit > 0, what, "error_limit", loop.error_limit, "a number > 0");
  requireValue(loop.integral_limit > 0, what, "integral_limit", loop.integral_limit, "a number > 0");
  requireValue(loop.derivative_limit > 0, what, "derivative_limit", loop.derivative_limit, "a number > 0");
  const bool may_roll = feature == at(ServoFeature::kCenterX) || feature == at(ServoFeature::kCenterY);
  requireValue(may_roll ? isAtLeastZero(loop.rolling_radius) : loop.rolling_radius == 0, what, "rolling_radius", loop.rolling_radius,
               may_roll ? "a number >= 0" : "0: only center_x and center_y are held by rolling");
}

void checkServo(const TactileServo& servo) {
  bool any = false;
  for (std::size_t f = 0; f < servo.loops.size(); ++f) {
    if (servo.loops[f].selected) checkLoop(servo.loops[f], f);
    any = any || servo.loops[f].selected;
  }
  if (!any) throw Error(ErrorKind::kInput, "controller: no feature is selected");
  if (servo[ServoFeature::kCenterAcross].selected && (servo[ServoFeature::kCenterX].selected || servo[ServoFeature::kCenterY].selected)) {
    throw Error(ErrorKind::kInput, "controller: center_across is selected beside center_x or center_y, which hold the same contact");
  }
  if (servo.jacobian == TactileJacobianSource::kMeasured && servo.contact != ServoContact::kWhole) {
    throw Error(ErrorKind::kInput,
                "controller: the measured Jacobian is of all that touches the sensor, and contact is the largest region");
  }
  requireValue(std::isfinite(servo.exploration_velocity), "controller", "exploration_velocity", servo.exploration_velocity,
               "a finite velocity");
  requireValue(std::isfinite(servo.exploration_direction), "controller", "exploration_direction", servo.exploration_direction,
               "a finite angle");
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

bool needsContactFeatures(const TactileServo& servo) {
  return servo.edge_angle_source == EdgeAngleSource::kWindow || servo.contact != ServoContact::kWhole ||
         servo[ServoFeature::kTiltX].selected || servo[ServoFeature::kTiltY].selected;
}

bool needsTactileJacobian(const TactileServo& servo) {
  return servo.jacobian == TactileJacobianSource::kMeasured;
}

TactileServoController::TactileServoController(std::span<const TactileServo> servos, const Sensor& sensor, int num_instances)
    : servos_(servos.begin(), servos.end()) {
  assert(!servos_.empty());
  for (const TactileServo& servo : servos_) checkServo(servo);
  memory_.resize(static_cast<std::size_t>(num_instances));
  for (int i = 0; i < num_instances; ++i) reset(i);

  const Winkler foundation = foundationOf(sensor.skin);
  stiffness_ = foundation.normal_contact_stiffness;
  exponent_ = foundation.normal_exponent;

  middle_ = arrayMiddle(sensor);
  taxel_area_ = std::numeric_limits<double>::infinity();
  for (const GridPatch& patch : sensor.patches) taxel_area_ = std::min(taxel_area_, patch.pitch[0] * patch.pitch[1]);
}

void TactileServoController::reset(int instance, int servo, std::optional<double> exploration_velocity) {
  Memory& memory = memory_[static_cast<std::size_t>(instance)];
  memory.integral.fill(0);
  memory.error.fill(kUnknown);
  memory.servo = servo;
  memory.exploration_velocity = exploration_velocity.value_or(servos_[static_cast<std::size_t>(servo)].exploration_velocity);
}

double TactileServoController::contactStiffness(double force, double area) const {
  area = std::max(area, taxel_area_);
  if (exponent_ == 1) return stiffness_ * area;
  const double pressure = std::max(force / area, stiffness_ * std::pow(kLinearisationDepth, exponent_));
  const double depth = std::pow(pressure / stiffness_, 1 / exponent_);
  return exponent_ * pressure * area / depth;
}

// Reference - value of each feature; NaN where it is not selected or not known.
TactileServoController::Features TactileServoController::errorsOf(const TactileServo& servo, const Felt& felt) const {
  Features error;
  error.fill(kUnknown);
  const auto set = [&](ServoFeature feature, double otherwise, double value) {
    if (servo[feature].selected) error[at(feature)] = servo[feature].reference.value_or(otherwise) - value;
  };
  set(ServoFeature::kCenterX, middle_[0], felt.center[0]);
  set(ServoFeature::kCenterY, middle_[1], felt.center[1]);
  set(ServoFeature::kTotalForce, felt.start_force, felt.force);
  if (felt.tilt_confidence >= servo.min_confidence) {
    set(ServoFeature::kTiltX, 0, felt.tilt[0]);
    set(ServoFeature::kTiltY, 0, felt.tilt[1]);
  }
  if (felt.confidence < servo.min_confidence) return error;
  set(ServoFeature::kCenterAcross, 0, (felt.center[1] - middle_[1]) * felt.edge[0] - (felt.center[0] - middle_[0]) * felt.edge[1]);
  set(ServoFeature::kEdgeAngle, 0, felt.angle);
  error[at(ServoFeature::kEdgeAngle)] = wrapLineAngle(error[at(ServoFeature::kEdgeAngle)]);
  return error;
}

// The inverse of the nominal tactile Jacobian: see tactile_servo.h.
Twist TactileServoController::nominalTwist(const TactileServo& servo, const Felt& felt, const Features& rate) const {
  Twist twist;
  twist.w = {-rate[at(ServoFeature::kTiltX)], -rate[at(ServoFeature::kTiltY)], -rate[at(ServoFeature::kEdgeAngle)]};
  std::array<double, 2> slide{};
  for (const std::size_t axis : {0, 1}) {
    const double radius = servo.loops[axis].rolling_radius;  // of center_x, center_y
    if (radius > 0) {
      twist.w[1 - axis] += (axis == 0 ? -rate[axis] : rate[axis]) / radius;
    } else {
      slide[axis] = -rate[axis];
    }
  }
  if (felt.confidence >= servo.min_confidence) {
    const double across = rate[at(ServoFeature::kCenterAcross)];
    slide[0] += across * felt.edge[1];
    slide[1] -= across * felt.edge[0];
  } else if (servo[ServoFeature::kCenterAcross].selected) {
    // No edge to go along: every direction is across it.
    const double kp = servo[ServoFeature::kCenterAcross].kp;
    slide[0] += kp * (felt.center[0] - middle_[0]);
    slide[1] += kp * (felt.center[1] - middle_[1]);
  }
  const std::array<double, 3> turn = turnAbout(felt.center, twist.w);
  twist.v = {turn[0] + slide[0], turn[1] + slide[1],
             turn[2] + rate[at(ServoFeature::kTotalForce)] / contactStiffness(felt.force, felt.area)};
  return twist;
}

// Damped least squares over the motions that the selected features take, features and motions in units in which all are about as large.
Twist TactileServoController::measuredTwist(const TactileServo& servo, const Felt& felt, const Features& rate) const {
  using Row = Eigen::Matrix<double, 1, 6>;
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::RowMajor, kNumServoFeatures, 6>;
  using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kNumServoFeatures, kNumServoFeatures>;
  using Column = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kNumServoFeatures, 1>;
  Row unit;  // of motions; none where no feature takes it
  unit << 0, 0, 0, 0, 0, 0;
  Rows rows(kNumServoFeatures, 6);
  Column wanted(kNumServoFeatures);
  int count = 0;
  const auto take = [&](ServoFeature feature, const Row& row, double unit_of_feature) {
    rows.row(count) = row / unit_of_feature;
    wanted[count++] = rate[at(feature)] / unit_of_feature;
  };
  const auto turn = [](int axis) {
    Row row = Row::Zero();
    row[3 + axis] = -1;
    return row;
  };
  const auto measured = [](const float* values) { return Row(Eigen::Map<const Eigen::Matrix<float, 1, 6>>(values).cast<double>()); };
  const Row center[2] = {measured(felt.center_jacobian), measured(felt.center_jacobian + 6)};
  for (const std::size_t axis : {0, 1}) {
    if (!servo.loops[axis].selected) continue;
    unit[servo.loops[axis].rolling_radius > 0 ? 4 - static_cast<int>(axis) : static_cast<int>(axis)] = 1;
    take(static_cast<ServoFeature>(axis), center[axis], kUnitLength);
  }
  if (servo[ServoFeature::kCenterAcross].selected) {
    unit[0] = unit[1] = 1;
    if (felt.confidence >= servo.min_confidence) {
      take(ServoFeature::kCenterAcross, -felt.edge[1] * center[0] + felt.edge[0] * center[1], kUnitLength);
    }
  }
  if (servo[ServoFeature::kTotalForce].selected) {
    unit[2] = 1;
    take(ServoFeature::kTotalForce, measured(felt.force_jacobian), kUnitLength * contactStiffness(felt.force, felt.area));
  }
  if (servo[ServoFeature::kEdgeAngle].selected) {
    unit[5] = 1;
    // Other angles than the principal axis turn as the object does.
    take(ServoFeature::kEdgeAngle, servo.edge_angle_source == EdgeAngleSource::kPrincipalAxis ? measured(felt.angle_jacobian) : turn(2),
         kUnitAngle);
  }
  for (const int axis : {0, 1}) {
    const ServoFeature feature = axis == 0 ? ServoFeature::kTiltX : ServoFeature::kTiltY;
    if (!servo[feature].selected) continue;
    unit[3 + axis] = 1;
    take(feature, turn(axis), kUnitAngle);
  }
  unit.head<3>() *= kUnitLength;
  unit.tail<3>() *= kUnitAngle;
  const Rows scaled = rows.topRows(count) * unit.asDiagonal();
  const Square normal = scaled * scaled.transpose() + kDamping * kDamping * Square::Identity(count, count);
  const Row motion = (scaled.transpose() * normal.ldlt().solve(wanted.head(count))).transpose().cwiseProduct(unit);
  Twist twist{{motion[0], motion[1], motion[2]}, {motion[3], motion[4], motion[5]}};
  // Where no feature says how to slide, turn about the contact.
  const std::array<double, 3> about = turnAbout(felt.center, twist.w);
  for (const int axis : {0, 1}) {
    if (unit[axis] == 0) twist.v[axis] = about[axis];
  }
  return twist;
}

// Along the edge, or turned from it; none where the edge is not known.
Twist TactileServoController::exploration(const TactileServo& servo, const Felt& felt, double velocity) const {
  if (felt.confidence < servo.min_confidence) return {};
  const double c = std::cos(servo.exploration_direction), s = std::sin(servo.exploration_direction);
  return {{velocity * (c * felt.edge[0] - s * felt.edge[1]), velocity * (s * felt.edge[0] + c * felt.edge[1]), 0}, {}};
}

Twist TactileServoController::commandOne(const TactileServo& servo, const Felt& felt, double dt, Memory& memory) const {
  if (felt.force <= 0 || felt.area <= 0) {
    memory.error.fill(kUnknown);
    Twist twist;
    if (servo[ServoFeature::kTotalForce].selected && forceReference(servo, felt.start_force) > 0) {
      twist.v[2] = kApproachFraction * servo.max_linear_velocity;
    }
    return twist;
  }
  const Features error = errorsOf(servo, felt);
  // How fast each feature shall move; 0 where its error is not known.
  Features rate{}, integral = memory.integral;
  for (std::size_t f = 0; f < error.size(); ++f) {
    if (std::isnan(error[f])) continue;
    const FeatureLoop& loop = servo.loops[f];
    const double bounded = clipped(error[f], loop.error_limit);
    integral[f] = clipped(integral[f] + bounded * dt, loop.integral_limit);
    const double derivative = std::isnan(memory.error[f]) ? 0 : clipped((error[f] - memory.error[f]) / dt, loop.derivative_limit);
    rate[f] = loop.kp * bounded + loop.ki * integral[f] + loop.kd * derivative;
  }
  Twist twist = felt.center_jacobian ? measuredTwist(servo, felt, rate) : nominalTwist(servo, felt, rate);
  twist.v = add(twist.v, exploration(servo, felt, memory.exploration_velocity).v);

  // An integral that would press further against a limit waits.
  const double turning = lengthOf(twist.w);
  const bool too_fast = lengthOf(twist.v) > servo.max_linear_velocity, turns_too_fast = turning > servo.max_angular_velocity;
  for (std::size_t f = 0; f < error.size(); ++f) {
    const bool saturated = isTurned(servo, f) ? turns_too_fast : too_fast;
    if (!(saturated && rate[f] * error[f] > 0)) memory.integral[f] = integral[f];
  }
  memory.error = error;

  if (turns_too_fast) {
    // About the same contact, more slowly.
    const std::array<double, 3> before = turnAbout(felt.center, twist.w);
    for (double& component : twist.w) component *= servo.max_angular_velocity / turning;
    const std::array<double, 3> after = turnAbout(felt.center, twist.w);
    for (std::size_t k = 0; k < 3; ++k) twist.v[k] += after[k] - before[k];
  }
  const double speed = lengthOf(twist.v);
  if (speed > servo.max_linear_velocity) {
    for (double& component : twist.v) component *= servo.max_linear_velocity / speed;
  }
  return twist;
}

TactileServoController::Felt TactileServoController::feltBy(const TactileServo& servo, const ServoInput& input, std::size_t i) const {
  const std::size_t row = i * static_cast<std::size_t>(input.num_rows) +
                          static_cast<std::size_t>(servo.contact == ServoContact::kLargestRegion ? input.region_row : 0);
  Felt felt{.angle = input.edge_angle[row],
            .confidence = input.edge_confidence[row],
            .force = input.total_force[row],
            .area = input.contact_area[row],
            .center = {input.center_of_pressure[3 * row], input.center_of_pressure[3 * row + 1]},
            .tilt = {0, 0},
            .tilt_confidence = 0,
            .start_force = input.start_force[i],
            .edge = {0, 0},
            .center_jacobian = nullptr,
            .force_jacobian = nullptr,
            .angle_jacobian = nullptr};
  if (needsTactileJacobian(servo)) {
    const std::size_t jacobian_row = i * static_cast<std::size_t>(input.num_jacobian_rows);
    felt.center_jacobian = &input.center_jacobian[18 * jacobian_row];
    felt.force_jacobian = &input.force_jacobian[6 * jacobian_row];
    felt.angle_jacobian = &input.edge_angle_jacobian[6 * jacobian_row];
  }
  if (servo[ServoFeature::kTiltX].selected || servo[ServoFeature::kTiltY].selected) {
    felt.tilt[0] = input.tilt[2 * row];
    felt.tilt[1] = input.tilt[2 * row + 1];
    felt.tilt_confidence = input.tilt_confidence[row];
  }
  if (servo.edge_angle_source == EdgeAngleSource::kWindow) {
    felt.angle = input.windowed_edge_angle[row];
    felt.confidence = input.windowed_edge_confidence[row];
  } else if (servo.edge_angle_source == EdgeAngleSource::kExact) {
    const bool known = !std::isnan(input.exact_edge_angle[i]);
    felt.angle = known ? input.exact_edge_angle[i] : 0;
    felt.confidence = known ? 1 : 0;
  }
  if (felt.confidence >= servo.min_confidence) {
    const double along = directionOf(servo, felt.angle);
    felt.edge[0] = std::cos(along);
    felt.edge[1] = std::sin(along);
  }
  return felt;
}

void TactileServoController::command(const ServoInput& input, double dt, std::span<Twist> twists) {
  const std::size_t num_instances = twists.size();
  [[maybe_unused]] const std::size_t num_rows = num_instances * static_cast<std::size_t>(input.num_rows);
  assert(num_instances == memory_.size());
  assert(input.edge_angle.size() == num_rows && input.edge_confidence.size() == num_rows);
  assert(input.total_force.size() == num_rows && input.center_of_pressure.size() == 3 * num_rows);
  assert(input.contact_area.size() == num_rows && input.start_force.size() == num_instances);
  assert(input.due.size() == num_instances);
  for (std::size_t i = 0; i < num_instances; ++i) {
    if (!input.due[i]) continue;
    const TactileServo& servo = servos_[static_cast<std::size_t>(memory_[i].servo)];
    const Felt felt = feltBy(servo, input, i);
    const double sum = felt.angle + felt.confidence + felt.force + felt.area + felt.center[0] + felt.center[1] + felt.tilt[0] +
                       felt.tilt[1] + felt.tilt_confidence + felt.start_force;
    twists[i] = std::isfinite(sum) ? commandOne(servo, felt, dt, memory_[i]) : Twist{};
  }
}

}  // namespace taxelsim
