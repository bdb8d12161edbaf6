// Gains, references and limits of the controller that moves a sensor by what it feels. Not the controller: that belongs to the scheduler.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <optional>

namespace taxelsim {

// What the servo can hold at a reference, in the order of its arrays. All in the sensor frame S.
enum class ServoFeature {
  kCenterX,       // centre of pressure along x, m
  kCenterY,       // along y, m
  kCenterAcross,  // across the edge from the array's middle, along y where the edge lies along x, m; instead of x and y
  kTotalForce,    // N
  kEdgeAngle,     // rad, known up to pi
  kTiltX,         // rad, how a flat face is turned about x
  kTiltY,         // about y
};
inline constexpr int kNumServoFeatures = 7;

// Where the edge's angle is taken from.
enum class EdgeAngleSource {
  kPrincipalAxis,  // of all forces, edge_angle of the features (paper, eq. (3))
  kWindow,         // of the forces under a window, windowed_edge_angle of the contact features: hardly bent by the array's border
  kExact,          // the object's pose and the edge that its scene gives it: what no sensor knows, to be compared with
};

// What the features are of.
enum class ServoContact {
  kWhole,          // all that touches the sensor
  kLargestRegion,  // the connected taxels that carry most; its angles are in the plane of its patch
};

// How rates of features become a twist of the sensor.
enum class TactileJacobianSource {
  kNominal,   // a point contact on the skin's stiffness at the contact's area: moves and turns with the sensor
  kMeasured,  // the tactile Jacobian of the frame, inverted by damped least squares over the motions that the selected features take
};

// One feature's PID. Its error is reference - value, its output how fast the feature shall move to the reference.
struct FeatureLoop {
  bool selected = false;              // an entry of the selection matrix; the rest counts only where true
  std::optional<double> reference{};  // without one: the array's middle, the force that an episode starts with, angle 0
  double kp = 0;                      // 1/s, >= 0
  double ki = 0;                      // 1/s^2, >= 0
  double kd = 0;                      // >= 0, < 1: the error's own rate times kd
  // Largest sizes, > 0: of the error that kp and ki see (the feature's unit), of its integral (unit s), of its rate (unit/s).
  double error_limit = std::numeric_limits<double>::infinity();
  double integral_limit = std::numeric_limits<double>::infinity();
  double derivative_limit = std::numeric_limits<double>::infinity();
  // Of a centre: 0, the sensor slides to bring it back. Above, it turns: how far (m) the contact moves on the sensor per radian, the radius
  // of a rounded object; the sensor comes to lie along the surface under it.
  double rolling_radius = 0;  // m, >= 0
};

// Tactile servoing: feature error -> PID -> selection -> inverse tactile Jacobian -> twist of the sensor frame, and an exploration velocity
// beside it (Q. Li et al., "A control framework for tactile servoing", RSS 2013; paper, section IV). Clipped terms as of N. F. Lepora and
// J. Lloyd, "Pose-based tactile servoing", IEEE Robotics & Automation Magazine 28(4), 2021.
struct TactileServo {
  std::array<FeatureLoop, kNumServoFeatures> loops{};
  EdgeAngleSource edge_angle_source = EdgeAngleSource::kPrincipalAxis;
  ServoContact contact = ServoContact::kWhole;
  TactileJacobianSource jacobian = TactileJacobianSource::kNominal;  // kMeasured is of kWhole
  double exploration_velocity = 0;                                   // m/s
  double exploration_direction = 0;   // rad, of that velocity from the edge's direction: 0 along the edge, pi/2 across it
  double max_angular_velocity = 1;    // rad/s, > 0
  double max_linear_velocity = 0.02;  // m/s, > 0
  double min_confidence = 0.2;        // 0 to 1: below it edge angle and tilt are left alone

  FeatureLoop& operator[](ServoFeature feature) { return loops[static_cast<std::size_t>(feature)]; }
  const FeatureLoop& operator[](ServoFeature feature) const { return loops[static_cast<std::size_t>(feature)]; }
};

// Whether a servo looks at contact features, which a simulator computes only where they are asked for; and at those of regions.
bool needsContactFeatures(const TactileServo& servo);

// The same for the measured tactile Jacobian.
bool needsTactileJacobian(const TactileServo& servo);

// Follows an edge: holds its angle, the force, and the contact in the array's middle across the edge. 0.78 / s is the paper's 5 s.
TactileServo edgeServo();

}  // namespace taxelsim
