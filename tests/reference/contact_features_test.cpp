// Regions, windowed edge angle, tilt and contact type: hand-made images, closed forms, and statistics over seeded random contacts.
#include "reference/contact_features.h"

#include "reference/frame.h"
#include "sensor/regions.h"
#include "support/contact_cases.h"
#include "support/random_scene.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using reference::ContactFeatures;
using reference::ContactRows;
using support::ContactCase;
using support::gridSensor;
using support::Random;

constexpr double kPi = std::numbers::pi;
constexpr double kPitch = 2e-3;  // m
constexpr double kRounding = 1e-12;

ContactRows cleanRows(const Sensor& sensor, const std::vector<double>& force) {
  return reference::contactFeatures(sensor, reference::cleanContactImage(sensor, force));
}

Sensor square(int rows, int cols) {
  return gridSensor({.num_rows = rows, .num_cols = cols, .pitch_x = kPitch, .pitch_y = kPitch});
}

// Force image from a string of digits, one taxel each, N.
std::vector<double> imageOf(const char* text) {
  std::vector<double> force;
  for (; *text; ++text) {
    if (*text != '\n') force.push_back(*text - '0');
  }
  return force;
}

std::vector<std::vector<int>> taxelsOf(const ContactRows& rows) {
  std::vector<std::vector<int>> regions;
  for (const ContactFeatures& region : rows.regions) regions.push_back(region.taxels);
  return regions;
}

TEST(ContactFeatures, RegionsAreEightConnectedAndSortedByForce) {
  const ContactRows rows = cleanRows(square(4, 5), imageOf("10002"
                                                           "01000"
                                                           "00003"
                                                           "90000"));
  EXPECT_EQ(taxelsOf(rows), (std::vector<std::vector<int>>{{15}, {14}, {0, 6}, {4}}));
  EXPECT_NEAR(rows.regions[2].total_force, 2, kRounding);
  EXPECT_NEAR(rows.regions[2].edge_angle, kPi / 4, kRounding);
  EXPECT_NEAR(rows.regions[2].center_of_pressure[0], -kPitch, kRounding);
  EXPECT_NEAR(rows.regions[2].contact_area, 2 * kPitch * kPitch, kRounding);
  EXPECT_EQ(rows.regions[2].patch, 0);
  EXPECT_NEAR(rows.sensor.total_force, 16, kRounding);
}

TEST(ContactFeatures, RegionsOfEqualForceAreSortedByLowestTaxel) {
  const ContactRows rows = cleanRows(square(3, 5), imageOf("00202"
                                                           "10000"
                                                           "10202"));
  EXPECT_EQ(taxelsOf(rows), (std::vector<std::vector<int>>{{2}, {4}, {5, 10}, {12}, {14}}));
}

TEST(ContactFeatures, RegionsDoNotCrossPatches) {
  Sensor sensor = square(2, 2);
  support::addPatch(sensor, {.position = {2 * kPitch, 0, 0}});
  const ContactRows rows = cleanRows(sensor, imageOf("0011"
                                                     "1100"));
  ASSERT_EQ(taxelsOf(rows), (std::vector<std::vector<int>>{{2, 3}, {4, 5}}));
  EXPECT_EQ(rows.regions[1].patch, 1);
  EXPECT_EQ(rows.sensor.patch, -1);
  ASSERT_EQ(rows.patches.size(), 2u);
  EXPECT_NEAR(rows.patches[1].center_of_pressure[0], 1.5 * kPitch, kRounding);
}

TEST(ContactFeatures, TaxelListHasRegionsOfTheEquivalentGrid) {
  const Sensor grid = square(5, 6);
  Sensor list = grid;
  list.patches.clear();
  for (const Vector3& p : taxelPositions(grid)) list.patches.push_back(taxelPatch("t", p, {0, 0, 1}, {kPitch, kPitch}));
  Random random(3);
  for (int draw = 0; draw < 50; ++draw) {
    std::vector<double> force;
    for (int t = 0; t < 30; ++t) force.push_back(random.chance(0.4) ? random.uniform(0.1, 1) : 0);
    EXPECT_EQ(taxelsOf(cleanRows(list, force)), taxelsOf(cleanRows(grid, force)));
  }
  EXPECT_TRUE(cleanRows(list, std::vector<double>(30, 1)).patches.empty());
}

TEST(ContactFeatures, EmptyImageHasNoContact) {
  const ContactRows rows = cleanRows(square(3, 3), std::vector<double>(9, 0));
  EXPECT_TRUE(rows.regions.empty());
  EXPECT_EQ(rows.sensor.contact_type, ContactType::kNone);
  EXPECT_EQ(rows.sensor.windowed_edge_confidence, 0);
  EXPECT_EQ(rows.sensor.tilt_confidence, 0);
}

// The variance of the sampled, truncated kernel, which differs from sigma^2.
TEST(ContactFeatures, SpreadShapeHasVarianceOfTheKernel) {
  const SpreadShape shape = spreadShape(gaussianPsf(0.5, 3), {2.0, 3.0});
  const double w = std::exp(-2.0), variance = 2 * w / (1 + 2 * w);
  EXPECT_NEAR(variance, 0.21301, 1e-5);
  EXPECT_NEAR(shape.moments[0], 4 * variance, kRounding);
  EXPECT_NEAR(shape.moments[1], 0, kRounding);
  EXPECT_NEAR(shape.moments[2], 9 * variance, kRounding);
  EXPECT_EQ(shape.radius, 1);
  EXPECT_EQ(shape.sum, 1);
  EXPECT_NEAR(spreadShape(gaussianPsf(0.5, 3, Psf::Normalization::kNone), {2.0, 3.0}).sum, 1.0279, 1e-4);
  EXPECT_EQ(spreadShape({}, {2.0, 3.0}).radius, 0);
}

// The window starts halfway between two distant contacts, where there is no force.
TEST(ContactFeatures, WindowWithoutForceHasNoAngle) {
  std::vector<double> force(40, 0);
  force[0] = force[1] = force[38] = force[39] = 1;
  const ContactRows rows = cleanRows(square(1, 40), force);
  EXPECT_EQ(rows.sensor.windowed_edge_confidence, 0);
  EXPECT_NEAR(rows.regions[0].windowed_edge_confidence, 1, kRounding);
  EXPECT_NEAR(rows.regions[0].windowed_edge_angle, kPi / 2, kRounding);
}

// Gaussian noise per taxel, counts (Box-Muller).
std::vector<double> whiteNoise(Random& random, int num_taxels, double deviation) {
  std::vector<double> noise;
  for (int t = 0; t < num_taxels; ++t) {
    const double radius = std::sqrt(-2 * std::log(1 - random.uniform()));
    noise.push_back(deviation * radius * std::cos(2 * kPi * random.uniform()));
  }
  return noise;
}

ContactRows measuredRows(const Sensor& sensor, const ContactCase& contact, double noise, Random& random) {
  const reference::Frame frame = reference::simulateFrame(
      sensor, {.objects = {{&contact.object, contact.X_SO}}, .draw = {.noise = whiteNoise(random, numTaxels(sensor), noise)}});
  return reference::contactFeatures(sensor, reference::measuredContactImage(sensor, frame.counts, noise));
}

TEST(ContactFeatures, WindowedAngleIsMoreAccurateOnTruncatedEdges) {
  const Sensor sensor = support::wts0614();
  Random random(1);
  support::AngleErrors plain, windowed;
  for (int draw = 0; draw < 600; ++draw) {
    const ContactCase contact = support::randomEdge(random);
    const ContactFeatures row = measuredRows(sensor, contact, support::kWtsNoise, random).sensor;
    plain.add(row.edge_angle, contact.angle);
    windowed.add(row.windowed_edge_angle, contact.angle);
  }
  support::expectWindowHelps(plain, windowed);
}

TEST(ContactFeatures, ClassifiesRandomContacts) {
  const Sensor sensor = support::wts0614();
  Random random(2);
  int num_wrong = 0;
  constexpr int kNumDraws = 200;
  for (int draw = 0; draw < kNumDraws; ++draw) {
    for (const ContactCase& contact : {support::randomSphere(random), support::randomEdge(random), support::randomPlate(random)}) {
      // With noise a distant taxel may report. That changes the moments of the whole image, not those of the contact region.
      const ContactFeatures whole = measuredRows(sensor, contact, 0, random).sensor;
      const ContactFeatures region = measuredRows(sensor, contact, support::kWtsNoise, random).regions[0];
      for (const ContactFeatures& row : {whole, region}) {
        num_wrong += row.contact_type != contact.type;
        EXPECT_EQ(static_cast<int>(row.contact_type), static_cast<int>(contact.type))
            << contact.object.name << " length " << row.length << " width " << row.width;
      }
    }
  }
  EXPECT_EQ(num_wrong, 0) << "of " << 6 * kNumDraws;
  std::vector<std::uint32_t> noise_only;
  for (const double value : whiteNoise(random, numTaxels(sensor), support::kWtsNoise)) {
    noise_only.push_back(value > 0 ? static_cast<std::uint32_t>(value) : 0);
  }
  Sensor without_trigger = sensor;
  without_trigger.readout.trigger = 0;
  const auto image = reference::measuredContactImage(without_trigger, noise_only, support::kWtsNoise);
  EXPECT_EQ(reference::contactFeatures(without_trigger, image).sensor.contact_type, ContactType::kNone);
}

// The array is more than twice as long as wide; the face ends where the array ends.
TEST(ContactFeatures, FaceOverTheWholeArrayIsAnArea) {
  const Object face{HalfSpace{}};
  Random random(6);
  Sensor tall = gridSensor({.num_rows = 14, .num_cols = 4});
  tall.readout.curve = {2400};
  for (const Sensor& sensor : {support::wts0614(), tall}) {
    for (const double tilt : {0.0, 0.002}) {
      const ContactCase contact{face, {{0, 0, -0.4e-3}, axisAngle({1, 1, 0}, tilt)}, ContactType::kArea};
      for (const double noise : {0.0, support::kWtsNoise}) {
        const ContactRows rows = measuredRows(sensor, contact, noise, random);
        for (const ContactFeatures& row : {rows.sensor, rows.patches[0], rows.regions[0]}) {
          EXPECT_EQ(row.contact_type, ContactType::kArea) << row.width << " of " << row.array_width;
        }
      }
    }
  }
}

TEST(ContactFeatures, FaceOverTwoPatchesOrAListIsAnArea) {
  Sensor patches = square(4, 12);
  patches.patches.push_back(patches.patches[0]);
  patches.patches[1].X_SP = {{1e-3, 24 * kPitch, 0}, axisAngle({0, 0, 1}, kPi)};
  Sensor list = square(4, 12);
  list.patches.clear();
  const Quaternion turned = axisAngle({0, 0, 1}, 0.4);
  for (const Vector3& p : taxelPositions(square(4, 12)))
    list.patches.push_back(taxelPatch("t", rotate(turned, p), {0, 0, 1}, {kPitch, kPitch}));
  for (const Sensor& sensor : {patches, list}) {
    const ContactRows rows = cleanRows(sensor, std::vector<double>(static_cast<std::size_t>(numTaxels(sensor)), 1));
    EXPECT_EQ(rows.sensor.contact_type, ContactType::kArea);
    EXPECT_EQ(rows.regions[0].contact_type, ContactType::kArea);
  }
}

TEST(ContactFeatures, BandNarrowerThanTheArrayIsAnEdge) {
  const auto type = [](int rows, const char* digits) { return cleanRows(square(rows, 14), imageOf(digits)).sensor.contact_type; };
  EXPECT_EQ(type(6,
                 "11111111111111"
                 "11111111111111"
                 "11111111111111"
                 "11111111111111"
                 "11111111111111"
                 "00000000000000"),
            ContactType::kEdge);
  EXPECT_EQ(type(6,
                 "00000000000000"
                 "00000000000000"
                 "11111111111111"
                 "11111111111111"
                 "00000000000000"
                 "00000000000000"),
            ContactType::kEdge);
  // Two rows do not show a width.
  EXPECT_EQ(type(2,
                 "11111111111111"
                 "11111111111111"),
            ContactType::kEdge);
}

// Without a PSF all taxels of the core are fully covered by the face, so their mean depth is linear in position.
TEST(ContactFeatures, TiltOfPunchIsExactWithoutSpread) {
  Random random(4);
  for (const double exponent : {1.0, 2.0}) {
    Sensor sensor = gridSensor({.num_rows = 14, .num_cols = 16, .pitch_x = 1.5e-3, .pitch_y = 2e-3, .thickness = 2e-3});
    sensor.skin.law = Winkler{1e8 * std::pow(1e3, exponent - 1), exponent, 0};
    for (int draw = 0; draw < 40; ++draw) {
      const support::TiltedPunch punch = support::randomPunch(random, 12e-3);
      const reference::Frame frame = reference::simulateFrame(sensor, {.objects = {{&punch.object, punch.X_SO}}});
      const ContactRows rows = cleanRows(sensor, frame.spread_force);
      ASSERT_GE(rows.sensor.core.size(), 12u);
      // Exponent 2: pressure is quadratic in position, and the slope is taken at the mean pressure. The even part has no slope; the mean of
      // depth^2 is the squared mean depth times 1 + v, with v <= 0.25 the relative variance of the depth.
      const double slack = exponent == 1 ? 1e-9 : 0.3;
      for (int axis = 0; axis < 2; ++axis) {
        EXPECT_NEAR(rows.sensor.tilt[axis], punch.tilt[axis], slack * std::hypot(punch.tilt[0], punch.tilt[1])) << axis;
      }
      EXPECT_GT(rows.sensor.tilt_confidence, exponent == 1 ? 1 - 1e-6 : 0.7);
      EXPECT_EQ(rows.regions[0].tilt, rows.sensor.tilt);
    }
  }
}

// With a PSF, taxels on the rim of the core receive less force through the outer row of the kernel, from neighbours that are partly
// covered.
TEST(ContactFeatures, TiltOfPunchIsAccurateWithSpread) {
  const Sensor sensor = support::wts0614();
  Random random(5);
  for (int draw = 0; draw < 60; ++draw) {
    const support::TiltedPunch punch = support::randomPunch(random, 19e-3);
    const reference::Frame frame = reference::simulateFrame(sensor, {.objects = {{&punch.object, punch.X_SO}}});
    const ContactFeatures row = reference::contactFeatures(sensor, reference::measuredContactImage(sensor, frame.counts)).sensor;
    ASSERT_FALSE(row.core.empty());
    for (int axis = 0; axis < 2; ++axis) {
      EXPECT_NEAR(row.tilt[axis], punch.tilt[axis], support::tiltSlack(sensor, row.core, punch.depth, axis)) << axis;
    }
    EXPECT_GT(row.tilt_confidence, 0.9) << row.core.size();
  }
}

TEST(ContactFeatures, TiltIsRightHanded) {
  const Sensor sensor = gridSensor({.num_rows = 8, .num_cols = 8});
  const Object face{HalfSpace{}};
  for (int axis = 0; axis < 2; ++axis) {
    const Vector3 about{axis == 0 ? 1.0 : 0.0, axis == 1 ? 1.0 : 0.0, 0};
    const Pose X_SO{{0, 0, -0.7e-3}, axisAngle(about, 0.02)};
    const ContactRows rows = cleanRows(sensor, reference::simulateFrame(sensor, {.objects = {{&face, X_SO}}}).spread_force);
    EXPECT_NEAR(rows.sensor.tilt[axis], 0.02, 1e-9);
    EXPECT_NEAR(rows.sensor.tilt[1 - axis], 0, 1e-9);
  }
}

TEST(ContactFeatures, RoundAndThinContactsHaveLowTiltConfidence) {
  const Sensor sensor = gridSensor({.num_rows = 12, .num_cols = 12, .pitch_x = 1e-3, .pitch_y = 1e-3});
  const Object sphere{Sphere{10e-3}}, edge{Cylinder{2e-3, 60e-3}};
  const auto confidence = [&](const Object& object, const Pose& X_SO) {
    return cleanRows(sensor, reference::simulateFrame(sensor, {.objects = {{&object, X_SO}}}).spread_force).sensor.tilt_confidence;
  };
  EXPECT_LT(confidence(sphere, {{0, 0, 10e-3 - 1e-3}}), 0.8);
  EXPECT_EQ(confidence(edge, {{0, 0, 2e-3 - 0.2e-3}, axisAngle({1, 0, 0}, kPi / 2)}), 0);
}

TEST(ContactFeatures, TiltIgnoresSaturatedTaxels) {
  Sensor sensor = gridSensor({.num_rows = 10, .num_cols = 10});
  sensor.readout = support::paperReadout();
  sensor.readout.trigger = 0;
  const Object face{HalfSpace{}};
  // Depth rises along x from 0.6 to 1.2 mm; a taxel saturates at 1.71 N, 0.85 mm.
  const double tilt = std::atan(0.6e-3 / (10 * 3.4e-3));
  const reference::Frame frame = reference::simulateFrame(sensor, {.objects = {{&face, {{0, 0, -0.9e-3}, axisAngle({0, 1, 0}, tilt)}}}});
  ASSERT_GT(frame.saturated, 0.2);
  const ContactFeatures row = reference::contactFeatures(sensor, reference::measuredContactImage(sensor, frame.counts)).sensor;
  EXPECT_NEAR(row.tilt[1], tilt, 2e-3 * tilt);  // counts are rounded
}

}  // namespace
}  // namespace taxelsim
