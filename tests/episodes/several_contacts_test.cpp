// Several contacts at once: on the sensors of a hand, each with its own sensor file and objects, and on one sensor, whose regions and servo
// must keep two contacts apart.
#include "control/tactile_servo.h"
#include "control/twist.h"
#include "episodes/sensed_robots.h"
#include "episodes/sensor_features.h"
#include "simulation/feature_table.h"
#include "support/test.h"
#include "taxelsim/scene.h"

namespace taxelsim {
namespace {

const std::filesystem::path kScenes = std::filesystem::path(TAXELSIM_SOURCE_DIR) / "scenes";
constexpr double kStep = 0.01;  // s
constexpr int kMostRegions = 3;

const Device& device() {
  static const Device opened = Device::open();
  return opened;
}

constexpr OutputOptions kAllOutputs{
    .contact_features = true, .clean_contact_features = true, .tactile_jacobian = true, .clean_tactile_jacobian = true};

// An object that presses on one sensor of the hand.
struct Press {
  int sensor;
  Object object;
  Pose X_SO;
};

// A rolling pin along y of S, or in the direction `yaw` from it.
Pose lying(double x, double y, double z, double yaw = 0) {
  return {{x, y, z}, axisAngle({0, 0, 1}, yaw) * axisAngle({1, 0, 0}, std::numbers::pi / 2)};
}

enum HandSensors { kPalm, kFirst, kMiddle, kRing, kLittle, kThumb };

// Four different sensors, of several patches, of one grid and two curved lists. Three of the six are equal.
std::vector<RobotSensor> differentSensors() {
  std::vector<RobotSensor> sensors;
  for (const char* const name :
       {"digitacts_6x4", "fingertip_6x4", "fingertip_sphere", "fingertip_6x4", "fingertip_cylinder", "fingertip_6x4"}) {
    const Sensor sensor = loadSensor(kScenes / "sensors" / (std::string(name) + ".yaml"));
    sensors.push_back({.name = "s" + std::to_string(sensors.size()), .sensor = sensor, .text = sensorText(sensor)});
  }
  return sensors;
}

// All eight slots: one object on each patch of the palm, one on each finger.
std::vector<Press> presses() {
  return {{kPalm, {Sphere{0.006}}, {{0.003, 0.001, 0.0056}, {1, 0, 0, 0}}},
          {kPalm, {Cylinder{0.004, 0.012}}, lying(-0.003, 0.02, 0.0036, 1.1)},
          {kPalm, {Sphere{0.006}}, {{0.004, -0.021, 0.0057}, {1, 0, 0, 0}}},
          {kFirst, {Sphere{0.004}}, {{0.001, 0.001, 0.0036}, {1, 0, 0, 0}}},
          {kMiddle, {Sphere{0.005}}, {{0.0004, -0.0007, 0.0046}, {1, 0, 0, 0}}},
          {kRing, {Cylinder{0.003, 0.008}}, lying(-0.001, 0.0005, 0.0026, 0.3)},
          {kLittle, {Box{{0.006, 0.008, 0.004}}}, {{0, 0.001, 0.0016}, axisAngle({0, 0, 1}, 0.2)}},
          {kThumb, {Sphere{0.004}}, {{0.001, -0.001, 0.0036}, {1, 0, 0, 0}}}};
}

// The Shadow hand with its thumb stretched out, away from the fingers.
Manipulator openHand() {
  Scene scene = loadScene(kScenes / "shadow_grasp.yaml");
  auto hand = std::get<Manipulator>(scene.robot);
  for (Joint& joint : hand.joints) {
    if (joint.name.starts_with("THJ")) joint.initial_position = 0;
  }
  return hand;
}

// Every value of a row of a batch has the bits of the batch of one instance.
template <typename Field, typename View>
void expectEqualFields(std::span<const Field> table, const View& alone, const View& batch, std::size_t row) {
  for (const Field& field : table) {
    const FeatureValues found = field.values(batch);
    std::visit(
        [&](const auto& expected) {
          using Values = std::remove_cvref_t<decltype(expected)>;
          ASSERT_FALSE(expected.empty()) << field.name;
          EXPECT_TRUE(std::ranges::equal(expected, std::get<Values>(found).subspan(row * expected.size(), expected.size()))) << field.name;
        },
        field.values(alone));
  }
}

void expectEqualFeatures(const FrameView& alone, const FrameView& batch, std::size_t row) {
  expectEqualFields<FeatureField<FeatureView>>(imageFeatures(), alone, batch, row);
  expectEqualFields<FeatureField<FeatureView>>(imageFeatures(), alone.ground_truth, batch.ground_truth, row);
  const auto contact = [&](const ContactFeatureView& one, const ContactFeatureView& other) {
    expectEqualFields<FeatureField<FeatureView>>(imageFeatures(), one, other, row);
    expectEqualFields<FeatureField<ContactFeatureView>>(contactFeatures(), one, other, row);
    expectEqualFields<FeatureField<ContactFeatureView>>(regionFeatures(), one, other, row);
  };
  contact(alone.contact, batch.contact);
  contact(alone.ground_truth.contact, batch.ground_truth.contact);
  expectEqualFields<FeatureField<TactileJacobianView>>(jacobianFeatures(), alone.jacobian, batch.jacobian, row);
  expectEqualFields<FeatureField<TactileJacobianView>>(jacobianFeatures(), alone.ground_truth.jacobian, batch.ground_truth.jacobian, row);
  expectEqualFields<FeatureField<CleanTactileJacobianView>>(wrenchJacobian(), alone.ground_truth.jacobian, batch.ground_truth.jacobian,
                                                            row);
}

// Six sensors, eight objects in the slots of each: features, regions and Jacobians of a sensor are those that it has alone with its
// objects.
TEST(HandOfDifferentSensors, FeaturesRegionsAndJacobiansAreThoseOfEachAlone) {
  const std::vector<RobotSensor> sensors = differentSensors();
  const std::vector<Press> all = presses();
  std::vector<Object> objects;
  for (const Press& press : all) objects.push_back(press.object);
  constexpr int kInstances = 2;
  SensedRobots robots(device(), openHand(), sensors, objects,
                      {.num_instances = kInstances, .outputs = kAllOutputs, .max_regions = kMostRegions});
  // Instance 0 touches nothing.
  std::vector<Pose> X_WO(kInstances * all.size(), Pose{{10, 10, 10}, {1, 0, 0, 0}});
  for (std::size_t k = 0; k < all.size(); ++k) {
    X_WO[all.size() + k] = robots.robots().X_WS()[sensors.size() + static_cast<std::size_t>(all[k].sensor)] * all[k].X_SO;
  }
  robots.step(kStep, X_WO);
  for (std::size_t s = 0; s < sensors.size(); ++s) {
    SCOPED_TRACE(sensors[s].sensor.name);
    std::vector<Object> own;
    std::vector<Pose> X_SO;
    std::vector<int> ids;
    for (std::size_t k = 0; k < all.size(); ++k) {
      if (all[k].sensor != static_cast<int>(s)) continue;
      ids.push_back(static_cast<int>(own.size()));
      own.push_back(all[k].object);
      X_SO.push_back(inverse(robots.robots().X_WS()[sensors.size() + s]) * X_WO[all.size() + k]);
    }
    Simulator alone(Model(device(), {.sensor = sensors[s].sensor, .objects = own}),
                    {.num_slots = static_cast<int>(own.size()), .outputs = kAllOutputs, .max_regions = kMostRegions});
    alone.setObjects(ids, X_SO);
    alone.step(kStep);
    const FrameView expected = alone.read();
    EXPECT_GT(expected.total_force[0], 0.05);  // N
    EXPECT_EQ(expected.ground_truth.contact.num_regions[0], static_cast<int>(own.size()));
    const FrameView& found = robots.frame(static_cast<int>(s));
    expectEqualFeatures(expected, found, robots.row(static_cast<int>(s), 1));
    EXPECT_EQ(found.total_force[robots.row(static_cast<int>(s), 0)], 0);
  }
}

// Two balls of 6 mm radius in two slots of a WTS 0614, 27 mm apart along y: too far for the point spread to join their images.
constexpr double kRadius = 0.006, kApart = 0.0136;  // m
const Object kBall{Sphere{kRadius}};

const Sensor& padSensor() {
  static const Sensor sensor = loadSensor(kScenes / "sensors/wts0614_soft_cover.yaml");
  return sensor;
}

// Pose in W of a ball that is `depth` deep in the skin at the start; side: -1 or 1.
Pose ballAt(int side, double depth) {
  return {{0.0005 * side, side * kApart, kRadius - depth}, {1, 0, 0, 0}};
}

class TwoBalls {
 public:
  TwoBalls()
      : simulator_(Model(device(), {.sensor = padSensor(), .objects = {kBall, kBall}}),
                   {.num_slots = 2, .outputs = kAllOutputs, .max_regions = kMostRegions}) {}

  FrameView frame(const Pose& X_WS, const std::vector<int>& ids, const std::vector<Pose>& X_WO) {
    std::vector<Pose> X_SO;
    for (const Pose& pose : X_WO) X_SO.push_back(inverse(X_WS) * pose);
    simulator_.setObjects(ids, X_SO);
    simulator_.step(kStep);
    return simulator_.read();
  }

 private:
  Simulator simulator_;
};

// Rows of contact features: the sensor, its patch, its regions.
constexpr std::size_t kFirstRegion = 2;

TEST(TwoContacts, AreTwoRegionsWithTheForceAndTheCentreThatEachHasAlone) {
  constexpr double kForceRounding = 84 * 0x1p-24;  // relative, of a sum of float32
  constexpr double kPlaceRounding = 1e-8;          // m, of a centre below 24 mm in float32
  const std::vector<Pose> X_WO{ballAt(-1, 4e-4), ballAt(1, 6e-4)};
  TwoBalls balls;
  std::vector<double> force, center_y, sum, moment;  // sum, moment: with the taxels below the trigger, which are in no region
  for (const std::vector<int>& ids : {std::vector{kNoObject, 1}, std::vector{0, kNoObject}}) {
    const FrameView one = balls.frame({}, ids, X_WO);
    EXPECT_EQ(one.ground_truth.contact.num_regions[0], 1);
    force.push_back(one.ground_truth.contact.total_force[kFirstRegion]);
    center_y.push_back(one.ground_truth.contact.center_of_pressure[3 * kFirstRegion + 1]);
    sum.push_back(one.ground_truth.total_force[0]);
    moment.push_back(sum.back() * one.ground_truth.center_of_pressure[1]);
  }
  EXPECT_GT(force[0], 1.5 * force[1]);  // a ball's force grows with the square of its depth
  const FrameView both = balls.frame({}, {0, 1}, X_WO);
  const ContactFeatureView& contact = both.ground_truth.contact;
  EXPECT_EQ(contact.num_regions[0], 2);
  for (std::size_t k = 0; k < 2; ++k) {  // the larger one first
    EXPECT_NEAR(contact.total_force[kFirstRegion + k], force[k], force[k] * kForceRounding);
    EXPECT_NEAR(contact.center_of_pressure[3 * (kFirstRegion + k) + 1], center_y[k], kPlaceRounding);
    EXPECT_NEAR(center_y[k], k == 0 ? kApart : -kApart, 0.0034 / 2);  // half a taxel
  }
  EXPECT_EQ(contact.total_force[kFirstRegion + 2], 0);
  EXPECT_NEAR(contact.total_force[0], sum[0] + sum[1], (sum[0] + sum[1]) * kForceRounding);
  EXPECT_NEAR(contact.center_of_pressure[1], (moment[0] + moment[1]) / (sum[0] + sum[1]), kPlaceRounding);
  // The line through both contacts is the edge of the whole.
  EXPECT_NEAR(std::abs(contact.edge_angle[0]), std::atan2(2 * kApart, 0.001), 0.01);
}

// The servo moves the sensor until its features are at their references. Returns the last frame.
FrameView servoed(TwoBalls& balls, const TactileServo& servo, const std::vector<Pose>& X_WO) {
  constexpr int kSteps = 600;  // 6 s: gains of 2 / s leave 6e-6 of an error
  TactileServoController controller(servo, padSensor(), 1);
  const std::uint8_t due = 1;
  const float start_force = 0;
  Pose X_WS;
  FrameView frame = balls.frame(X_WS, {0, 1}, X_WO);
  for (int step = 0; step < kSteps; ++step) {
    ServoInput input = featuresOfSensor(frame, 1, 0, needsContactFeatures(servo));
    input.start_force = {&start_force, 1};
    input.due = {&due, 1};
    Twist twist;
    controller.command(input, kStep, {&twist, 1});
    X_WS = integrate(X_WS, twist, kStep);
    frame = balls.frame(X_WS, {0, 1}, X_WO);
  }
  return frame;
}

// N: some 30 taxels are in contact, each off by at most a count. Two that lie alike to a ball can cross their trigger of 0.02 N together.
constexpr double kReading = 30.0 / 2400 + 2 * 0.02;

TEST(TwoContacts, TheServoHoldsTheLargestRegion) {
  TactileServo servo{.contact = ServoContact::kLargestRegion};
  servo[ServoFeature::kTotalForce] = {.selected = true, .reference = 1.5, .kp = 2};
  servo[ServoFeature::kCenterY] = {.selected = true, .reference = 0.0102, .kp = 2};
  TwoBalls balls;
  const FrameView frame = servoed(balls, servo, {ballAt(-1, 4e-4), ballAt(1, 6e-4)});
  EXPECT_NEAR(frame.contact.total_force[kFirstRegion], 1.5, kReading);
  EXPECT_NEAR(frame.contact.center_of_pressure[3 * kFirstRegion + 1], 0.0102, 1e-4);  // m
  // The other contact moved with the sensor and presses as it must, less deep than the first.
  EXPECT_EQ(frame.contact.num_regions[0], 2);
  EXPECT_NEAR(frame.contact.center_of_pressure[3 * kFirstRegion + 4], 0.0102 - 2 * kApart, 0.0034 / 2);
  EXPECT_GT(frame.contact.total_force[kFirstRegion + 1], 0.2);
  EXPECT_LT(frame.contact.total_force[kFirstRegion + 1], 1.2);
}

// Both contacts at once: the whole force by moving along z, the common centre by rotation. Both balls then press with half of the force.
TEST(TwoContacts, TheServoHoldsBothAndSharesTheForce) {
  TactileServo servo{.jacobian = TactileJacobianSource::kMeasured};
  servo[ServoFeature::kTotalForce] = {.selected = true, .reference = 3, .kp = 2};
  servo[ServoFeature::kCenterY] = {.selected = true, .reference = 0, .kp = 2, .rolling_radius = 0.1};
  TwoBalls balls;
  const std::vector<Pose> X_WO{ballAt(-1, 3e-4), ballAt(1, 7e-4)};
  const FrameView before = balls.frame({}, {0, 1}, X_WO);
  EXPECT_GT(before.contact.total_force[kFirstRegion], 2 * before.contact.total_force[kFirstRegion + 1]);
  const FrameView frame = servoed(balls, servo, X_WO);
  EXPECT_NEAR(frame.contact.total_force[0], 3, 2 * kReading);
  // Forces are as the lever arms of the two contacts, whose centres are known to half a taxel of 3.4 mm in 13.6 mm: within 1 / 8.
  for (std::size_t k = 0; k < 2; ++k) EXPECT_NEAR(frame.contact.total_force[kFirstRegion + k], 1.5, 1.5 / 8) << k;
  EXPECT_NEAR(frame.contact.center_of_pressure[1], 0, 1e-4);  // m
}

}  // namespace
}  // namespace taxelsim
