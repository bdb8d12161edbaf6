// Contact features on the device against the twin, over random images, sensors and workgroups, and regions against a flood fill.
#include "base/vector3.h"
#include "simulation/comparison.h"
#include "simulation/contact_feature_images.h"
#include "simulation/contact_feature_rows.h"
#include "support/cases.h"
#include "support/curved_sensor.h"
#include "support/random_scene.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using support::expectFrame;
using support::kContactFeatures;
using support::kImageStep;
using support::maxContacts;
using support::press;
using support::Random;
using support::randomImage;
using support::Row;

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
  // Larger teams are rarely what a software driver selects, and they compile slowly.
  const int workgroup = random.chance(0.7) ? 0 : smallest_workgroup << random.integer(0, 2);
  const Model model(support::sharedDevice(), {.sensor = sensor, .image_workgroup = workgroup});
  Simulator simulator(model, {.num_instances = num_instances,
                              .outputs = kContactFeatures,
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

INSTANTIATE_TEST_SUITE_P(OnEveryDriver, ContactFeatureSeeds, support::seeds(3, 6));

TEST(ContactFeaturesOnEveryDriver, SmallAndThinGridsMatchTheTwin) {
  Random random(5);
  for (const auto& [rows, cols] : {std::pair{1, 1}, {1, 2}, {2, 2}, {1, 128}, {128, 1}, {3, 100}}) {
    compareImages(random, support::gridSensor({.num_rows = rows, .num_cols = cols, .pitch_x = 1e-3, .pitch_y = 2e-3}), 5);
  }
}

TEST(ContactFeaturesOnEveryDriver, LargestGridsMatchTheTwin) {
  Random random(6);
  Sensor sensor = support::gridSensor({.num_rows = 128, .num_cols = 128, .pitch_x = 0.5e-3, .pitch_y = 0.5e-3, .samples_per_taxel = 1});
  constexpr int kSmallest = 64;  // fewer invocations would take too many turns each
  compareImages(random, sensor, 2, kSmallest);
  support::addPatch(sensor, {.position = {0.1, 0, 0}});
  sensor.psf = gaussianPsf(1, 3);
  compareImages(random, sensor, 2, kSmallest);
}

// All taxels in one region, and all of them in the core.
TEST(ContactFeaturesOnEveryDriver, FaceOverTheLargestGrid) {
  Sensor sensor = support::gridSensor({.num_rows = 128, .num_cols = 128, .pitch_x = 0.5e-3, .pitch_y = 0.5e-3, .samples_per_taxel = 1});
  sensor.readout.curve = {1e6};
  sensor.readout.adc_bits = 16;
  sensor.readout.curve_limit = 0;
  sensor.readout.saturation = 65535;
  for (const int workgroup : {0, 256}) {
    const Model model(support::sharedDevice(), {.sensor = sensor, .objects = {Object(HalfSpace{})}, .image_workgroup = workgroup});
    Simulator simulator(model, {.outputs = kContactFeatures, .max_regions = 8});
    const FrameView frame =
        support::stepOnce(simulator, {{{0}, {{.position = {0, 0, -0.7e-3}, .rotation = axisAngle({1, 0, 0}, 0.01)}}}}, kImageStep);
    expectFrame(frame, sensor, 1);
    EXPECT_NEAR(Row(frame.contact, 0, 2)(frame.contact.tilt, 2, 0), 0.01, 1e-4);
  }
}

// The core of three rows is one row, that of a diagonal band a line: float32 must find no slope across it.
TEST(ContactFeaturesOnEveryDriver, CoreOnARowHasNoTilt) {
  for (const auto& [rows, cols] : {std::pair{3, 20}, {20, 3}, {4, 20}}) {
    const Sensor sensor = support::gridSensor({.num_rows = rows, .num_cols = cols, .pitch_x = 1.3e-3, .pitch_y = 0.7e-3});
    std::vector<double> force;
    for (int t = 0; t < rows * cols; ++t) force.push_back(1 + 0.013 * t);
    const Model model(support::sharedDevice(), {.sensor = sensor});
    Simulator simulator(model, {.outputs = kContactFeatures, .max_contacts = maxContacts({force})});
    const FrameView frame = press(simulator, {force});
    expectFrame(frame, sensor, 1);
    EXPECT_EQ(frame.ground_truth.contact.tilt_confidence[0] > 0, rows == 4);
  }
}

TEST(ContactFeaturesOnEveryDriver, CoreOnADiagonalHasNoTilt) {
  constexpr int kSide = 128;
  const Sensor sensor = support::gridSensor({.num_rows = kSide, .num_cols = kSide, .pitch_x = 0.5e-3, .pitch_y = 0.5e-3});
  for (const int half_width : {2, 3}) {
    std::vector<double> force(kSide * kSide, 0);
    for (int i = 0; i < kSide; ++i) {
      for (int j = std::max(0, i - half_width); j <= std::min(kSide - 1, i + half_width); ++j)
        force[i * kSide + j] = 1 + 0.01 * i + 0.1 * j;
    }
    const Model model(support::sharedDevice(), {.sensor = sensor});
    Simulator simulator(model, {.outputs = kContactFeatures, .max_contacts = maxContacts({force})});
    const FrameView frame = press(simulator, {force});
    expectFrame(frame, sensor, 1);
    EXPECT_EQ(frame.ground_truth.contact.tilt_confidence[0] > 0, half_width == 3);
  }
}

// A spiral one taxel wide is the longest possible region. A PSF would close it.
TEST(ContactFeaturesOnEveryDriver, SpiralIsOneRegion) {
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
    Simulator simulator(model, {.outputs = kContactFeatures, .max_contacts = maxContacts({force}), .max_regions = 2});
    const FrameView frame = press(simulator, {force});
    EXPECT_EQ(frame.contact.num_regions[0], 1);
    expectFrame(frame, sensor, 1);
  }
}

// Compares with a flood fill over random images that nearly percolate.
TEST(ContactFeaturesOnEveryDriver, RegionsMatchAFloodFill) {
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
  Simulator simulator(model,
                      {.num_instances = kNumInstances, .outputs = kContactFeatures, .max_contacts = maxContacts(forces), .max_regions = 8});
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

TEST(ContactFeaturesOnEveryDriver, EqualRegionsAreSortedByLowestTaxel) {
  const Sensor sensor = support::gridSensor({.num_rows = 3, .num_cols = 15, .pitch_x = 1e-3, .pitch_y = 1e-3});
  std::vector<double> force(45, 0);
  for (const int t : {44, 30, 4, 26, 8}) force[t] = 1;
  for (const int workgroup : {0, 4}) {
    const Model model(support::sharedDevice(), {.sensor = sensor, .image_workgroup = workgroup});
    Simulator simulator(model, {.outputs = kContactFeatures, .max_contacts = 8, .max_regions = 4});
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

}  // namespace
}  // namespace taxelsim
