// What the servo can look at beside the features of everything in contact, and how it turns: tilts, rolling, windows, regions, several
// servos.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "control/tactile_servo.h"
#include "control/twist.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

constexpr double kPeriod = 0.01;        // s
constexpr double kFloat = 4 * 0x1p-24;  // relative: features come as float32; a few roundings
constexpr std::uint8_t kDue = 1;

Sensor gridSensor() {
  Sensor sensor;
  sensor.patches.push_back({.name = "grid", .num_rows = 6, .num_cols = 14, .pitch = {3.4e-3, 3.4e-3}, .X_SP = {}});
  sensor.skin = {.thickness = 2e-3, .law = Winkler{.normal_contact_stiffness = 1.73e8}};
  return sensor;
}

// Rows of features of one instance; the arrays that a ServoInput looks into.
struct Rows {
  explicit Rows(std::size_t num_rows)
      : angle(num_rows, 0),
        confidence(num_rows, 1),
        force(num_rows, 2),
        area(num_rows, 4e-5f),
        window(num_rows, 0),
        window_confidence(num_rows, 1),
        tilt_confidence(num_rows, 1),
        center(3 * num_rows, 0),
        tilt(2 * num_rows, 0) {}

  ServoInput input() const {
    return {.num_rows = static_cast<int>(angle.size()),
            .region_row = static_cast<int>(angle.size()) - 1,
            .edge_angle = angle,
            .edge_confidence = confidence,
            .total_force = force,
            .center_of_pressure = center,
            .contact_area = area,
            .windowed_edge_angle = window,
            .windowed_edge_confidence = window_confidence,
            .tilt = tilt,
            .tilt_confidence = tilt_confidence,
            .exact_edge_angle = {&exact, 1},
            .start_force = {&start_force, 1},
            .due = {&kDue, 1}};
  }

  std::vector<float> angle, confidence, force, area, window, window_confidence, tilt_confidence, center, tilt;
  float exact = 0, start_force = 2;
};

Twist commanded(TactileServoController& controller, const Rows& rows) {
  Twist twist;
  controller.command(rows.input(), kPeriod, {&twist, 1});
  return twist;
}

Twist commanded(const TactileServo& servo, const Rows& rows) {
  TactileServoController controller(servo, gridSensor(), 1);
  return commanded(controller, rows);
}

TactileServo fastServo() {
  return {.max_angular_velocity = 100, .max_linear_velocity = 10};
}

// A flat face that rests in the world, tilted about x and y of the sensor by turns: its tilt in S falls as (1 - kp Ts)^n.
TEST(ServoFeatures, ATiltDecaysAsTheSampledLaw) {
  constexpr double kGain = 3, kStart = 0.3;
  for (const std::size_t axis : {std::size_t{0}, std::size_t{1}}) {
    TactileServo servo = fastServo();
    servo[axis == 0 ? ServoFeature::kTiltX : ServoFeature::kTiltY] = {.selected = true, .kp = kGain};
    TactileServoController controller(servo, gridSensor(), 1);
    const Quaternion R_WO = axisAngle(axis == 0 ? Vector3{1, 0, 0} : Vector3{0, 1, 0}, kStart);
    Pose X_WS;
    Rows rows(1);
    for (int n = 0; n < 200; ++n) {
      // A face's normal, at first z of S, goes to (0, -sin a, cos a) when turned about x and to (sin b, 0, cos b) about y.
      const Vector3 normal = rotate(inverse(X_WS).rotation * R_WO, {0, 0, 1});
      const double tilt = axis == 0 ? std::atan2(-normal[1], normal[2]) : std::atan2(normal[0], normal[2]);
      ASSERT_NEAR(tilt, kStart * std::pow(1 - kGain * kPeriod, n), (n + 1) * kFloat) << "axis " << axis << ", step " << n;
      rows.tilt[axis] = static_cast<float>(tilt);
      X_WS = integrate(X_WS, commanded(controller, rows), kPeriod);
    }
  }
}

// A ball that rests in the world touches the plane of S under its middle. Turning about that point by w moves the middle, which is r above,
// by r sin(w Ts): with w = kp c / r the contact goes from c to c - r sin(kp Ts c / r).
TEST(ServoFeatures, ACentreThatIsHeldByRollingDecaysAsGeometrySays) {
  constexpr double kGain = 4, kRadius = 0.02, kStart = 0.006;
  for (const std::size_t axis : {std::size_t{0}, std::size_t{1}}) {
    TactileServo servo = fastServo();
    servo.loops[axis] = {.selected = true, .kp = kGain, .rolling_radius = kRadius};  // center_x, center_y
    TactileServoController controller(servo, gridSensor(), 1);
    Vector3 middle_W{0, 0, kRadius};
    middle_W[axis] = kStart;
    Pose X_WS;
    Rows rows(1);
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

TEST(ServoFeatures, TheAngleComesFromWhereItIsToldTo) {
  Rows rows(1);
  rows.angle[0] = 0.1f;
  rows.window[0] = 0.2f;
  rows.exact = 0.3f;
  TactileServo servo = fastServo();
  servo[ServoFeature::kEdgeAngle] = {.selected = true, .kp = 1};
  EXPECT_NEAR(commanded(servo, rows).w[2], 0.1, kFloat);
  servo.edge_angle_source = EdgeAngleSource::kWindow;
  EXPECT_NEAR(commanded(servo, rows).w[2], 0.2, kFloat);
  rows.window_confidence[0] = 0.1f;
  EXPECT_EQ(commanded(servo, rows), Twist{}) << "an angle that nobody is sure of";
  servo.edge_angle_source = EdgeAngleSource::kExact;
  EXPECT_NEAR(commanded(servo, rows).w[2], 0.3, kFloat);
  rows.exact = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(commanded(servo, rows), Twist{}) << "an edge that the object does not have";
}

TEST(ServoFeatures, TheLargestRegionIsLookedAtAlone) {
  Rows rows(3);
  rows.angle = {0.1f, 0.2f, 0.3f};
  TactileServo servo = fastServo();
  servo[ServoFeature::kEdgeAngle] = {.selected = true, .kp = 1};
  EXPECT_NEAR(commanded(servo, rows).w[2], 0.1, kFloat);
  servo.contact = ServoContact::kLargestRegion;
  EXPECT_NEAR(commanded(servo, rows).w[2], 0.3, kFloat);
  rows.force[2] = 0;
  EXPECT_EQ(commanded(servo, rows), Twist{}) << "no region, no contact";
}

TEST(ServoFeatures, ExplorationIsTurnedFromTheEdge) {
  Rows rows(1);
  rows.angle[0] = 0.4f;
  TactileServo servo = fastServo();
  servo[ServoFeature::kCenterAcross] = {.selected = true, .kp = 1};
  servo.exploration_velocity = 0.01;
  servo.exploration_direction = std::numbers::pi / 2;
  const Twist twist = commanded(servo, rows);
  EXPECT_NEAR(twist.v[0], -0.01 * std::sin(0.4), 0.01 * kFloat);
  EXPECT_NEAR(twist.v[1], 0.01 * std::cos(0.4), 0.01 * kFloat);
}

TEST(ServoFeatures, EachInstanceHasTheServoOfItsEpisode) {
  TactileServo slow = fastServo(), fast = fastServo();
  slow[ServoFeature::kEdgeAngle] = {.selected = true, .kp = 1};
  fast[ServoFeature::kEdgeAngle] = {.selected = true, .kp = 5};
  fast.exploration_velocity = 0.002;
  const std::array servos{slow, fast};
  TactileServoController controller(servos, gridSensor(), 1);
  Rows rows(1);
  rows.angle[0] = 0.1f;
  EXPECT_NEAR(commanded(controller, rows).w[2], 0.1, kFloat);
  controller.reset(0, 1);
  EXPECT_NEAR(commanded(controller, rows).w[2], 0.5, 5 * kFloat);
  EXPECT_EQ(controller.explorationVelocity(0), 0.002);
  controller.reset(0, 1, 0.003);
  EXPECT_EQ(controller.explorationVelocity(0), 0.003);
  EXPECT_NEAR(commanded(controller, rows).v[0], 0.003 * std::cos(0.1), kFloat);
}

// With the Jacobian of a point on a spring, measured and nominal inverse are the same but for the damping.
TEST(ServoFeatures, AMeasuredJacobianOfThatContactIsTheNominalOne) {
  constexpr double kDamped = 2e-4;  // relative: damping of a hundredth, squared, twice over
  Rows rows(1);
  rows.angle[0] = 0.3f;
  rows.center = {0.004f, -0.007f, 0};
  rows.start_force = 3;
  TactileServo nominal = fastServo();
  nominal[ServoFeature::kEdgeAngle] = {.selected = true, .kp = 2};
  nominal[ServoFeature::kTotalForce] = {.selected = true, .kp = 3};
  const TactileServoController stiffness(nominal, gridSensor(), 1);
  const auto cx = rows.center[0], cy = rows.center[1];
  const auto k = static_cast<float>(stiffness.contactStiffness(rows.force[0], rows.area[0]));
  // By v and w of the sensor, of a point at rest in the world: -v - w x c; of the force: the spring; of the angle: -w_z.
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
      input.center_jacobian = center;
      input.force_jacobian = force;
      input.edge_angle_jacobian = angle;
      Twist twist;
      controller.command(input, kPeriod, {&twist, 1});
      // A centre across the edge says nothing of the way along it, which the shortest answer leaves where it is.
      const Vector3 u{std::cos(0.3), std::sin(0.3), 0};
      for (std::size_t i = 0; i < 3; ++i) {
        const double v = across ? 0 : twist.v[i] - expected.v[i];
        EXPECT_NEAR(v, 0, kDamped * 0.1) << across << rolls << i;
        EXPECT_NEAR(twist.w[i], expected.w[i], kDamped) << across << rolls << i;
      }
      const auto offEdge = [&](const Twist& t) { return -u[1] * t.v[0] + u[0] * t.v[1]; };
      EXPECT_NEAR(offEdge(twist), offEdge(expected), kDamped * 0.1);
    }
  }
}

TEST(ServoFeatures, AJacobianOfNothingMovesNothing) {
  TactileServo servo = fastServo();
  servo[ServoFeature::kCenterX] = {.selected = true, .kp = 4};
  servo[ServoFeature::kTotalForce] = {.selected = true, .kp = 3};
  servo.jacobian = TactileJacobianSource::kMeasured;
  TactileServoController controller(servo, gridSensor(), 1);
  Rows rows(1);
  rows.center[0] = 0.01f;
  rows.start_force = 3;
  const std::array<float, 18> none{};
  ServoInput input = rows.input();
  input.center_jacobian = none;
  input.force_jacobian = input.edge_angle_jacobian = std::span(none).first<6>();
  Twist twist;
  controller.command(input, kPeriod, {&twist, 1});
  EXPECT_EQ(twist, Twist{});
}

TEST(ServoFeatures, OnlyCentresRoll) {
  TactileServo servo = fastServo();
  servo[ServoFeature::kTotalForce] = {.selected = true, .kp = 1, .rolling_radius = 0.01};
  EXPECT_THROW(TactileServoController(servo, gridSensor(), 1), Error);
  servo = fastServo();
  servo[ServoFeature::kCenterX] = {.selected = true, .kp = 1, .rolling_radius = -0.01};
  EXPECT_THROW(TactileServoController(servo, gridSensor(), 1), Error);
}

TEST(ServoFeatures, ContactFeaturesAreAskedForWhereTheyAreLookedAt) {
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
