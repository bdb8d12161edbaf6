// Optional inputs of the servo: tilts, rolling, windowed and exact angles, the largest region, the measured Jacobian, several servos.
#include "control/tactile_servo.h"
#include "control/twist.h"
#include "servo_fixtures.h"
#include "support/test.h"

namespace taxelsim {
namespace {

constexpr std::uint8_t kDue = 1;

// Storage for the spans of a ServoInput with one instance and several rows.
struct FeatureRows {
  explicit FeatureRows(std::size_t num_rows)
      : angle(num_rows, 0),
        confidence(num_rows, 1),
        force(num_rows, 2),
        area(num_rows, 4e-5f),
        window(num_rows, 0),
        window_confidence(num_rows, 1),
        ridge(num_rows, 0),
        ridge_confidence(num_rows, 1),
        tilt_confidence(num_rows, 1),
        center(3 * num_rows, 0),
        tilt(2 * num_rows, 0) {}

  ServoInput input() const {
    ServoInput input = inputOf(angle, confidence, force, center, area, {&start_force, 1}, {&kDue, 1});
    input.num_rows = static_cast<int>(angle.size());
    input.region_row = input.num_rows - 1;
    input.exact_edge_angle = {&exact, 1};
    input.features.windowed_edge_angle = window;
    input.features.windowed_edge_confidence = window_confidence;
    input.features.ridge_edge_angle = ridge;
    input.features.ridge_edge_confidence = ridge_confidence;
    input.features.tilt = tilt;
    input.features.tilt_confidence = tilt_confidence;
    return input;
  }

  std::vector<float> angle, confidence, force, area, window, window_confidence, ridge, ridge_confidence, tilt_confidence, center, tilt;
  float exact = 0, start_force = 2;
};

Twist commanded(TactileServoController& controller, const FeatureRows& rows) {
  Twist twist;
  controller.command(rows.input(), kPeriod, {&twist, 1});
  return twist;
}

Twist commanded(const TactileServo& servo, const FeatureRows& rows) {
  TactileServoController controller(servo, gridSensor(), 1);
  return commanded(controller, rows);
}

TactileServo fastServo() {
  return {.max_angular_velocity = 100, .max_linear_velocity = 10};
}

// A flat face that is fixed in the world, tilted about x or y of the sensor: its tilt in S is (1 - kp Ts)^n of the initial one.
TEST(ServoFeatures, TiltDecaysGeometrically) {
  constexpr double kGain = 3, kStart = 0.3;
  for (const std::size_t axis : {std::size_t{0}, std::size_t{1}}) {
    TactileServo servo = fastServo();
    servo[axis == 0 ? ServoFeature::kTiltX : ServoFeature::kTiltY] = {.selected = true, .kp = kGain};
    TactileServoController controller(servo, gridSensor(), 1);
    const Quaternion R_WO = axisAngle(axis == 0 ? Vector3{1, 0, 0} : Vector3{0, 1, 0}, kStart);
    Pose X_WS;
    FeatureRows rows(1);
    for (int n = 0; n < 200; ++n) {
      // The normal of a face is (0, -sin a, cos a) after a rotation by a about x, and (sin b, 0, cos b) after one by b about y.
      const Vector3 normal = rotate(inverse(X_WS).rotation * R_WO, {0, 0, 1});
      const double tilt = axis == 0 ? std::atan2(-normal[1], normal[2]) : std::atan2(normal[0], normal[2]);
      ASSERT_NEAR(tilt, kStart * std::pow(1 - kGain * kPeriod, n), (n + 1) * kFloat) << "axis " << axis << ", step " << n;
      rows.tilt[axis] = static_cast<float>(tilt);
      X_WS = integrate(X_WS, commanded(controller, rows), kPeriod);
    }
  }
}

// A sphere that is fixed in the world touches the plane of S below its center. A rotation by w about the contact moves the center, at
// height r, by r sin(w Ts). With w = kp c / r the contact moves from c to c - r sin(kp Ts c / r).
TEST(ServoFeatures, CenterControlledByRollingMatchesTheClosedForm) {
  constexpr double kGain = 4, kRadius = 0.02, kStart = 0.006;
  for (const std::size_t axis : {std::size_t{0}, std::size_t{1}}) {
    TactileServo servo = fastServo();
    servo.loops[axis] = {.selected = true, .kp = kGain, .rolling_radius = kRadius};  // center_x, center_y
    TactileServoController controller(servo, gridSensor(), 1);
    Vector3 middle_W{0, 0, kRadius};
    middle_W[axis] = kStart;
    Pose X_WS;
    FeatureRows rows(1);
    double expected = kStart, height = kRadius;
    for (int n = 0; n < 100; ++n) {
      const Vector3 middle = inverse(X_WS) * middle_W;
      ASSERT_NEAR(middle[axis], expected, (n + 1) * kFloat * kStart) << "axis " << axis << ", step " << n;
      ASSERT_NEAR(middle[1 - axis], 0, 1e-15);
      rows.center[axis] = static_cast<float>(middle[axis]);
      const Twist twist = commanded(controller, rows);
      EXPECT_EQ(twist.w[axis], 0);
      X_WS = integrate(X_WS, twist, kPeriod);
      const double turn = kGain * kPeriod * expected / kRadius;
      expected -= height * std::sin(turn);
      height *= std::cos(turn);
    }
    EXPECT_LT(expected, 0.02 * kStart);
  }
}

TEST(ServoFeatures, UsesTheSelectedAngleSource) {
  FeatureRows rows(1);
  rows.angle[0] = 0.1f;
  rows.window[0] = 0.2f;
  rows.ridge[0] = 0.25f;
  rows.exact = 0.3f;
  TactileServo servo = fastServo();
  servo[ServoFeature::kEdgeAngle] = {.selected = true, .kp = 1};
  EXPECT_NEAR(commanded(servo, rows).w[2], 0.1, kFloat);
  servo.edge_angle_source = EdgeAngleSource::kWindow;
  EXPECT_NEAR(commanded(servo, rows).w[2], 0.2, kFloat);
  rows.window_confidence[0] = 0.1f;
  EXPECT_EQ(commanded(servo, rows), Twist{}) << "confidence below min_confidence";
  servo.edge_angle_source = EdgeAngleSource::kRidge;
  EXPECT_NEAR(commanded(servo, rows).w[2], 0.25, kFloat);
  rows.ridge_confidence[0] = 0.1f;
  EXPECT_EQ(commanded(servo, rows), Twist{}) << "confidence below min_confidence";
  servo.edge_angle_source = EdgeAngleSource::kExact;
  EXPECT_NEAR(commanded(servo, rows).w[2], 0.3, kFloat);
  rows.exact = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(commanded(servo, rows), Twist{}) << "the object has no edge";
}

TEST(ServoFeatures, UsesTheLargestRegionIfSelected) {
  FeatureRows rows(3);
  rows.angle = {0.1f, 0.2f, 0.3f};
  TactileServo servo = fastServo();
  servo[ServoFeature::kEdgeAngle] = {.selected = true, .kp = 1};
  EXPECT_NEAR(commanded(servo, rows).w[2], 0.1, kFloat);
  servo.contact = ServoContact::kLargestRegion;
  EXPECT_NEAR(commanded(servo, rows).w[2], 0.3, kFloat);
  rows.force[2] = 0;
  EXPECT_EQ(commanded(servo, rows), Twist{}) << "no region, no contact";
}

TEST(ServoFeatures, ExplorationDirectionIsRelativeToTheEdge) {
  FeatureRows rows(1);
  rows.angle[0] = 0.4f;
  TactileServo servo = fastServo();
  servo[ServoFeature::kCenterAcross] = {.selected = true, .kp = 1};
  servo.exploration_velocity = 0.01;
  servo.exploration_direction = std::numbers::pi / 2;
  const Twist twist = commanded(servo, rows);
  EXPECT_NEAR(twist.v[0], -0.01 * std::sin(0.4), 0.01 * kFloat);
  EXPECT_NEAR(twist.v[1], 0.01 * std::cos(0.4), 0.01 * kFloat);
}

TEST(ServoFeatures, ResetAssignsAServoToAnInstance) {
  TactileServo slow = fastServo(), fast = fastServo();
  slow[ServoFeature::kEdgeAngle] = {.selected = true, .kp = 1};
  fast[ServoFeature::kEdgeAngle] = {.selected = true, .kp = 5};
  fast.exploration_velocity = 0.002;
  const std::array servos{slow, fast};
  TactileServoController controller(servos, gridSensor(), 1);
  FeatureRows rows(1);
  rows.angle[0] = 0.1f;
  EXPECT_NEAR(commanded(controller, rows).w[2], 0.1, kFloat);
  controller.reset(0, 1);
  EXPECT_NEAR(commanded(controller, rows).w[2], 0.5, 5 * kFloat);
  EXPECT_EQ(controller.explorationVelocity(0), 0.002);
  controller.reset(0, 1, 0.003);
  EXPECT_EQ(controller.explorationVelocity(0), 0.003);
  EXPECT_NEAR(commanded(controller, rows).v[0], 0.003 * std::cos(0.1), kFloat);
}

// With the Jacobian of a point contact on a spring, the measured and the nominal inverse differ by the damping only.
TEST(ServoFeatures, MeasuredJacobianOfAPointContactGivesTheNominalTwist) {
  constexpr double kDampingError = 2e-4;  // relative: twice the square of the damping of 0.01
  FeatureRows rows(1);
  rows.angle[0] = 0.3f;
  rows.center = {0.004f, -0.007f, 0};
  rows.start_force = 3;
  TactileServo nominal = fastServo();
  nominal[ServoFeature::kEdgeAngle] = {.selected = true, .kp = 2};
  nominal[ServoFeature::kTotalForce] = {.selected = true, .kp = 3};
  const TactileServoController stiffness(nominal, gridSensor(), 1);
  const auto cx = rows.center[0], cy = rows.center[1];
  const auto k = static_cast<float>(stiffness.contactStiffness(rows.force[0], rows.area[0]));
  // Derivatives by (v, w) of the sensor for a point that is fixed in the world. Center: -v - w x c; force: spring; angle: -w_z.
  const std::array<float, 18> center{-1, 0, 0, 0, 0, cy, 0, -1, 0, 0, 0, -cx, 0, 0, -1, -cy, cx, 0};
  const std::array<float, 6> force{0, 0, k, k * cy, -k * cx, 0}, angle{0, 0, 0, 0, 0, -1};
  for (const bool across : {false, true}) {
    for (const bool rolls : {false, true}) {
      if (across && rolls) continue;
      TactileServo servo = nominal;
      servo.exploration_velocity = 0.002;
      if (across) {
        servo[ServoFeature::kCenterAcross] = {.selected = true, .kp = 4};
      } else if (!rolls) {
        servo[ServoFeature::kCenterX] = {.selected = true, .kp = 4};
        servo[ServoFeature::kCenterY] = {.selected = true, .reference = 0.001, .kp = 1};
      } else {
        servo[ServoFeature::kTiltX] = {.selected = true, .reference = 0.1, .kp = 1};
      }
      const Twist expected = commanded(servo, rows);
      servo.jacobian = TactileJacobianSource::kMeasured;
      TactileServoController controller(servo, gridSensor(), 1);
      ServoInput input = rows.input();
      input.jacobian.center_of_pressure = center;
      input.jacobian.total_force = force;
      input.jacobian.edge_angle = angle;
      Twist twist;
      controller.command(input, kPeriod, {&twist, 1});
      // center_across does not constrain translation along the edge; there the minimum-norm solution is 0, unlike the nominal one.
      const Vector3 u{std::cos(0.3), std::sin(0.3), 0};
      for (std::size_t i = 0; i < 3; ++i) {
        const double v = across ? 0 : twist.v[i] - expected.v[i];
        EXPECT_NEAR(v, 0, kDampingError * 0.1) << across << rolls << i;
        EXPECT_NEAR(twist.w[i], expected.w[i], kDampingError) << across << rolls << i;
      }
      const auto normalVelocity = [&](const Twist& t) { return -u[1] * t.v[0] + u[0] * t.v[1]; };
      EXPECT_NEAR(normalVelocity(twist), normalVelocity(expected), kDampingError * 0.1);
    }
  }
}

// The second of two sensors per instance, whose neighbour has other features, commands what it commands alone.
TEST(ServoFeatures, ReadsTheRowsOfItsSensor) {
  for (const ServoContact contact : {ServoContact::kWhole, ServoContact::kLargestRegion}) {
    TactileServo servo = fastServo();
    servo[ServoFeature::kTotalForce] = {.selected = true, .reference = 3, .kp = 4};
    servo.contact = contact;
    FeatureRows alone(2), both(4);
    alone.angle = {0.1f, 0.2f};
    alone.force = {2.0f, 1.0f};
    both.angle = {0.5f, 0.6f, 0.1f, 0.2f};
    both.force = {7.0f, 8.0f, 2.0f, 1.0f};
    ServoInput input = both.input();
    input.whole_row = 2;
    TactileServoController controller(servo, gridSensor(), 1);
    Twist twist;
    controller.command(input, kPeriod, {&twist, 1});
    EXPECT_EQ(twist, commanded(servo, alone));
    EXPECT_NE(twist, Twist{});
  }
  TactileServo servo = fastServo();
  servo[ServoFeature::kTotalForce] = {.selected = true, .reference = 3, .kp = 4};
  servo.jacobian = TactileJacobianSource::kMeasured;
  const FeatureRows rows(1);
  std::array<float, 36> center{};
  std::array<float, 12> force{}, angle{};
  center[18] = center[25] = -1;
  force[8] = 2e4f;
  angle[11] = -1;
  Twist expected, found;
  for (const int row : {0, 1}) {
    ServoInput input = rows.input();
    input.num_jacobian_rows = row + 1;
    input.jacobian_row = row;
    input.jacobian.center_of_pressure = std::span(center).subspan(row == 0 ? 18 : 0);
    input.jacobian.total_force = std::span(force).subspan(row == 0 ? 6 : 0);
    input.jacobian.edge_angle = std::span(angle).subspan(row == 0 ? 6 : 0);
    TactileServoController controller(servo, gridSensor(), 1);
    controller.command(input, kPeriod, {row == 0 ? &expected : &found, 1});
  }
  EXPECT_EQ(found, expected);
  EXPECT_NE(found, Twist{});
}

TEST(ServoFeatures, ZeroJacobianGivesZeroTwist) {
  TactileServo servo = fastServo();
  servo[ServoFeature::kCenterX] = {.selected = true, .kp = 4};
  servo[ServoFeature::kTotalForce] = {.selected = true, .kp = 3};
  servo.jacobian = TactileJacobianSource::kMeasured;
  TactileServoController controller(servo, gridSensor(), 1);
  FeatureRows rows(1);
  rows.center[0] = 0.01f;
  rows.start_force = 3;
  const std::array<float, 18> zeros{};
  ServoInput input = rows.input();
  input.jacobian.center_of_pressure = zeros;
  input.jacobian.total_force = input.jacobian.edge_angle = std::span(zeros).first<6>();
  Twist twist;
  controller.command(input, kPeriod, {&twist, 1});
  EXPECT_EQ(twist, Twist{});
}

TEST(ServoFeatures, NeedsContactFeaturesOnlyWhereTheyAreUsed) {
  TactileServo servo = edgeServo();
  EXPECT_FALSE(needsContactFeatures(servo));
  servo.edge_angle_source = EdgeAngleSource::kExact;
  EXPECT_FALSE(needsContactFeatures(servo));
  servo.contact = ServoContact::kLargestRegion;
  EXPECT_TRUE(needsContactFeatures(servo));
  servo = edgeServo();
  servo[ServoFeature::kTiltY].selected = true;
  EXPECT_TRUE(needsContactFeatures(servo));
}

}  // namespace
}  // namespace taxelsim
