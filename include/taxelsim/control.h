/// @file
/// Parameters of the tactile servo that moves a sensor by its readings: gains, references, limits. The controller itself runs inside
/// generate(), evaluate() and the experiments.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <optional>

namespace taxelsim {

/// Features that the servo can regulate, in the order of its arrays. All in the sensor frame S.
enum class ServoFeature {
  kCenterX,       ///< m, centre of pressure along x.
  kCenterY,       ///< m, centre of pressure along y.
  kCenterAcross,  ///< m, distance of the edge from the array's middle, along y if the edge lies along x. Excludes kCenterX and kCenterY.
  kTotalForce,    ///< N.
  kEdgeAngle,     ///< rad, modulo pi.
  kTiltX,         ///< rad, rotation of a flat face about x.
  kTiltY,         ///< rad, rotation of a flat face about y.
};
inline constexpr int kNumServoFeatures = 7;  ///< Number of ServoFeature values.

/// Source of the edge angle.
enum class EdgeAngleSource {
  kPrincipalAxis,  ///< Principal axis of all forces: FeatureView::edge_angle (paper, equation (3)).
  kWindow,         ///< Principal axis under a window: ContactFeatureView::windowed_edge_angle. Little biased by the border of the array.
  kRidge,          ///< Ridge of a fitted Gaussian: ContactFeatureView::ridge_edge_angle. Robust to gains that differ between taxels.
  kExact,          ///< Pose of the object and the edge that the scene gives it. Not measurable; a reference for comparisons.
};

/// Part of the image that the features describe.
enum class ServoContact {
  kWhole,          ///< All taxels.
  kLargestRegion,  ///< The connected region with the largest force. Its angles lie in the plane of its patch.
};

/// Map from feature rates to a twist of the sensor.
enum class TactileJacobianSource {
  kNominal,   ///< Model of a point contact with the skin's stiffness over the contact area.
  kMeasured,  ///< Tactile Jacobian of the frame, inverted by damped least squares over the motions of the selected features.
};

/// PID loop of one feature. The error is reference - value; the output is the rate at which the feature should approach the reference.
struct FeatureLoop {
  bool selected = false;  ///< Entry of the selection matrix; if false, the loop is inactive. Default false.
  /// Reference in the feature's unit. Default: the array's middle, the force at the start of the episode, angle 0.
  std::optional<double> reference{};
  double kp = 0;                                                      ///< 1/s, >= 0.
  double ki = 0;                                                      ///< 1/s^2, >= 0.
  double kd = 0;                                                      ///< >= 0, < 1; multiplies the rate of the error.
  double error_limit = std::numeric_limits<double>::infinity();       ///< > 0, clips the error before kp and ki, in its unit.
  double integral_limit = std::numeric_limits<double>::infinity();    ///< > 0, clips the integral, in its unit times s.
  double derivative_limit = std::numeric_limits<double>::infinity();  ///< > 0, clips the rate, in its unit per s.
  /// m, >= 0, for a centre. 0 (default): the sensor translates to recentre the contact. Above 0 it rotates instead: the value is the
  /// distance that the contact moves on the sensor per radian, the radius of a rounded object.
  double rolling_radius = 0;
};

/// Tactile servo: feature errors -> PID -> selection -> inverse tactile Jacobian -> twist of the sensor frame, plus an exploration
/// velocity.
///
/// After Q. Li et al., "A control framework for tactile servoing", RSS 2013, and section IV of the paper. Clipping after N. F. Lepora and
/// J. Lloyd, "Pose-based tactile servoing", IEEE Robotics & Automation Magazine 28(4), 2021.
struct TactileServo {
  std::array<FeatureLoop, kNumServoFeatures> loops{};                   ///< Loops by ServoFeature.
  EdgeAngleSource edge_angle_source = EdgeAngleSource::kPrincipalAxis;  ///< Source of the edge angle.
  ServoContact contact = ServoContact::kWhole;                          ///< Part of the image that is regulated.
  TactileJacobianSource jacobian = TactileJacobianSource::kNominal;     ///< kMeasured requires ServoContact::kWhole.
  double exploration_velocity = 0;                                      ///< m/s.
  double exploration_direction = 0;                                     ///< rad, -pi to pi, from the edge: 0 along it, pi/2 across it.
  double max_angular_velocity = 1;                                      ///< rad/s, > 0.
  double max_linear_velocity = 0.02;                                    ///< m/s, > 0.
  double min_confidence = 0.2;                                          ///< 0 to 1; below it edge angle and tilt are not regulated.

  /// Loop of one feature.
  FeatureLoop& operator[](ServoFeature feature) { return loops[static_cast<std::size_t>(feature)]; }
  /// Loop of one feature.
  const FeatureLoop& operator[](ServoFeature feature) const { return loops[static_cast<std::size_t>(feature)]; }
};

/// Whether the servo reads contact features or those of regions, which a simulator computes only on request (OutputOptions).
bool needsContactFeatures(const TactileServo& servo);

/// Whether the servo reads the measured tactile Jacobian, which a simulator computes only on request (OutputOptions).
bool needsTactileJacobian(const TactileServo& servo);

/// A servo that follows an edge: regulates its angle, the force, and its distance from the array's middle. Gain 0.78 / s: the settling time
/// of 5 s in the paper.
TactileServo edgeServo();

}  // namespace taxelsim
