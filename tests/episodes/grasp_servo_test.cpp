// Hands on an arm: the tactile servo of the palm moves the arm while the fingers hold their forces.
#include "episodes/grasp_batch.h"
#include "support/test.h"

namespace taxelsim {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

const Device& device() {
  static const Device opened = Device::open();
  return opened;
}

Scene shipped(const std::string& name) {
  return loadScene(std::filesystem::path(TAXELSIM_SOURCE_DIR) / "scenes/experiments/paper" / name);
}

// rad in (-pi/2, pi/2]: direction of the cylinder's axis, seen along z of the palm's sensor, from x.
double trueEdgeAngle(const GraspBatch& batch, int instance) {
  const Robots& robots = batch.robots().robots();
  const Pose X_SO = inverse(robots.X_WS()[static_cast<std::size_t>(instance * robots.numSensors())]) * batch.X_WO()[instance];
  const Vector3 axis = rotate(X_SO.rotation, {0, 0, 1});
  return std::atan(axis[1] / axis[0]);
}

bool belongsTo(const Grasp& grasp, int joint) {
  const auto& arm = grasp.servo->joints;
  if (std::find(arm.begin(), arm.end(), joint) != arm.end()) return true;
  return std::any_of(grasp.fingers.begin(), grasp.fingers.end(), [&](const GraspFinger& finger) {
    return std::any_of(finger.joints.begin(), finger.joints.end(), [&](const FingerJoint& one) { return one.joint == joint; });
  });
}

// N: largest error of the force over the fingers of an instance.
double largestForceError(const GraspBatch& batch, const Grasp& grasp, int instance) {
  double largest = 0;
  for (std::size_t f = 0; f < grasp.fingers.size(); ++f) {
    const int sensor = grasp.fingers[f].sensor;
    const double force = batch.robots().frame(sensor).total_force[batch.robots().row(sensor, instance)];
    const double target = batch.targetForces()[static_cast<std::size_t>(instance) * grasp.fingers.size() + f];
    largest = std::max(largest, std::abs(force - target));
  }
  return largest;
}

// Poses, joints and images of two batches are equal in every bit.
void expectEqualFrames(const GraspBatch& expected, const GraspBatch& found) {
  EXPECT_TRUE(std::ranges::equal(expected.robots().robots().jointPositions(), found.robots().robots().jointPositions()));
  for (int s = 0; s < expected.robots().numSensors(); ++s) {
    const FrameView &one = expected.robots().frame(s), &other = found.robots().frame(s);
    const std::size_t row = expected.robots().row(s, 0), other_row = found.robots().row(s, 0);
    EXPECT_EQ(one.total_force[row], other.total_force[other_row]) << s;
    const std::size_t num_taxels = one.tactile_image.size() / one.total_force.size();
    EXPECT_TRUE(std::ranges::equal(one.tactile_image.subspan(row * num_taxels, num_taxels),
                                   other.tactile_image.subspan(other_row * num_taxels, num_taxels)))
        << s;
  }
}

// rad: a reading of the edge angle at alignment. The angle of the principal axis is off by dM_xy / (M_xx - M_yy). Some 20 taxels are in
// contact, each off by half a count (1/4800 N), with |x y| of 13 mm^2 on average: 0.054 N mm^2 if all errors add up. M_xx - M_yy is 4 N
// ((20 mm)^2 / 12 - 2 mm^2).
constexpr double kAngleRounding = 0.054 / (4 * (400.0 / 12 - 2));
constexpr double kPalmRounding = 84.0 / 2400;            // N: each taxel is off by at most a count
constexpr double kFingerRounding = 24.0 / 2400 + 0.002;  // N: the same, and one taxel at its trigger
constexpr int kAllTouch = 200;                           // frames: every finger touches by 161, and 39 frames at 30/s leave 1e-6

// The object rests 12 degrees from the palm's direction. The error of the edge angle decays by 1 - kp T per frame, or faster where the
// sensor reads more than the true angle. The fingers hold their forces while the palm still rotates by 2 degrees.
TEST(ArmHand, PalmAlignsWithTheEdgeWhileTheFingersHold) {
  const Scene scene = shipped("arm_hand_rest_scene.yaml");
  const Grasp& grasp = *scene.grasp;
  const double kp = grasp.servo->servo[ServoFeature::kEdgeAngle].kp;
  constexpr int kInstances = 2;
  GraspBatch batch(device(), scene, {}, kInstances);
  batch.begin(0, kInstances);
  std::array<double, kInstances> first{}, when_held{};
  double largest_finger_error = 0;
  for (int frame = 0; frame < scene.num_steps; ++frame) {
    batch.step();
    for (int i = 0; i < kInstances; ++i) {
      if (frame == 0) first[i] = trueEdgeAngle(batch, i);
      if (frame == kAllTouch) when_held[i] = trueEdgeAngle(batch, i);
      if (frame >= kAllTouch) largest_finger_error = std::max(largest_finger_error, largestForceError(batch, grasp, i));
    }
  }
  const double rest = std::pow(1 - kp / scene.simulation_rate, scene.num_steps - 1);
  for (int i = 0; i < kInstances; ++i) {
    EXPECT_NEAR(first[i], -12 * kDegree, 1e-9);
    EXPECT_GT(std::abs(when_held[i]), 1 * kDegree);
    EXPECT_LT(std::abs(trueEdgeAngle(batch, i)), rest * std::abs(first[i]) + kAngleRounding);
    EXPECT_NEAR(batch.robots().frame(0).total_force[batch.robots().row(0, i)], 4, kPalmRounding);
  }
  EXPECT_LT(largest_finger_error, kFingerRounding);
}

// A human moves the object. The error of the edge angle stays below the drift of the object in the time 1 / kp of the loop and the tremor,
// three standard deviations of each, and no sensor loses the object once it has touched it.
TEST(ArmHand, FollowsAnObjectThatAHumanGives) {
  const Scene scene = shipped("arm_hand_given_scene.yaml");
  const auto& motion = std::get<HandHeld>(*scene.objects[0].motion);
  const double kp = scene.grasp->servo->servo[ServoFeature::kEdgeAngle].kp;
  const double rate = 2 * std::numbers::pi * motion.drift_band[1] * motion.drift_angle;  // rad/s, at most, root mean square
  const double tolerance = 3 * (rate / kp + motion.tremor_angle);
  GraspBatch batch(device(), scene, {}, 2);
  batch.begin(0, 2);
  for (int frame = 0; frame < scene.num_steps; ++frame) {
    batch.step();
    if (frame < kAllTouch) continue;
    for (int i = 0; i < 2; ++i) {
      EXPECT_LT(std::abs(trueEdgeAngle(batch, i)), tolerance) << frame;
      for (int s = 0; s < batch.robots().numSensors(); ++s) {
        EXPECT_GT(batch.robots().frame(s).total_force[batch.robots().row(s, i)], 0) << s << " " << frame;
      }
    }
  }
}

TEST(ArmHand, OnlyArmAndFingersMove) {
  const Scene scene = shipped("arm_hand_given_scene.yaml");
  const auto& joints = std::get<Manipulator>(scene.robot).joints;
  GraspBatch batch(device(), scene, {}, 1);
  batch.begin(0, 1);
  for (int frame = 0; frame < 20; ++frame) batch.step();
  int num_resting = 0;
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const double position = batch.robots().robots().jointPositions()[j];
    if (belongsTo(*scene.grasp, static_cast<int>(j))) {
      EXPECT_NE(position, joints[j].initial_position) << joints[j].name;
    } else {
      EXPECT_EQ(position, joints[j].initial_position) << joints[j].name;
      ++num_resting;
    }
  }
  EXPECT_EQ(num_resting, 10);  // WRJ1, WRJ2, FFJ4, MFJ4, RFJ4, LFJ4, LFJ5, THJ3, THJ4, THJ5
}

bool anyFingerTouches(const GraspBatch& batch, const Grasp& grasp) {
  return std::any_of(grasp.fingers.begin(), grasp.fingers.end(), [&](const GraspFinger& finger) {
    return batch.robots().frame(finger.sensor).total_force[batch.robots().row(finger.sensor, 0)] > 0;
  });
}

// A servo that commands no motion changes no bit of a grasp.
TEST(GraspServo, AnArmAtRestChangesNothing) {
  Scene scene = shipped("arm_hand_given_scene.yaml"), without = scene;
  without.grasp->servo.reset();
  TactileServo& servo = scene.grasp->servo->servo;
  servo = TactileServo{};
  servo[ServoFeature::kEdgeAngle] = {.selected = true, .kp = 0};
  GraspBatch expected(device(), without, {}, 1), found(device(), scene, {}, 1);
  for (GraspBatch* batch : {&expected, &found}) batch->begin(0, 1);
  for (int frame = 0; frame < 200; ++frame) {
    for (GraspBatch* batch : {&expected, &found}) batch->step();
    expectEqualFrames(expected, found);
  }
  EXPECT_TRUE(anyFingerTouches(found, *scene.grasp));
}

// A finger that a servo closes: its sensor in one simulator with four equal ones, and alone.
TEST(GraspServo, ReadsItsSensorAmongEqualOnes) {
  constexpr int kRing = 3;
  for (const auto contact : {ServoContact::kWhole, ServoContact::kLargestRegion}) {
    Scene scene = shipped("arm_hand_rest_scene.yaml");
    std::get<Manipulator>(scene.robot).selection = {false, false, true, false, false, false};
    Grasp& grasp = *scene.grasp;
    const auto ring = std::find_if(grasp.fingers.begin(), grasp.fingers.end(), [](const GraspFinger& f) { return f.sensor == kRing; });
    grasp.servo->sensor = kRing;
    grasp.servo->joints.clear();
    for (const FingerJoint& joint : ring->joints) grasp.servo->joints.push_back(joint.joint);
    grasp.fingers.erase(ring);
    TactileServo& servo = grasp.servo->servo;
    servo = TactileServo{.contact = contact, .max_linear_velocity = 0.2};
    servo[ServoFeature::kTotalForce] = {.selected = true, .reference = 1, .kp = 5};
    Scene alone = scene;
    alone.grasp->sensors[kRing].text += " alone";
    GraspBatch expected(device(), alone, {}, 2), found(device(), scene, {}, 2);
    for (GraspBatch* batch : {&expected, &found}) batch->begin(0, 2);
    ASSERT_EQ(expected.robots().row(kRing, 0), 0u);
    ASSERT_EQ(found.robots().row(kRing, 0), 2u);
    for (int frame = 0; frame < 300; ++frame) {
      for (GraspBatch* batch : {&expected, &found}) batch->step();
      expectEqualFrames(expected, found);
    }
    EXPECT_NEAR(found.robots().frame(kRing).total_force[2], 1, 0.1);
  }
}

}  // namespace
}  // namespace taxelsim
