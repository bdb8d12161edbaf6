// Contact points of another engine: the device against the twin, and independence of the batch.
#include "reference/contact_points.h"
#include "reference/psf.h"
#include "simulation/comparison.h"
#include "support/cases.h"
#include "support/curved_sensor.h"
#include "support/random_scene.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using support::kUlp;
using support::Random;

constexpr double kDt = 1e-3;  // s
// A position within 0.1 m passes one float32 transform with about four roundings of at most 6e-9 m. Contacts closer than this to a border
// may fall on either side.
constexpr double kNear = 1e-7;  // m
constexpr OutputOptions kNoDepth{.penetration_depth = false};

using Contacts = std::vector<ContactPoint>;

// Whether a position is at least kNear from every border of a cell and of the band.
bool isClear(const Sensor& sensor, const Vector3& p, double band) {
  const std::optional<int> taxel = reference::taxelAt(sensor, p, band);
  for (int corner = 0; corner < 8; ++corner) {
    const Vector3 moved{p[0] + (corner & 1 ? kNear : -kNear), p[1] + (corner & 2 ? kNear : -kNear), p[2] + (corner & 4 ? kNear : -kNear)};
    if (reference::taxelAt(sensor, moved, band) != taxel) return false;
  }
  return true;
}

// Most contacts lie on a patch, half of the time in a cluster; the others lie off the array, above the band or below the skin.
Contacts randomContacts(Random& random, const Sensor& sensor, int num_contacts, double band) {
  Contacts contacts;
  const bool clump = random.chance(0.5);
  while (static_cast<int>(contacts.size()) < num_contacts) {
    const GridPatch& patch = sensor.patches[random.integer(0, static_cast<int>(sensor.patches.size()) - 1)];
    const double reach = clump ? 0.2 : 0.6;
    const double thickness = sensor.skin.thickness;
    const Vector3 p_PQ_P{random.uniform(-reach, reach) * patch.num_rows * patch.pitch[0],
                         random.uniform(-reach, reach) * patch.num_cols * patch.pitch[1],
                         random.uniform(-thickness - 0.1e-3, band + 0.1e-3)};
    const Vector3 position = patch.X_SP * p_PQ_P;
    if (!isClear(sensor, position, band)) continue;
    contacts.push_back({position, random.chance(0.05) ? 0 : random.uniform(0, 0.3)});
  }
  return contacts;
}

// The twin's frame as bounds for expectMatches(). `num_contacts` forces are added in float32, times their PSF weights.
support::FrameEnvelope envelopeOf(const Sensor& sensor, const reference::ContactSums& sums, std::size_t num_contacts) {
  const double relative = static_cast<double>(num_contacts + 4) * kUlp;
  support::FrameEnvelope envelope;
  envelope.spread_force.low = envelope.spread_force.high = reference::spread(sensor, sums.taxel_force);
  for (double& force : envelope.spread_force.low) force *= 1 - relative;
  for (double& force : envelope.spread_force.high) force *= 1 + relative;
  envelope.wrench = {{sums.wrench.begin(), sums.wrench.end()}, {sums.wrench.begin(), sums.wrench.end()}};
  envelope.over_penetration = {{0}, {0}};
  // The tolerance of the wrench is relative to this: the force and the rounding of the sum.
  envelope.total_low = sums.total_force;
  envelope.total_high = sums.total_force * (1 + static_cast<double>(num_contacts) / 64);
  return envelope;
}

void setAll(Simulator& simulator, const std::vector<Contacts>& batch) {
  Contacts contacts;
  std::vector<int> offsets{0};
  for (const Contacts& of_one : batch) {
    contacts.insert(contacts.end(), of_one.begin(), of_one.end());
    offsets.push_back(static_cast<int>(contacts.size()));
  }
  simulator.setContacts(contacts, offsets);
}

void expectSameAsTwin(const FrameView& frame, int instance, const Sensor& sensor, const Contacts& contacts, double band) {
  const reference::ContactSums sums = reference::sumContacts(sensor, contacts, band);
  support::expectMatches(frame, instance, sensor, envelopeOf(sensor, sums, contacts.size()));
  const GroundTruthView& truth = frame.ground_truth;
  EXPECT_EQ(truth.off_array_contacts[instance], sums.off_array_contacts);
  EXPECT_NEAR(truth.off_array_load[instance], sums.off_array_load, static_cast<double>(contacts.size() + 1) * kUlp * sums.off_array_load);
  EXPECT_EQ(truth.load_reached[instance], 1);
  EXPECT_TRUE(truth.penetration_depth.empty());
}

class ContactSeeds : public ::testing::TestWithParam<int> {};

void expectRandomContactsMatchTheTwin(Random& random, const Sensor& sensor) {
  const Model model(support::sharedDevice(), {.sensor = sensor, .image_workgroup = support::randomWorkgroup(random)});
  const double band = random.uniform(0, 0.5e-3);
  const int max_contacts = random.integer(1, 200), num_instances = random.integer(1, 20);
  Simulator simulator(model, {.num_instances = num_instances, .outputs = kNoDepth, .max_contacts = max_contacts, .contact_band = band});
  for (int step = 0; step < 2; ++step) {  // what the first left must not show in the second
    std::vector<Contacts> batch;
    for (int i = 0; i < num_instances; ++i) batch.push_back(randomContacts(random, sensor, random.integer(0, max_contacts), band));
    setAll(simulator, batch);
    const FrameView frame = support::stepOnce(simulator, kDt);
    for (int i = 0; i < num_instances; ++i) expectSameAsTwin(frame, i, sensor, batch[i], band);
  }
}

TEST_P(ContactSeeds, MatchTheTwin) {
  Random random(9000 + static_cast<std::uint64_t>(GetParam()));
  expectRandomContactsMatchTheTwin(
      random, support::randomSensor(random, {.max_patches = 1 + GetParam() % 4, .max_patch_tilt = GetParam() % 2 ? 0.5 : 0}));
}

TEST_P(ContactSeeds, MatchTheTwinWithPsfLists) {
  Random random(9500 + static_cast<std::uint64_t>(GetParam()));
  Sensor sensor = GetParam() % 4 < 3 ? support::curvedSensor(random, GetParam() % 4) : support::randomSensor(random);
  if (GetParam() % 4 == 3) sensor.psf = {.sigma = 0.7 * sensor.patches[0].pitch[0]};
  expectRandomContactsMatchTheTwin(random, sensor);
}

INSTANTIATE_TEST_SUITE_P(OnEveryDriver, ContactSeeds, support::seeds(4, 12));

// A flat list assigns contacts as its grid does; on a sphere each contact goes to the nearest taxel along the skin, and none is lost
// between two.
TEST(ContactsOnTaxels, GoToTheNearestTaxelAlongTheSkin) {
  Random random(17);
  const Sensor grid = support::gridSensor({.num_rows = 5, .num_cols = 7, .pitch_x = 2e-3, .pitch_y = 3e-3});
  Sensor list = grid;
  list.patches.clear();
  for (const Vector3& p : taxelPositions(grid)) list.patches.push_back(taxelPatch("t", p, {0, 0, 1}, grid.patches[0].pitch));
  for (int n = 0; n < 2000; ++n) {
    const Vector3 p{random.uniform(-4.9e-3, 4.9e-3), random.uniform(-10.4e-3, 10.4e-3), random.uniform(-1e-3, 0)};
    if (isClear(grid, p, 0)) {
      EXPECT_EQ(reference::taxelAt(list, p, 0), reference::taxelAt(grid, p, 0));
    }
  }
  constexpr double kRadius = 8e-3;
  const Sensor sphere = support::sphereFingertip(kRadius, 2, 1.3);
  const std::vector<Vector3> normals = taxelNormals(sphere);
  for (int n = 0; n < 2000; ++n) {
    const double lean = random.uniform(0, 1.1), around = random.uniform(-3.2, 3.2);
    const Vector3 out{std::sin(lean) * std::cos(around), std::sin(lean) * std::sin(around), std::cos(lean)};
    int nearest = 0;
    double largest = -1;
    for (std::size_t t = 0; t < normals.size(); ++t) {
      const double cosine = out[0] * normals[t][0] + out[1] * normals[t][1] + out[2] * normals[t][2];
      if (cosine > largest) largest = cosine, nearest = static_cast<int>(t);
    }
    const Vector3 p{kRadius * out[0], kRadius * out[1], kRadius * (out[2] - 1)};
    if (!isClear(sphere, p, 1e-6)) continue;
    EXPECT_EQ(reference::taxelAt(sphere, p, 1e-6), nearest);
  }
}

// 128 x 128 taxels in many tiles: the result is in the first tile.
TEST(ContactsOnEveryDriver, LargestSensorMatchesTheTwin) {
  Random random(3);
  const Sensor sensor =
      support::gridSensor({.num_rows = 128, .num_cols = 128, .pitch_x = 0.5e-3, .pitch_y = 0.5e-3, .samples_per_taxel = 8});
  const Model model(support::sharedDevice(), {.sensor = sensor});
  Simulator simulator(model, {.num_instances = 3, .outputs = kNoDepth, .max_contacts = kMaxContacts});
  std::vector<Contacts> batch;
  for (const int count : {kMaxContacts, 0, 10}) batch.push_back(randomContacts(random, sensor, count, 1e-4));
  setAll(simulator, batch);
  const FrameView frame = support::stepOnce(simulator, kDt);
  for (int i = 0; i < 3; ++i) expectSameAsTwin(frame, i, sensor, batch[i], 1e-4);
}

// Stages after the contact are bitwise equal to those of objects that press with the same force on every taxel.
TEST(ContactsOnDevice, LaterStagesEqualThoseOfObjects) {
  Random random(17);
  for (int trial = 0; trial < 4; ++trial) {
    Sensor sensor = support::gridSensor({.num_rows = 6, .num_cols = 14, .thickness = 2e-3});
    const std::vector<Object> objects{support::randomSolid(random, 0.01)};
    const Pose X_SO = support::randomContact(random, sensor, objects[0]);
    const auto press = [&] {
      const Model model(support::sharedDevice(), {.sensor = sensor, .objects = objects});
      auto simulator = std::make_unique<Simulator>(model, SimulatorOptions{.seed = 4});
      simulator->setObjects(std::vector<int>{0}, std::vector<Pose>{X_SO});
      simulator->step(kDt);
      return simulator;
    };
    // Without a PSF, a sensor reports the force on each taxel.
    const auto bare = press();
    const FrameView forces = bare->read();
    Contacts contacts;
    const std::vector<Vector3> positions = taxelPositions(sensor);
    for (std::size_t t = 0; t < positions.size(); ++t) contacts.push_back({positions[t], forces.ground_truth.tactile_normal_force[t]});

    sensor.psf = gaussianPsf(0.8, trial % 2 ? 3 : 5);
    sensor.readout = support::paperReadout();
    sensor.readout.noise = 5;
    const auto pressed = press();
    const FrameView expected = pressed->read();
    Simulator simulator(Model(support::sharedDevice(), {.sensor = sensor}), {.seed = 4, .outputs = kNoDepth, .max_contacts = 84});
    simulator.setContacts(0, contacts);
    const FrameView found = support::stepOnce(simulator, kDt);
    EXPECT_TRUE(std::ranges::equal(found.tactile_image, expected.tactile_image));
    EXPECT_TRUE(std::ranges::equal(found.ground_truth.tactile_normal_force, expected.ground_truth.tactile_normal_force));
    ASSERT_GT(expected.ground_truth.total_force[0], 0);
    EXPECT_NEAR(found.total_force[0], expected.total_force[0], support::kRelativeMoment * expected.total_force[0]);
    EXPECT_NEAR(found.ground_truth.contact_wrench[2], expected.ground_truth.contact_wrench[2],
                support::kRelativeMoment * expected.ground_truth.total_force[0]);
  }
}

std::vector<std::vector<std::uint32_t>> bitsOfBatch(const Model& model, const std::vector<Contacts>& batch, int max_contacts) {
  const int n = static_cast<int>(batch.size());
  Simulator simulator(model, {.num_instances = n, .seed = 7, .outputs = kNoDepth, .max_contacts = max_contacts});
  for (int i = 0; i < n; ++i) simulator.setContacts(i, batch[i]);
  return support::bitsOfAll(support::stepOnce(simulator, kDt), n);
}

TEST(ContactsOnEveryDriver, IndependentOfBatchAndWorkgroup) {
  Random random(31);
  // Enough taxels for several subgroups per instance.
  Sensor sensor = support::gridSensor({.num_rows = 40, .num_cols = 12, .pitch_x = 1e-3, .pitch_y = 2e-3});
  support::addPatch(sensor, {{0.045, 0, 0}, axisAngle({0, 1, 0}, 0.2)});
  sensor.psf = gaussianPsf(0.8, 5);
  sensor.readout = support::paperReadout();
  sensor.readout.noise = 2;
  std::vector<Contacts> batch;
  for (int i = 0; i < 21; ++i) batch.push_back(randomContacts(random, sensor, random.integer(0, 90), 1e-4));
  const Model model(support::sharedDevice(), {.sensor = sensor});
  const auto together = bitsOfBatch(model, batch, 90);
  EXPECT_NE(together[0], together[1]);
  EXPECT_EQ(together, bitsOfBatch(model, batch, 1000));
  for (const int instance : {0, 7, 20}) EXPECT_EQ(bitsOfBatch(model, {batch[instance]}, 90)[0], together[instance]);
  for (const int workgroup : {4, 8, 32, 256}) {
    const Model other(support::sharedDevice(), {.sensor = sensor, .image_workgroup = workgroup});
    EXPECT_EQ(bitsOfBatch(other, batch, 90), together) << workgroup;
  }
}

TEST(ContactsOnDevice, StayUntilTheyAreSetAgain) {
  const Sensor sensor = support::gridSensor();
  Simulator simulator(Model(support::sharedDevice(), {.sensor = sensor}), {.num_instances = 2, .outputs = kNoDepth, .max_contacts = 2});
  EXPECT_EQ(support::stepOnce(simulator, kDt).ground_truth.total_force[1], 0);  // none set: no contact
  simulator.setContacts(1, Contacts{{{0.001, 0.001, 0}, 1}, {{0.001, 0.001, 0}, 0.5}});
  for (int step = 0; step < 2; ++step) {
    const FrameView frame = support::stepOnce(simulator, kDt);
    EXPECT_EQ(frame.ground_truth.total_force[0], 0);
    EXPECT_EQ(frame.ground_truth.total_force[1], 1.5f);
    EXPECT_EQ(frame.ground_truth.contact_wrench[6 + 2], -1.5f);
  }
  simulator.setContacts(1, {});
  EXPECT_EQ(support::stepOnce(simulator, kDt).ground_truth.total_force[1], 0);
}

}  // namespace
}  // namespace taxelsim
