// Contact features of objects whose position, edge angle, type and tilt are known.
#include "base/vector3.h"
#include "simulation/comparison.h"
#include "simulation/contact_feature_images.h"
#include "simulation/contact_feature_rows.h"
#include "support/contact_cases.h"
#include "support/random_scene.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using support::ContactCase;
using support::kContactFeatures;
using support::kImageStep;
using support::kSum;
using support::Random;
using support::Row;
using support::Touch;

TEST(ContactFeaturesOnEveryDriver, SeparatesTwoObjects) {
  const Sensor sensor = support::wts0614();
  Simulator simulator = support::makeSimulator(sensor, {Object(Cylinder{4e-3, 8e-3}), Object(Sphere{6e-3})},
                                               {.num_slots = 2, .outputs = {.contact_features = true}, .max_regions = 3});
  // An edge along x at y = -15 mm, a ball at y = 14 mm.
  const Quaternion along_x = axisAngle({0, 1, 0}, std::numbers::pi / 2);
  const Touch touch{{0, 1}, {{{2e-3, -15e-3, 4e-3 - 0.6e-3}, along_x}, {{-1e-3, 14e-3, 6e-3 - 0.5e-3}}}};
  const FrameView frame = support::stepOnce(simulator, {touch}, kImageStep);
  ASSERT_EQ(frame.contact.num_regions[0], 2);
  const Row edge(frame.contact, 0, 2), ball(frame.contact, 0, 3);
  // Taxels reach 1.7 mm beyond the contact; the trigger reduces this a little.
  EXPECT_NEAR(edge(frame.contact.center_of_pressure, 3, 0), 2e-3, 0.3e-3);
  EXPECT_NEAR(edge(frame.contact.center_of_pressure, 3, 1), -15e-3, 0.3e-3);
  EXPECT_NEAR(ball(frame.contact.center_of_pressure, 3, 0), -1e-3, 0.3e-3);
  EXPECT_NEAR(ball(frame.contact.center_of_pressure, 3, 1), 14e-3, 0.3e-3);
  EXPECT_EQ(ball(frame.contact.contact_type), ContactType::kPoint);
  EXPECT_NEAR(edge(frame.contact.edge_angle), 0, 0.05);
  EXPECT_NEAR(edge(frame.contact.total_force) + ball(frame.contact.total_force), frame.total_force[0], kSum * frame.total_force[0]);
}

// Measures all contacts as one batch with the noise of the sensor.
FrameView runCases(Simulator& simulator, const std::vector<ContactCase>& cases) {
  std::vector<Touch> touches;
  for (std::size_t i = 0; i < cases.size(); ++i) touches.push_back({{static_cast<int>(i)}, {cases[i].X_SO}});
  support::setTouches(simulator, touches);
  for (std::size_t i = 0; i < cases.size(); ++i) simulator.reset(static_cast<int>(i), i, {.noise = support::kWtsNoise});
  return support::stepOnce(simulator, kImageStep);
}

Model modelOf(const Sensor& sensor, const std::vector<ContactCase>& cases) {
  ModelOptions options{.sensor = sensor, .objects = {}};
  for (const ContactCase& contact : cases) options.objects.push_back(contact.object);
  return {support::sharedDevice(), options};
}

TEST(ContactFeaturesOnEveryDriver, WindowFindsTheAngleOfACutOffEdge) {
  Random random(1);
  std::vector<ContactCase> cases;
  for (int draw = 0; draw < 600; ++draw) cases.push_back(support::randomEdge(random));
  Simulator simulator(modelOf(support::wts0614(), cases), {.num_instances = 600, .outputs = {.contact_features = true}});
  const FrameView frame = runCases(simulator, cases);
  support::AngleErrors plain, windowed;
  for (int i = 0; i < 600; ++i) {
    plain.add(frame.edge_angle[i], cases[i].angle);
    windowed.add(Row(frame.contact, i, 0)(frame.contact.windowed_edge_angle), cases[i].angle);
  }
  support::expectWindowHelps(plain, windowed);
}

TEST(ContactFeaturesOnEveryDriver, ClassifiesRandomContacts) {
  Random random(2);
  std::vector<ContactCase> cases;
  for (int draw = 0; draw < 120; ++draw) {
    cases.push_back(support::randomSphere(random));
    cases.push_back(support::randomEdge(random));
    cases.push_back(support::randomPlate(random));
  }
  const int n = static_cast<int>(cases.size());
  Simulator simulator(modelOf(support::wts0614(), cases),
                      {.num_instances = n, .outputs = {.contact_features = true, .clean_contact_features = true}, .max_regions = 1});
  const FrameView frame = runCases(simulator, cases);
  for (int i = 0; i < n; ++i) {
    const ContactType expected = cases[i].type;
    EXPECT_EQ(Row(frame.contact, i, 2)(frame.contact.contact_type), expected) << cases[i].object.name;
    EXPECT_EQ(Row(frame.ground_truth.contact, i, 0)(frame.ground_truth.contact.contact_type), expected) << cases[i].object.name;
  }
}

// Arrays more than twice as long as wide: one patch, two patches, a list of taxels, turned against the axes of S.
TEST(ContactFeaturesOnEveryDriver, FaceOverTheWholeArrayIsAnArea) {
  const Quaternion turned = axisAngle({0, 0, 1}, 0.4);
  const Sensor grid = support::wts0614();
  Sensor patches = support::gridSensor({.num_rows = 4, .num_cols = 10}), list = support::gridSensor({.num_rows = 3, .num_cols = 9});
  patches.readout.curve = list.readout.curve = {2400};
  patches.patches.push_back(patches.patches[0]);
  patches.patches[0].X_SP.rotation = turned;
  patches.patches[1].X_SP = {rotate(turned, {0, 40e-3, 0}), turned};
  const std::vector<Vector3> positions = taxelPositions(list);
  list.patches.clear();
  for (const Vector3& p : positions) list.patches.push_back(taxelPatch("", rotate(turned, p), {0, 0, 1}, {3.4e-3, 3.4e-3}));
  for (const Sensor& sensor : {grid, patches, list}) {
    Simulator simulator = support::makeSimulator(sensor, {Object(HalfSpace{}), Object(Cylinder{2e-3, 0.1})},
                                                 {.num_instances = 2, .outputs = kContactFeatures, .max_regions = 1});
    const Quaternion along_y = axisAngle({1, 0, 0}, std::numbers::pi / 2);
    const Quaternion& yaw = &sensor == &grid ? Quaternion{} : turned;
    const FrameView frame =
        support::stepOnce(simulator, {{{0}, {{{0, 0, -0.4e-3}}}}, {{1}, {{{0, 0, 2e-3 - 0.4e-3}, yaw * along_y}}}}, kImageStep);
    for (const ContactFeatureView* view : {&frame.contact, &frame.ground_truth.contact}) {
      for (int row = 0; row < view->num_rows; ++row) {
        EXPECT_EQ(Row(*view, 0, row)(view->contact_type), ContactType::kArea) << row;
        EXPECT_EQ(Row(*view, 1, row)(view->contact_type), ContactType::kEdge) << row;
      }
    }
    support::expectFrame(frame, sensor, 2);
  }
}

TEST(ContactFeaturesOnEveryDriver, FindsTheTiltOfAPunch) {
  Random random(7);
  const Sensor sensor = support::gridSensor({.num_rows = 14, .num_cols = 16, .pitch_x = 1.5e-3, .pitch_y = 2e-3, .thickness = 2e-3});
  constexpr int kNumInstances = 40;
  std::vector<support::TiltedPunch> punches;
  ModelOptions options{.sensor = sensor, .objects = {}};
  std::vector<Touch> touches;
  for (int i = 0; i < kNumInstances; ++i) {
    punches.push_back(support::randomPunch(random, 12e-3));
    options.objects.push_back(punches.back().object);
    touches.push_back({{i}, {punches.back().X_SO}});
  }
  Simulator simulator(Model(support::sharedDevice(), options),
                      {.num_instances = kNumInstances, .outputs = kContactFeatures, .max_regions = 1});
  const ContactFeatureView& contact = support::stepOnce(simulator, touches, kImageStep).ground_truth.contact;
  // Depths have the error of float32 transforms, over a core of at least three taxels of 1.5 mm.
  constexpr double kSlack = support::kMarginZ / 1.5e-3;
  for (int i = 0; i < kNumInstances; ++i) {
    for (const int number : {0, 1, 2}) {
      const Row row(contact, i, number);
      for (std::size_t axis = 0; axis < 2; ++axis) EXPECT_NEAR(row(contact.tilt, 2, axis), punches[i].tilt[axis], kSlack) << i;
      EXPECT_GT(row(contact.tilt_confidence), 0.99);
    }
  }
}

}  // namespace
}  // namespace taxelsim
