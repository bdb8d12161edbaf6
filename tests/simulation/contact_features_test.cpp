// Contact features on the device against the twin, over random images, sensors and workgroups; and what they promise of closed forms.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "base/vector3.h"
#include "simulation/comparison.h"
#include "simulation/contact_feature_rows.h"
#include "support/contact_cases.h"
#include "support/curved_sensor.h"
#include "support/random_scene.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

using support::ContactCase;
using support::expectFrame;
using support::extentOf;
using support::kSum;
using support::Random;
using support::Row;
using support::Touch;

constexpr double kDt = 0.01;  // s
constexpr OutputOptions kAll{.penetration_depth = false, .contact_features = true, .clean_contact_features = true};

// Images by contact points: at taxel centres, so that any image can be asked for.
FrameView press(Simulator& simulator, const std::vector<std::vector<double>>& forces) {
  const std::vector<Vector3> positions = taxelPositions(simulator.model().sensor());
  for (std::size_t i = 0; i < forces.size(); ++i) {
    std::vector<ContactPoint> contacts;
    for (std::size_t t = 0; t < forces[i].size(); ++t) {
      if (forces[i][t] > 0) contacts.push_back({positions[t], forces[i][t]});
    }
    simulator.setContacts(static_cast<int>(i), contacts);
  }
  simulator.step(kDt);
  return simulator.read();
}

int maxContacts(const std::vector<std::vector<double>>& forces) {
  std::size_t most = 1;
  for (const std::vector<double>& image : forces) {
    most = std::max(most, static_cast<std::size_t>(std::count_if(image.begin(), image.end(), [](double f) { return f > 0; })));
  }
  return static_cast<int>(most);
}

// Loose taxels, discs and lines, at the density asked for.
std::vector<double> randomImage(Random& random, const Sensor& sensor) {
  std::vector<double> force(static_cast<std::size_t>(numTaxels(sensor)), 0);
  if (random.chance(0.1)) return force;
  const double loose = random.chance(0.5) ? 0 : std::min(random.uniform(0, 0.7), 1200.0 / static_cast<double>(force.size()));
  for (double& f : force) {
    if (random.chance(loose)) f = random.uniform(0.05, 1);
  }
  const std::vector<Vector3> positions = taxelPositions(sensor);
  const double extent = extentOf(sensor);
  for (int discs = random.integer(0, 5); discs > 0; --discs) {
    const Vector3 middle = positions[static_cast<std::size_t>(random.integer(0, static_cast<int>(positions.size()) - 1))];
    const double radius = random.uniform(0.02, 0.3) * extent, across = random.chance(0.5) ? 1 : 8, height = random.uniform(0.1, 1);
    int num_left = 500;
    for (std::size_t t = 0; t < force.size(); ++t) {
      const Vector3 d = subtract(positions[t], middle);
      const double q = (d[0] * d[0] + across * d[1] * d[1] + d[2] * d[2]) / (radius * radius);
      if (q < 1 && num_left-- > 0) force[t] = height * (1.1 - q);
    }
  }
  return force;
}

Sensor withReadout(Random& random, Sensor sensor) {
  sensor.readout.adc_bits = 16;
  sensor.readout.curve_limit = 0;
  sensor.readout.saturation = random.chance(0.5) ? 65535 : 20000;
  sensor.readout.curve_points.clear();
  sensor.readout.curve = {30000};
  if (random.chance(0.5)) sensor.readout.curve = {20000, 5000, 3000};
  sensor.readout.trigger = random.chance(0.3) ? 0 : random.uniform(0, 0.15);
  sensor.readout.noise = random.chance(0.5) ? 0 : 50;
  Random other = random;  // what is drawn after this stays as it was
  if (other.chance(0.3)) {
    sensor.readout.curve = {1};
    sensor.readout.curve_points = {{0.2, 4000}, {0.5, 22000}, {0.9, 31000}};
  }
  return sensor;
}

void compareImages(Random& random, const Sensor& sensor, int num_instances, int smallest_workgroup = 4) {
  std::vector<std::vector<double>> forces;
  for (int i = 0; i < num_instances; ++i) forces.push_back(randomImage(random, sensor));
  // Teams of several invocations are seldom a software driver's own choice, and take it long to compile.
  const int workgroup = random.chance(0.7) ? 0 : smallest_workgroup << random.integer(0, 2);
  const Model model(support::sharedDevice(), {.sensor = sensor, .image_workgroup = workgroup});
  Simulator simulator(model, {.num_instances = num_instances,
                              .outputs = kAll,
                              .max_contacts = maxContacts(forces),
                              .max_regions = random.integer(0, kMaxRegions)});
  expectFrame(press(simulator, forces), sensor, num_instances);
}

class ContactFeatureSeeds : public ::testing::TestWithParam<int> {};

TEST_P(ContactFeatureSeeds, OneGrid) {
  Random random(GetParam());
  Sensor sensor = withReadout(random, support::randomSensor(random, {.max_rows = 20, .max_cols = 30, .max_kernel = 5}));
  compareImages(random, sensor, random.integer(1, 12));
}

TEST_P(ContactFeatureSeeds, SeveralPatches) {
  Random random(1000 + GetParam());
  compareImages(random, withReadout(random, support::randomSensor(random, {.max_patches = 4, .max_patch_tilt = 0.5, .max_kernel = 3})),
                random.integer(1, 9));
}

TEST_P(ContactFeatureSeeds, ListsOfTaxels) {
  Random random(2000 + GetParam());
  compareImages(random, withReadout(random, support::curvedSensor(random, GetParam())), random.integer(1, 9));
}

INSTANTIATE_TEST_SUITE_P(Random, ContactFeatureSeeds, ::testing::Range(0, 6));

TEST(ContactFeaturesOnDevice, SmallAndThinGrids) {
  Random random(5);
  for (const auto& [rows, cols] : {std::pair{1, 1}, {1, 2}, {2, 2}, {1, 128}, {128, 1}, {3, 100}}) {
    compareImages(random, support::gridSensor({.num_rows = rows, .num_cols = cols, .pitch_x = 1e-3, .pitch_y = 2e-3}), 5);
  }
}

TEST(ContactFeaturesOnDevice, LargestGrids) {
  Random random(6);
  Sensor sensor = support::gridSensor({.num_rows = 128, .num_cols = 128, .pitch_x = 0.5e-3, .pitch_y = 0.5e-3, .samples_per_taxel = 1});
  constexpr int kSmallest = 64;  // fewer invocations would take too many turns each
  compareImages(random, sensor, 2, kSmallest);
  sensor.patches.push_back(sensor.patches[0]);
  sensor.patches[1].X_SP.position = {0.1, 0, 0};
  sensor.psf = gaussianPsf(1, 3);
  compareImages(random, sensor, 2, kSmallest);
}

// All taxels in one region, and all of them in the core.
TEST(ContactFeaturesOnDevice, AFaceOverTheLargestGrid) {
  Sensor sensor = support::gridSensor({.num_rows = 128, .num_cols = 128, .pitch_x = 0.5e-3, .pitch_y = 0.5e-3, .samples_per_taxel = 1});
  sensor.readout.curve = {1e6};
  sensor.readout.adc_bits = 16;
  sensor.readout.curve_limit = 0;
  sensor.readout.saturation = 65535;
  for (const int workgroup : {0, 256}) {
    const Model model(support::sharedDevice(), {.sensor = sensor, .objects = {Object(HalfSpace{})}, .image_workgroup = workgroup});
    Simulator simulator(model, {.outputs = kAll, .max_regions = 8});
    support::setTouches(simulator, {{{0}, {{.position = {0, 0, -0.7e-3}, .rotation = axisAngle({1, 0, 0}, 0.01)}}}});
    simulator.step(kDt);
    const FrameView frame = simulator.read();
    expectFrame(frame, sensor, 1);
    EXPECT_NEAR(Row(frame.contact, 0, 2)(frame.contact.tilt, 2, 0), 0.01, 1e-4);
  }
}

// The core of three rows is one row, that of a band along the diagonal a line: float32 must not find a slope across it.
TEST(ContactFeaturesOnDevice, ACoreOnARowHasNoTilt) {
  for (const auto& [rows, cols] : {std::pair{3, 20}, {20, 3}, {4, 20}}) {
    const Sensor sensor = support::gridSensor({.num_rows = rows, .num_cols = cols, .pitch_x = 1.3e-3, .pitch_y = 0.7e-3});
    std::vector<double> force;
    for (int t = 0; t < rows * cols; ++t) force.push_back(1 + 0.013 * t);
    const Model model(support::sharedDevice(), {.sensor = sensor});
    Simulator simulator(model, {.outputs = kAll, .max_contacts = maxContacts({force})});
    const FrameView frame = press(simulator, {force});
    expectFrame(frame, sensor, 1);
    EXPECT_EQ(frame.ground_truth.contact.tilt_confidence[0] > 0, rows == 4);
  }
}

TEST(ContactFeaturesOnDevice, ACoreOnADiagonalHasNoTilt) {
  constexpr int kSide = 128;
  const Sensor sensor = support::gridSensor({.num_rows = kSide, .num_cols = kSide, .pitch_x = 0.5e-3, .pitch_y = 0.5e-3});
  for (const int half_width : {2, 3}) {
    std::vector<double> force(kSide * kSide, 0);
    for (int i = 0; i < kSide; ++i) {
      for (int j = std::max(0, i - half_width); j <= std::min(kSide - 1, i + half_width); ++j)
        force[i * kSide + j] = 1 + 0.01 * i + 0.1 * j;
    }
    const Model model(support::sharedDevice(), {.sensor = sensor});
    Simulator simulator(model, {.outputs = kAll, .max_contacts = maxContacts({force})});
    const FrameView frame = press(simulator, {force});
    expectFrame(frame, sensor, 1);
    EXPECT_EQ(frame.ground_truth.contact.tilt_confidence[0] > 0, half_width == 3);
  }
}

// A spiral one taxel wide is the longest region; the spread would close it.
TEST(ContactFeaturesOnDevice, ASpiralIsOneRegion) {
  constexpr int kSide = 63;
  const Sensor sensor = support::gridSensor({.num_rows = kSide, .num_cols = kSide, .pitch_x = 1e-3, .pitch_y = 1e-3});
  std::vector<double> force(kSide * kSide, 0);
  int i = 0, j = 0, step_i = 0, step_j = 1;
  const auto is_set = [&](int row, int col) { return row >= 0 && row < kSide && col >= 0 && col < kSide && force[row * kSide + col] > 0; };
  const auto is_outside = [&](int row, int col) { return row < 0 || row >= kSide || col < 0 || col >= kSide; };
  force[0] = 1;
  for (int turns = 0; turns < 2;) {
    if (is_outside(i + step_i, j + step_j) || is_set(i + 2 * step_i, j + 2 * step_j)) {
      std::swap(step_i, step_j);
      step_j = -step_j;
      ++turns;
      continue;
    }
    i += step_i, j += step_j;
    force[i * kSide + j] = 1;
    turns = 0;
  }
  ASSERT_GT(std::count(force.begin(), force.end(), 1.0), 1900);
  for (const int workgroup : {0, 4, 256}) {
    const Model model(support::sharedDevice(), {.sensor = sensor, .image_workgroup = workgroup});
    Simulator simulator(model, {.outputs = kAll, .max_contacts = maxContacts({force}), .max_regions = 2});
    const FrameView frame = press(simulator, {force});
    EXPECT_EQ(frame.contact.num_regions[0], 1);
    expectFrame(frame, sensor, 1);
  }
}

// A flood fill of the test's own, over random images that nearly percolate.
TEST(ContactFeaturesOnDevice, RegionsAreThoseOfAFlood) {
  constexpr int kRows = 30, kCols = 40, kNumInstances = 24;
  const Sensor sensor = support::gridSensor({.num_rows = kRows, .num_cols = kCols, .pitch_x = 1e-3, .pitch_y = 1e-3});
  Random random(8);
  std::vector<std::vector<double>> forces;
  for (int image = 0; image < kNumInstances; ++image) {
    const double density = random.uniform(0.2, 0.5);
    forces.emplace_back();
    for (int t = 0; t < kRows * kCols; ++t) forces.back().push_back(random.chance(density) ? random.integer(1, 9) : 0);
  }
  const Model model(support::sharedDevice(), {.sensor = sensor});
  Simulator simulator(model, {.num_instances = kNumInstances, .outputs = kAll, .max_contacts = maxContacts(forces), .max_regions = 8});
  const FrameView frame = press(simulator, forces);
  for (int image = 0; image < kNumInstances; ++image) {
    std::vector<double> left = forces[image];
    std::vector<double> sums;
    for (int start = 0; start < kRows * kCols; ++start) {
      std::vector<int> stack{start};
      double sum = 0;
      while (!stack.empty()) {
        const int t = stack.back();
        stack.pop_back();
        if (left[t] == 0) continue;
        sum += left[t];
        left[t] = 0;
        for (int i = t / kCols - 1; i <= t / kCols + 1; ++i) {
          for (int j = t % kCols - 1; j <= t % kCols + 1; ++j) {
            if (i >= 0 && i < kRows && j >= 0 && j < kCols) stack.push_back(i * kCols + j);
          }
        }
      }
      if (sum > 0) sums.push_back(sum);
    }
    std::stable_sort(sums.begin(), sums.end(), std::greater<>());
    EXPECT_EQ(frame.contact.num_regions[image], static_cast<int>(sums.size()));
    for (int r = 0; r < 8; ++r) {
      const double expected = r < static_cast<int>(sums.size()) ? sums[r] : 0;
      EXPECT_EQ(Row(frame.contact, image, 2 + r)(frame.contact.total_force), expected) << image << " region " << r;
    }
  }
}

TEST(ContactFeaturesOnDevice, OfEqualRegionsTheOneWithTheLowestTaxelIsFirst) {
  const Sensor sensor = support::gridSensor({.num_rows = 3, .num_cols = 15, .pitch_x = 1e-3, .pitch_y = 1e-3});
  std::vector<double> force(45, 0);
  for (const int t : {44, 30, 4, 26, 8}) force[t] = 1;
  for (const int workgroup : {0, 4}) {
    const Model model(support::sharedDevice(), {.sensor = sensor, .image_workgroup = workgroup});
    Simulator simulator(model, {.outputs = kAll, .max_contacts = 8, .max_regions = 4});
    const FrameView frame = press(simulator, {force});
    EXPECT_EQ(frame.contact.num_regions[0], 5);
    const std::vector<Vector3> positions = taxelPositions(sensor);
    int r = 0;
    for (const int t : {4, 8, 26, 30}) {
      const Row row(frame.contact, 0, 2 + r++);
      EXPECT_NEAR(row(frame.contact.center_of_pressure, 3, 1), positions[t][1], 1e-8);
    }
  }
}

TEST(ContactFeaturesOnDevice, TwoObjectsAreToldApart) {
  const Sensor sensor = support::wts0614();
  const Model model(support::sharedDevice(), {.sensor = sensor, .objects = {Object(Cylinder{4e-3, 8e-3}), Object(Sphere{6e-3})}});
  Simulator simulator(model, {.num_slots = 2, .outputs = {.contact_features = true}, .max_regions = 3});
  // An edge along x at y = -15 mm, a ball at y = 14 mm.
  const Quaternion along_x = axisAngle({0, 1, 0}, std::numbers::pi / 2);
  const Touch touch{{0, 1}, {{{2e-3, -15e-3, 4e-3 - 0.6e-3}, along_x}, {{-1e-3, 14e-3, 6e-3 - 0.5e-3}}}};
  support::setTouches(simulator, {touch});
  simulator.step(kDt);
  const FrameView frame = simulator.read();
  ASSERT_EQ(frame.contact.num_regions[0], 2);
  const Row edge(frame.contact, 0, 2), ball(frame.contact, 0, 3);
  // A taxel's rim reaches 1.7 mm past what touches; the trigger takes a little off.
  EXPECT_NEAR(edge(frame.contact.center_of_pressure, 3, 0), 2e-3, 0.3e-3);
  EXPECT_NEAR(edge(frame.contact.center_of_pressure, 3, 1), -15e-3, 0.3e-3);
  EXPECT_NEAR(ball(frame.contact.center_of_pressure, 3, 0), -1e-3, 0.3e-3);
  EXPECT_NEAR(ball(frame.contact.center_of_pressure, 3, 1), 14e-3, 0.3e-3);
  EXPECT_EQ(ball(frame.contact.contact_type), ContactType::kPoint);
  EXPECT_NEAR(edge(frame.contact.edge_angle), 0, 0.05);
  EXPECT_NEAR(edge(frame.contact.total_force) + ball(frame.contact.total_force), frame.total_force[0], kSum * frame.total_force[0]);
}

// The measured image of each contact, as one batch with the sensor's noise.
FrameView runCases(Simulator& simulator, const std::vector<ContactCase>& cases) {
  std::vector<Touch> touches;
  for (std::size_t i = 0; i < cases.size(); ++i) touches.push_back({{static_cast<int>(i)}, {cases[i].X_SO}});
  support::setTouches(simulator, touches);
  for (std::size_t i = 0; i < cases.size(); ++i) simulator.reset(static_cast<int>(i), i, {.noise = support::kWtsNoise});
  simulator.step(kDt);
  return simulator.read();
}

Model modelOf(const Sensor& sensor, const std::vector<ContactCase>& cases) {
  ModelOptions options{.sensor = sensor, .objects = {}};
  for (const ContactCase& contact : cases) options.objects.push_back(contact.object);
  return {support::sharedDevice(), options};
}

TEST(ContactFeaturesOnDevice, TheWindowFindsTheAngleOfAnEdgeThatTheArrayCutsOff) {
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

TEST(ContactFeaturesOnDevice, TypesOfRandomContacts) {
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

TEST(ContactFeaturesOnDevice, TiltOfAPunch) {
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
  Simulator simulator(Model(support::sharedDevice(), options), {.num_instances = kNumInstances, .outputs = kAll, .max_regions = 1});
  support::setTouches(simulator, touches);
  simulator.step(kDt);
  const ContactFeatureView& contact = simulator.read().ground_truth.contact;
  // Depths are off by the margin of float32 transforms, over a core of at least three taxels of 1.5 mm.
  constexpr double kSlack = support::kMarginZ / 1.5e-3;
  for (int i = 0; i < kNumInstances; ++i) {
    for (const int number : {0, 1, 2}) {
      const Row row(contact, i, number);
      for (std::size_t axis = 0; axis < 2; ++axis) EXPECT_NEAR(row(contact.tilt, 2, axis), punches[i].tilt[axis], kSlack) << i;
      EXPECT_GT(row(contact.tilt_confidence), 0.99);
    }
  }
}

// ---- what a batch promises ----

std::vector<std::uint32_t> bitsOf(const ContactFeatureView& view, int instance) {
  std::vector<std::uint32_t> bits{static_cast<std::uint32_t>(view.num_regions[instance])};
  for (const auto& [values, width] : std::vector<std::pair<std::span<const float>, std::size_t>>{{view.total_force, 1},
                                                                                                 {view.peak_force, 1},
                                                                                                 {view.center_of_pressure, 3},
                                                                                                 {view.second_moments, 3},
                                                                                                 {view.eigenvalues, 2},
                                                                                                 {view.edge_angle, 1},
                                                                                                 {view.edge_confidence, 1},
                                                                                                 {view.contact_area, 1},
                                                                                                 {view.windowed_edge_angle, 1},
                                                                                                 {view.windowed_edge_confidence, 1},
                                                                                                 {view.tilt, 2},
                                                                                                 {view.tilt_confidence, 1}}) {
    const std::size_t per_instance = static_cast<std::size_t>(view.num_rows) * width;
    for (const float value : values.subspan(static_cast<std::size_t>(instance) * per_instance, per_instance)) {
      bits.push_back(std::bit_cast<std::uint32_t>(value));
    }
  }
  for (std::size_t r = 0, row = static_cast<std::size_t>(instance * view.num_rows); r < static_cast<std::size_t>(view.num_rows);
       ++r, ++row) {
    bits.insert(bits.end(), {static_cast<std::uint32_t>(view.contact_type[row]), static_cast<std::uint32_t>(view.patch[row])});
  }
  return bits;
}

std::vector<std::vector<std::uint32_t>> bitsOfAll(const Model& model, const std::vector<std::vector<double>>& forces) {
  const int n = static_cast<int>(forces.size());
  Simulator simulator(model, {.num_instances = n, .outputs = kAll, .max_contacts = 3000, .max_regions = 5});
  const FrameView frame = press(simulator, forces);
  std::vector<std::vector<std::uint32_t>> bits;
  for (int i = 0; i < n; ++i) {
    bits.push_back(bitsOf(frame.contact, i));
    const std::vector<std::uint32_t> clean = bitsOf(frame.ground_truth.contact, i);
    bits.back().insert(bits.back().end(), clean.begin(), clean.end());
  }
  return bits;
}

TEST(ContactFeaturesOnDevice, BytesDependOnNeitherBatchNorWorkgroup) {
  Sensor sensor = support::gridSensor({.num_rows = 23, .num_cols = 31, .pitch_x = 1e-3, .pitch_y = 1e-3});
  sensor.patches.push_back(sensor.patches[0]);
  sensor.patches[1].X_SP = {{0.03, 0, 0}, axisAngle({0, 1, 0}, 0.1)};
  sensor.psf = gaussianPsf(0.6, 3);
  Random random(9);
  std::vector<std::vector<double>> forces;
  for (int i = 0; i < 11; ++i) forces.push_back(randomImage(random, sensor));
  const auto modelWith = [&](int workgroup) { return Model(support::sharedDevice(), {.sensor = sensor, .image_workgroup = workgroup}); };
  const Model model = modelWith(0);
  const auto expected = bitsOfAll(model, forces);
  for (const int workgroup : {4, 16, 256}) EXPECT_EQ(bitsOfAll(modelWith(workgroup), forces), expected) << workgroup;
  for (std::size_t i = 0; i < forces.size(); ++i) EXPECT_EQ(bitsOfAll(model, {forces[i]})[0], expected[i]) << i;
}

TEST(ContactFeaturesOnDevice, MeasuredOnesAreHeldBetweenTheSensorsFrames) {
  Sensor sensor = support::gridSensor();
  sensor.frame_rate = 50;
  const Model model(support::sharedDevice(), {.sensor = sensor, .objects = {Object(Sphere{0.005})}});
  Simulator simulator(model, {.outputs = kAll, .max_regions = 1});
  std::vector<std::vector<std::uint32_t>> measured, clean;
  for (const double depth : {0.5e-3, 0.7e-3, 0.9e-3}) {
    support::setTouches(simulator, {{{0}, {{.position = {0, 0, 0.005 - depth}}}}});
    simulator.step(0.01);
    const FrameView frame = simulator.read();
    measured.push_back(bitsOf(frame.contact, 0));
    clean.push_back(bitsOf(frame.ground_truth.contact, 0));
  }
  EXPECT_EQ(measured[0], measured[1]);
  EXPECT_NE(measured[1], measured[2]);
  EXPECT_NE(clean[0], clean[1]);
}

TEST(ContactFeaturesOnDevice, NothingComesUnlessAskedFor) {
  const Model model(support::sharedDevice(), {.sensor = support::gridSensor(), .objects = {Object(Sphere{0.005})}});
  Simulator without(model, {}), with(model, {.outputs = {.contact_features = true}});
  for (Simulator* simulator : {&without, &with}) {
    support::setTouches(*simulator, {{{0}, {{.position = {0, 0, 0.0045}}}}});
    simulator->step(kDt);
  }
  const FrameView a = without.read(), b = with.read();
  EXPECT_EQ(a.contact.num_rows, 0);
  EXPECT_TRUE(a.contact.total_force.empty());
  EXPECT_EQ(b.contact.num_rows, 2);
  EXPECT_EQ(b.contact.num_patches, 1);
  EXPECT_TRUE(b.ground_truth.contact.total_force.empty());
  FrameView rest = b;
  rest.contact = {};
  EXPECT_EQ(support::bitsOf(a, 0, 1), support::bitsOf(rest, 0, 1));
  EXPECT_GT(Simulator::plan(model, {.outputs = {.contact_features = true}}).bytes_per_instance,
            Simulator::plan(model, {}).bytes_per_instance);
}

TEST(ContactFeaturesOnDevice, MaxRegionsIsChecked) {
  const Model model(support::sharedDevice(), {.sensor = support::gridSensor(), .objects = {Object(Sphere{0.005})}});
  for (const SimulatorOptions& options : {SimulatorOptions{.outputs = kAll, .max_regions = -1},
                                          SimulatorOptions{.outputs = kAll, .max_regions = 9}, SimulatorOptions{.max_regions = 1}}) {
    try {
      Simulator simulator(model, options);
      ADD_FAILURE() << options.max_regions;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kInput);
      EXPECT_NE(std::string(error.what()).find("max_regions: " + std::to_string(options.max_regions)), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace taxelsim
