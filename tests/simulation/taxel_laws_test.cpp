// Laws with a pass over the taxels, on the device. The contact forces are those of a winkler skin of the same stiffness; the response of
// the taxels is compared with the twin's.
#include "reference/taxel_laws.h"
#include "reference/psf.h"
#include "simulation/comparison.h"
#include "support/cases.h"
#include "support/curved_sensor.h"
#include "support/random_scene.h"
#include "support/test.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

using support::Random;

// Matrix, state and force of a step are rounded to float32, about eight roundings relative to the largest force; errors of steps add up.
constexpr double kPerStep = 16 * support::kUlp;
// The published weights of the mask, and those of the device, have five digits.
constexpr double kMaskWeights = 2e-5;

// Results along a path of one object: normal and shear forces (num_steps x num_taxels) after the law, N, and the wrench.
struct Path {
  std::vector<std::vector<float>> forces;
  std::vector<std::vector<reference::Shear>> shears;
  std::vector<std::vector<float>> wrench;
};

Path follow(Sensor sensor, const ContactLaw& law, const Object& object, const std::vector<Pose>& path, const std::vector<double>& dt,
            float load = std::numeric_limits<float>::quiet_NaN()) {
  sensor.skin.law = law;
  Simulator simulator = support::makeSimulator(sensor, {object});
  if (!std::isnan(load)) simulator.setLoad(0, load);
  Path result;
  for (std::size_t n = 0; n < path.size(); ++n) {
    const FrameView frame = support::stepOnce(simulator, {{{0}, {path[n]}}}, dt[n]);
    support::expectWellFormed(frame, sensor, 1);
    result.forces.emplace_back(frame.ground_truth.tactile_normal_force.begin(), frame.ground_truth.tactile_normal_force.end());
    result.shears.emplace_back();
    const auto shear = frame.ground_truth.tactile_shear_force;
    for (std::size_t t = 0; t < shear.size(); t += 2) result.shears.back().push_back({shear[t], shear[t + 1]});
    result.wrench.emplace_back(frame.ground_truth.contact_wrench.begin(), frame.ground_truth.contact_wrench.end());
  }
  return result;
}

Sensor plainSensor(Random& random, int max_patches) {
  Sensor sensor = support::randomSensor(random, {.max_rows = 8, .max_cols = 10, .max_patches = max_patches, .max_kernel = 1});
  sensor.psf = {};
  return sensor;
}

std::vector<double> asDouble(const std::vector<float>& values) {
  return {values.begin(), values.end()};
}

double sum(const std::vector<float>& values) {
  double total = 0;
  for (const float value : values) total += value;
  return total;
}

class TaxelLaws : public ::testing::TestWithParam<int> {};

// A sensor with PSF lists: one grid, a fingertip, a cap or a random list.
Sensor skinSpreadSensor(Random& random, int kind) {
  if (kind % 4 > 0) return support::curvedSensor(random, kind % 4 - 1);
  Sensor sensor = plainSensor(random, 1);
  sensor.psf.sigma = random.uniform(0.2, 1) * sensor.patches[0].pitch[0];
  return sensor;
}

Pose contactOn(Random& random, const Sensor& sensor, const Object& object) {
  return isTaxelList(sensor) ? support::randomContactOnTaxel(random, sensor, object) : support::randomContact(random, sensor, object);
}

Sensor withoutSpread(Sensor sensor) {
  sensor.psf = {};
  return sensor;
}

void expectMassSpringDamperFollowsItsTwin(Random& random, const Sensor& sensor) {
  const Object object = support::randomSolid(random, 0.02);
  const auto logarithmic = [&](double low, double high) { return low * std::pow(high / low, random.uniform()); };
  const MassSpringDamper law{.normal_contact_stiffness = 1.73e8,
                             .mass = logarithmic(1e-5, 1e-1),
                             .stiffness = logarithmic(1, 1e3),
                             .damping = random.chance(0.1) ? 0 : logarithmic(1e-3, 10)};
  std::vector<Pose> path;
  std::vector<double> dt;
  for (int n = 0; n < 6; ++n) {
    path.push_back(contactOn(random, sensor, object));
    dt.push_back(logarithmic(1e-4, 1e-1));
  }
  const Path pressed = follow(withoutSpread(sensor), Winkler{.normal_contact_stiffness = 1.73e8}, object, path, dt);
  const Path device = follow(sensor, law, object, path, dt);
  Sensor with_law = sensor;
  with_law.skin.law = law;
  std::vector<reference::TaxelState> state;
  // What the spread makes of a force on every taxel; of roundings the same.
  double gain = 1;
  for (const double sum : reference::spread(sensor, std::vector<double>(static_cast<std::size_t>(numTaxels(sensor)), 1))) {
    gain = std::max(gain, sum);
  }
  double largest = 0;
  for (std::size_t n = 0; n < path.size(); ++n) {
    const std::vector<double> expected =
        reference::spread(with_law, reference::taxelResponse(with_law, asDouble(pressed.forces[n]), dt[n], state));
    for (const float force : pressed.forces[n]) largest = std::max<double>(largest, force);
    const double largest_sum = sum(pressed.forces[n]);
    for (std::size_t t = 0; t < expected.size(); ++t) {
      ASSERT_NEAR(device.forces[n][t], expected[t], kPerStep * static_cast<double>(n + 1) * largest * gain + support::kAbsoluteForce)
          << n << " " << t;
    }
    EXPECT_NEAR(device.wrench[n][2], pressed.wrench[n][2], support::kRelativeMoment * largest_sum) << "contact presses the same";
  }
}

// What contact shears is that of a winkler skin; what taxels show of it is shortened to what friction holds by their own forces, then
// spread with the weights of these, so that no taxel ever shows more.
TEST_P(TaxelLaws, MassSpringDamperShearStaysInsideTheCone) {
  Random random(300 + static_cast<std::uint64_t>(GetParam()));
  Sensor plain = plainSensor(random, 1 + GetParam() % 2);
  plain.skin.friction = {plain.skin.thickness > 1e-3 ? 1e8 : 1e9, random.uniform(0.1, 1.5)};
  Sensor spread = plain;
  if (GetParam() % 3 != 0) spread.psf = gaussianPsf(0.8, 3 + 2 * (GetParam() % 3 - 1));
  const Object object = support::randomSolid(random, 0.02);
  const auto logarithmic = [&](double low, double high) { return low * std::pow(high / low, random.uniform()); };
  const bool any = GetParam() % 4 == 3;  // six orders of magnitude either way
  const MassSpringDamper law{.normal_contact_stiffness = 1.73e8,
                             .mass = any ? logarithmic(1e-9, 1e3) : logarithmic(1e-5, 1e-1),
                             .stiffness = any ? logarithmic(1.6e-5, 1.6e7) : logarithmic(1, 1e3),
                             .damping = random.chance(0.2) ? 0 : logarithmic(1e-3, 10)};
  std::vector<Pose> path{support::randomContact(random, plain, object)};
  std::vector<double> dt{1e-3};
  for (int n = 0; n < 7; ++n) {
    path.push_back(path.back());
    for (double& coordinate : path.back().position) coordinate += random.uniform(-0.2, 0.2) * plain.skin.thickness;
    dt.push_back(logarithmic(1e-4, 1e-1));
  }
  path[4].position[2] += 0.05;  // lifted: springs swing on, shear ends
  const double mu = plain.skin.friction.friction_coefficient;
  const Path pressed = follow(plain, Winkler{.normal_contact_stiffness = 1.73e8}, object, path, dt);
  const Path device = follow(spread, law, object, path, dt);
  Sensor with_law = spread;
  with_law.skin.law = law;
  std::vector<reference::TaxelState> state;
  double largest = 0;
  for (std::size_t n = 0; n < path.size(); ++n) {
    EXPECT_EQ(device.wrench[n], pressed.wrench[n]) << "contact shears the same";
    const std::vector<double> response = reference::taxelResponse(with_law, asDouble(pressed.forces[n]), dt[n], state);
    const std::vector<reference::Shear> read = reference::taxelShear(with_law, pressed.shears[n], response);
    for (const float force : pressed.forces[n]) largest = std::max<double>(largest, force);
    for (std::size_t axis = 0; axis < 2; ++axis) {
      std::vector<double> component;
      for (const reference::Shear& shear : read) component.push_back(shear[axis]);
      const std::vector<double> expected = reference::spread(spread, component);
      for (std::size_t t = 0; t < expected.size(); ++t) {
        // The shear itself is contact's, bit by bit; where it is shortened, as the force of the spring.
        const double slack = (kPerStep * static_cast<double>(n + 1) + 100 * support::kUlp) * mu * largest + support::kAbsoluteForce;
        ASSERT_NEAR(device.shears[n][t][axis], expected[t], slack) << n << " " << t;
      }
    }
    for (std::size_t t = 0; t < device.forces[n].size(); ++t) {
      const double size = std::hypot(device.shears[n][t][0], device.shears[n][t][1]);
      ASSERT_LE(size, mu * device.forces[n][t] * (1 + 100 * support::kUlp)) << n << " " << t;
    }
  }
}

TEST_P(TaxelLaws, MassSpringDamperMatchesTheTwin) {
  Random random(static_cast<std::uint64_t>(GetParam()));
  expectMassSpringDamperFollowsItsTwin(random, plainSensor(random, 1 + GetParam() % 2));
}

TEST_P(TaxelLaws, MassSpringDamperMatchesTheTwinWithPsfLists) {
  Random random(300 + static_cast<std::uint64_t>(GetParam()));
  expectMassSpringDamperFollowsItsTwin(random, skinSpreadSensor(random, GetParam()));
}

void expectDeformationMaskFollowsItsTwinAndKeepsTheForce(Random& random, const Sensor& sensor, double saturation_pressure,
                                                         double weights = kMaskWeights) {
  const Object object = support::randomMeshObject(random, 0.02);
  const DeformationMask law{.saturation_pressure = saturation_pressure};
  const std::vector<Pose> path{contactOn(random, sensor, object), contactOn(random, sensor, object)};
  const Path pressed = follow(withoutSpread(sensor), Winkler{.normal_contact_stiffness = 3.5e8}, object, path, {1e-3, 1e-3});
  const Path device = follow(sensor, law, object, path, {1e-3, 1e-3});
  Sensor with_law = sensor;
  with_law.skin.law = law;
  std::vector<reference::TaxelState> state;
  for (std::size_t n = 0; n < path.size(); ++n) {
    const std::vector<double> expected =
        reference::spread(with_law, reference::taxelResponse(with_law, asDouble(pressed.forces[n]), 0, state));
    const double total = sum(pressed.forces[n]);
    for (std::size_t t = 0; t < expected.size(); ++t)
      ASSERT_NEAR(device.forces[n][t], expected[t], weights * total + support::kAbsoluteForce);
    EXPECT_NEAR(sum(device.forces[n]), total, 1e-5 * total + support::kAbsoluteForce);
  }
}

TEST_P(TaxelLaws, DeformationMaskMatchesTheTwinAndKeepsTheForce) {
  Random random(100 + static_cast<std::uint64_t>(GetParam()));
  const Sensor sensor = plainSensor(random, 1 + GetParam() % 3);
  expectDeformationMaskFollowsItsTwinAndKeepsTheForce(random, sensor, GetParam() % 2 == 0 ? 250e3 : 30e3);
}

TEST_P(TaxelLaws, DeformationMaskMatchesTheTwinWithPsfLists) {
  Random random(400 + static_cast<std::uint64_t>(GetParam()));
  expectDeformationMaskFollowsItsTwinAndKeepsTheForce(random, skinSpreadSensor(random, 0), GetParam() % 2 == 0 ? 250e3 : 30e3);
}

// The device integrates the mask over each taxel by Gauss-Legendre rules, the twin by the midpoint rule with h = 1/40 of a side. Its error
// along either side is h^2 / 24 times the mask's largest second derivative, 4.4, for sides of up to twice the mean size.
constexpr double kListWeights = 2 * 4.4 / 24 * 4 / (40 * 40);

TEST_P(TaxelLaws, DeformationMaskMatchesTheTwinOnLists) {
  Random random(500 + static_cast<std::uint64_t>(GetParam()));
  const Sensor sensor = withoutSpread(support::curvedSensor(random, GetParam()));
  expectDeformationMaskFollowsItsTwinAndKeepsTheForce(random, sensor, GetParam() % 2 == 0 ? 250e3 : 30e3, kListWeights);
}

TEST_P(TaxelLaws, ProximityReadsDepthWithoutForce) {
  Random random(200 + static_cast<std::uint64_t>(GetParam()));
  const Sensor sensor = GetParam() < 8 ? plainSensor(random, 1 + GetParam() % 2) : skinSpreadSensor(random, GetParam());
  const Object object = support::randomSolid(random, 0.02);
  const std::vector<Pose> path{contactOn(random, sensor, object)};
  const Path pressed = follow(sensor, Winkler{.normal_contact_stiffness = 1e8}, object, path, {1e-3});
  const Path device = follow(sensor, Proximity{.sensitivity = 1e8}, object, path, {1e-3});
  EXPECT_EQ(device.forces, pressed.forces);
  EXPECT_EQ(device.wrench[0][2], 0);
}

// The weights of a flat list of squares are those of the grid.
TEST(TaxelLawsOnLists, DeformationMaskOfAFlatListIsThatOfAGrid) {
  const Sensor grid = support::gridSensor({.num_rows = 5, .num_cols = 6});
  Sensor list = grid;
  list.psf = {};
  list.patches.clear();
  const std::vector<Vector3> positions = taxelPositions(grid);
  for (std::size_t t = 0; t < positions.size(); ++t) {
    list.patches.push_back(taxelPatch("t" + std::to_string(t), positions[t], {0, 0, 1}, grid.patches[0].pitch));
  }
  ASSERT_EQ(grid.patches[0].pitch[0], grid.patches[0].pitch[1]);
  const Object object(Sphere{0.006});
  for (const Pose& pose : {Pose{.position = {1e-3, 2e-3, 5.5e-3}}, Pose{.position = {6.5e-3, 8e-3, 5.7e-3}}}) {
    const Path expected = follow(withoutSpread(grid), DeformationMask{}, object, {pose}, {1e-3});
    const Path found = follow(list, DeformationMask{}, object, {pose}, {1e-3});
    const double total = sum(expected.forces[0]);
    EXPECT_GT(total, 0.5);
    for (std::size_t t = 0; t < positions.size(); ++t) {
      EXPECT_NEAR(found.forces[0][t], expected.forces[0][t], (kMaskWeights + 1e-5) * total) << "taxel " << t;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(OnEveryDriver, TaxelLaws, support::seeds(4, 6));

// Under every law whose taxels carry force; the elastic layer's, with its margin, in elastic_layer_test.cpp.
TEST(TaxelLawsUnderLoad, TaxelsCarryTheLoad) {
  constexpr double kCarried = 1e-3;  // of the load
  constexpr float kLoad = 2;
  Sensor plain = support::gridSensor();
  plain.psf = {};
  Sensor spread = plain;
  spread.psf = gaussianPsf(0.5, 3);
  Sensor patches = spread;  // two patches with a gap of one taxel between them
  patches.patches.push_back(patches.patches[0]);
  patches.patches[1].name = "second";
  patches.patches[1].X_SP.position[0] = (patches.patches[0].num_rows + 1) * patches.patches[0].pitch[0];
  Sensor relaxing = spread;
  relaxing.skin.relaxation = {{0.3, 1e-3}, {0.2, 1}};
  int number = 0;
  const Vector3 middle{0.001, 0.002, 0.02}, border{0.0098, -0.02, 0.02}, across{patches.patches[1].X_SP.position[0] / 2, 0.003, 0.02};
  for (const ContactLaw& law : std::vector<ContactLaw>{
           Winkler{.normal_contact_stiffness = 1.73e8}, Winkler{.normal_contact_stiffness = 1e11, .normal_exponent = 2},
           MassSpringDamper{.normal_contact_stiffness = 1.73e8}, DeformationMask{}, LuGre{.normal_contact_stiffness = 1.73e8}}) {
    for (Sensor sensor : {plain, spread, patches, relaxing}) {
      if (!support::runsAllCases() && number++ % 3 == 1) continue;  // the others cover each law and each sensor
      sensor.skin.law = law;
      SCOPED_TRACE("law " + std::to_string(law.index()) + ", " + std::to_string(sensor.patches.size()) + " patches");
      std::vector<Pose> X_SO{{.position = middle}, {.position = border}};
      if (sensor.patches.size() > 1) X_SO.push_back({.position = across});
      Simulator simulator = support::makeSimulator(sensor, {Object(Sphere{0.008})}, {.num_instances = static_cast<int>(X_SO.size())});
      simulator.setLoads(std::vector<float>(X_SO.size(), kLoad));
      simulator.setObjects(std::vector<int>(X_SO.size(), 0), X_SO);
      for (int step = 0; step < 2; ++step) {
        const auto forces = support::stepOnce(simulator, 1e-3).ground_truth.tactile_normal_force;
        const std::size_t num_taxels = forces.size() / X_SO.size();
        for (std::size_t i = 0; i < X_SO.size(); ++i) {
          const auto image = forces.subspan(i * num_taxels, num_taxels);
          EXPECT_NEAR(std::accumulate(image.begin(), image.end(), 0.0), kLoad, kCarried * kLoad) << "x " << X_SO[i].position[0];
        }
      }
    }
  }
}

TEST(TaxelLawsUnderLoad, ProximityRejectsALoad) {
  Sensor sensor = support::gridSensor();
  sensor.skin.law = Proximity{.sensitivity = 1e8};
  Simulator simulator = support::makeSimulator(sensor, {Object(Sphere{0.01})});
  EXPECT_THROW(simulator.setLoad(0, 1), Error);
  simulator.setLoad(0, std::numeric_limits<float>::quiet_NaN());  // driven by pose
}

// A mass that has just been pushed holds little yet; after a while, or under a load, the shear is that of a winkler skin.
TEST(TaxelLawsShearOnEveryDriver, FollowsTheMassAndSettlesToContactShear) {
  Sensor sensor = support::gridSensor();
  sensor.skin.friction = {1e8, 0.6};
  sensor.psf = gaussianPsf(0.5, 3);
  const Object object(Sphere{0.01});
  std::vector<Pose> path{{.position = {0, 0, 0.03}}, {.position = {0, 0, 0.0092}}, {.position = {0.2e-3, 0.1e-3, 0.0092}}};
  for (int n = 0; n < 30; ++n) path.push_back(path.back());
  std::vector<double> dt(path.size(), 2e-3);
  std::fill(dt.begin() + 4, dt.end(), 0.05);
  const MassSpringDamper law{.normal_contact_stiffness = 1.73e8};
  const Path held = follow(sensor, Winkler{.normal_contact_stiffness = 1.73e8}, object, path, dt);
  const Path lagging = follow(sensor, law, object, path, dt);
  const auto along_x = [](const Path& run, std::size_t step) {
    double total = 0;
    for (const reference::Shear& shear : run.shears[step]) total += shear[0];
    return total;
  };
  EXPECT_GT(along_x(held, 2), 0.1);
  EXPECT_LT(along_x(lagging, 2), 0.3 * along_x(held, 2));
  EXPECT_GT(along_x(lagging, 2), 0);
  // e^(-0.508 * 128 / s * 1.3 s) of the force is left.
  for (std::size_t t = 0; t < held.shears.back().size(); ++t) {
    for (std::size_t axis = 0; axis < 2; ++axis) EXPECT_NEAR(lagging.shears.back()[t][axis], held.shears.back()[t][axis], 1e-5);
  }
  const Path under_load = follow(sensor, law, object, path, dt, 2.0f);
  const Path winkler_under_load = follow(sensor, Winkler{.normal_contact_stiffness = 1.73e8}, object, path, dt, 2.0f);
  for (std::size_t t = 0; t < held.shears[2].size(); ++t) {
    for (std::size_t axis = 0; axis < 2; ++axis) EXPECT_NEAR(under_load.shears[2][t][axis], winkler_under_load.shears[2][t][axis], 1e-5);
  }
}

TEST(TaxelLawsShearOnEveryDriver, WorksWithoutShearOutput) {
  Sensor sensor = support::gridSensor();
  sensor.skin = {2e-3, MassSpringDamper{.normal_contact_stiffness = 1.73e8}, {1e8, 0.6}};
  Simulator simulator = support::makeSimulator(sensor, {Object(Sphere{0.01})}, {.outputs = {.tactile_shear_force = false}});
  for (const double x : {0.0, 0.2e-3}) {
    const FrameView frame = support::stepOnce(simulator, {{{0}, {{.position = {x, 0, 0.0092}}}}}, 1e-3);
    EXPECT_TRUE(frame.ground_truth.tactile_shear_force.empty());
    EXPECT_EQ(frame.ground_truth.contact_wrench[0] > 0.1f, x > 0);
  }
}

// Six orders of magnitude beyond the usual each way, and steps from a microsecond to a quarter of an hour: a spring never carries more than
// an undamped swing.
TEST(TaxelLawsUnderLoad, ExtremeParametersStayBounded) {
  const Sensor sensor = support::gridSensor({.num_rows = 4, .num_cols = 4});
  const Object object(Sphere{0.01});
  const std::vector<Pose> path{
      {.position = {0, 0, 0.02}}, {.position = {0, 0, 0.009}}, {.position = {0, 0, 0.009}}, {.position = {0, 0, 0.02}}};
  const Path pressed = follow(sensor, Winkler{.normal_contact_stiffness = 1.73e8}, object, path, {1, 1, 1, 1});
  double largest = 0;
  for (const float force : pressed.forces[1]) largest = std::max<double>(largest, force);
  int number = 0;
  for (const double mass : {1e-9, 1e3}) {
    for (const double stiffness : {1.6e-5, 1.6e7}) {
      for (const double damping : {0.0, 1.3e-7, 1.3e5}) {
        for (const double dt : {1e-6, 1e-3, 1e3}) {
          if (!support::runsAllCases() && number++ % 4 != 0) continue;
          const Path device = follow(sensor, MassSpringDamper{1.73e8, mass, stiffness, damping}, object, path, {dt, dt, dt, dt});
          for (const auto& forces : device.forces) {
            for (const float force : forces)
              EXPECT_TRUE(force >= 0 && force <= 4.001 * largest) << mass << " " << stiffness << " " << damping << " " << dt;
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace taxelsim
