// Reference depth and contact stages against closed forms of the Winkler foundation (K. L. Johnson, Contact Mechanics, CUP 1985,
// section 4.3), at random sub-cell offsets.
#include "reference/contact.h"
#include "reference/depth.h"
#include "support/random_scene.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using reference::PlacedObject;
using support::gridSensor;
using support::Random;

constexpr double kPi = std::numbers::pi;
constexpr double kStiffness = 1.73e8;  // N/m^3
constexpr double kThickness = 1e-2;    // m: exceeds all penetrations in these tests
// Relative: sums of a few thousand products of exact terms.
constexpr double kDoubleRounding = 1e-10;
// Relative: mesh vertices are float32. 2^-24 of 10 mm against a depth of 0.5 mm, doubled because force is quadratic in depth.
constexpr double kMeshRounding = 1e-5;
constexpr int kNumOffsets = 40;

// Sensor of 24 x 24 taxels with 2 x 2 samples each, spaced by `step` (m).
Sensor sensorWithStep(double step) {
  return gridSensor({.num_rows = 24,
                     .num_cols = 24,
                     .pitch_x = 2 * step,
                     .pitch_y = 2 * step,
                     .samples_per_taxel = 2,
                     .thickness = kThickness,
                     .law = {kStiffness, 1, 0}});
}

double forceOf(const Sensor& sensor, const Object& object, const Pose& X_SO) {
  const PlacedObject placed{&object, X_SO};
  const std::vector<double> d = reference::penetrations(reference::surfaceHeights(sensor, {&placed, 1}), sensor.skin.thickness);
  return reference::computeContact(sensor, d, {}, 0).total_force;
}

// Largest relative error of the force over random offsets within a taxel.
double worstError(const Sensor& sensor, const Object& object, const Quaternion& R_SO, double z, double expected) {
  Random random(1);
  double worst = 0;
  for (int n = 0; n < kNumOffsets; ++n) {
    const double x = random.uniform(-0.5, 0.5) * sensor.patches[0].pitch[0], y = random.uniform(-0.5, 0.5) * sensor.patches[0].pitch[1];
    worst = std::max(worst, std::abs(forceOf(sensor, object, {{x, y, z}, R_SO}) / expected - 1));
  }
  return worst;
}

struct Density {
  int samples_per_radius;
  double sphere_error;  // largest relative error over offsets found by an independent program, rounded up
};

class Convergence : public ::testing::TestWithParam<Density> {
 protected:
  // Error bound in units of 1 / n^2. At the rim of a contact of radius a, a convex profile of slope g loses at most g h^3 / 8 of volume in
  // each of about 8 a / h cells of size h: a g h^2 in total.
  double perSquare(double factor) const { return factor / (GetParam().samples_per_radius * GetParam().samples_per_radius); }
  double stepFor(double radius) const { return radius / GetParam().samples_per_radius; }
};

TEST_P(Convergence, SphereExact) {
  const double R = 8e-3, depth = 0.7e-3, a = std::sqrt(2 * R * depth - depth * depth);
  const double expected = kPi * kStiffness * depth * depth * (R - depth / 3);
  EXPECT_LE(worstError(sensorWithStep(stepFor(a)), Object(Sphere{R}), {1, 0, 0, 0}, R - depth, expected), GetParam().sphere_error);
}

TEST_P(Convergence, Cone) {
  const Cone cone{.radius = 6e-3, .height = 4e-3};
  const double depth = 0.9e-3, slope = cone.height / cone.radius;
  const double expected = kPi * kStiffness * depth * depth * depth / (3 * slope * slope);
  EXPECT_LE(worstError(sensorWithStep(stepFor(depth / slope)), Object(cone), {1, 0, 0, 0}, -depth, expected), perSquare(1));
}

// The cylinder's length is a whole number of samples, which leaves the error of the profile: at most 25 % / n^2, plus a tenth for
// higher-order terms.
TEST_P(Convergence, CylinderExact) {
  const double R = 5e-3, depth = 0.4e-3, a = std::sqrt(2 * R * depth - depth * depth), step = stepFor(a);
  const Cylinder cylinder{.radius = R, .length = 13 * step};
  const double section = R * R * std::acos((R - depth) / R) - (R - depth) * a;
  EXPECT_LE(
      worstError(sensorWithStep(step), Object(cylinder), axisAngle({1, 0, 0}, kPi / 2), R - depth, kStiffness * cylinder.length * section),
      perSquare(0.275));
}

TEST_P(Convergence, Capsule) {
  const double R = 5e-3, depth = 0.4e-3, a = std::sqrt(2 * R * depth - depth * depth), step = stepFor(a);
  const Capsule capsule{.radius = R, .length = 8 * step};
  const double section = R * R * std::acos((R - depth) / R) - (R - depth) * a;
  const double expected = kStiffness * (capsule.length * section + kPi * depth * depth * (R - depth / 3));
  EXPECT_LE(worstError(sensorWithStep(step), Object(capsule), axisAngle({0, 1, 0}, kPi / 2), R - depth, expected), perSquare(0.5));
}

// Pappus's theorem: section of the cylinder, revolved on the circle of the major radius.
TEST_P(Convergence, TorusLyingFlat) {
  const double r = 2e-3, depth = 0.3e-3, a = std::sqrt(2 * r * depth - depth * depth);
  const Torus torus{.major_radius = 4e-3, .minor_radius = r};
  const double section = r * r * std::acos((r - depth) / r) - (r - depth) * a;
  Sensor sensor = sensorWithStep(stepFor(a));
  sensor.patches[0].num_rows = sensor.patches[0].num_cols = 64;
  EXPECT_LE(worstError(sensor, Object(torus), {1, 0, 0, 0}, r - depth, kStiffness * 2 * kPi * torus.major_radius * section),
            perSquare(0.275));
}

// Prism with its edge down; its length is a whole number of samples.
TEST_P(Convergence, WedgeMesh) {
  const double slope = 0.5, depth = 0.5e-3, half_width = depth / slope, step = stepFor(half_width), length = 11 * step;
  const Object wedge("wedge", support::prism({{0, 0}, {8e-3, 8e-3 * slope}, {-8e-3, 8e-3 * slope}}, length));
  EXPECT_LE(worstError(sensorWithStep(step), wedge, {1, 0, 0, 0}, -depth, kStiffness * length * depth * depth / slope),
            perSquare(0.25) + kMeshRounding);
}

INSTANTIATE_TEST_SUITE_P(SamplesPerRadius, Convergence,
                         ::testing::Values(Density{2, 0.043}, Density{4, 0.0105}, Density{6, 0.0045}, Density{8, 0.0025}));

TEST(ClosedForm, FlatPunchForceIsStiffnessTimesAreaTimesDepth) {
  const double step = 0.4e-3, depth = 0.6e-3;
  const Box box{{9 * step, 14 * step, 5e-3}};  // whole numbers of samples: no discretisation error at any offset
  const double expected = kStiffness * box.size[0] * box.size[1] * depth;
  EXPECT_LE(worstError(sensorWithStep(step), Object(box), {1, 0, 0, 0}, 2.5e-3 - depth, expected), kDoubleRounding);
  const Object mesh("box", support::boxMesh(box.size));
  EXPECT_LE(worstError(sensorWithStep(step), mesh, {1, 0, 0, 0}, 2.5e-3 - depth, expected), kMeshRounding);
}

TEST(ClosedForm, TiltedFlatInFullContact) {
  const Sensor sensor = sensorWithStep(0.4e-3);
  const double side = 48 * 0.4e-3, phi = 0.05, depth = 0.8e-3;
  const Object half_space(HalfSpace{});
  const PlacedObject placed{&half_space, {{0, 0, -depth}, axisAngle({0, 1, 0}, phi)}};
  const auto d = reference::penetrations(reference::surfaceHeights(sensor, {&placed, 1}), kThickness);
  const reference::Contact contact = reference::computeContact(sensor, d, {}, 0);
  EXPECT_NEAR(contact.total_force / (kStiffness * side * side * depth), 1, kDoubleRounding);
  // d = depth + x tan(phi); the midpoint rule over 48 samples sums x^2 to a^3/12 (1 - 1/48^2).
  const double moment = kStiffness * std::tan(phi) * side * side * side * side / 12 * (1 - 1.0 / (48 * 48));
  EXPECT_NEAR(contact.wrench[4] / moment, 1, kDoubleRounding);  // r x F = x (-f) (e_x x e_z) = +x f e_y
  EXPECT_NEAR(contact.wrench[2], -contact.total_force, kDoubleRounding * contact.total_force);
  EXPECT_NEAR(contact.wrench[3], 0, kDoubleRounding * moment);
}

TEST(ClosedForm, TiltedFlatInPartialContact) {
  const double step = 0.2e-3;
  const Sensor sensor = sensorWithStep(step);
  const double side = 48 * step, phi = 0.1;
  const Object half_space(HalfSpace{});
  for (const double contact_fraction : {0.31, 0.5, 0.77}) {  // of the side
    const double reach = contact_fraction * side, edge_depth = reach * std::tan(phi);
    // The plane z = -(x - x0) tan(phi) meets the skin at x0 and is deepest at x = side / 2.
    const Pose X_SO{{side / 2 - reach, 0, 0}, axisAngle({0, 1, 0}, phi)};
    const double expected = kStiffness * side * edge_depth * edge_depth / (2 * std::tan(phi));
    // Error at the edge of contact: at most tan(phi) h^2 / 8 of area per length.
    EXPECT_NEAR(forceOf(sensor, half_space, X_SO) / expected, 1, 0.25 * step * step / (reach * reach));
  }
}

TEST(ClosedForm, PowerLawOnAFlatPunch) {
  for (const double exponent : {1.0, 1.5, 2.0, 3.0}) {
    Sensor sensor = sensorWithStep(0.4e-3);
    sensor.skin.law = Winkler{2e9, exponent, 0};
    const double depth = 0.6e-3, side = 10 * 0.4e-3;
    const double force = forceOf(sensor, Object(Box{{side, side, 1e-2}}), {{0.1e-3, 0.05e-3, 5e-3 - depth}});
    EXPECT_NEAR(force / (2e9 * std::pow(depth, exponent) * side * side), 1, kDoubleRounding);
  }
}

TEST(ClosedForm, DampingForceIsProportionalToRateAndNeverPulls) {
  Sensor sensor = gridSensor({.num_rows = 1, .num_cols = 1, .samples_per_taxel = 1, .law = {1e8, 1, 2e5}});
  const double area = 3.4e-3 * 3.4e-3, dt = 1e-3;
  const std::vector<double> shallow{0.2e-3}, deep{0.3e-3}, none{0.0};
  const auto force = [&](const std::vector<double>& d, const std::vector<double>& previous) {
    return reference::computeContact(sensor, d, previous, dt).total_force;
  };
  EXPECT_NEAR(force(deep, {}), 1e8 * 0.3e-3 * area, 1e-12);
  EXPECT_NEAR(force(deep, shallow), (1e8 * 0.3e-3 + 2e5 * 0.1) * area, 1e-12);
  EXPECT_NEAR(force(shallow, deep), (1e8 * 0.2e-3 - 2e5 * 0.1) * area, 1e-12);
  EXPECT_EQ(force(none, deep), 0);
  sensor.skin.law = Winkler{1e8, 1, 2e6};
  EXPECT_EQ(force(shallow, deep), 0);  // elastic 2e4 Pa, damping -2e5 Pa: clamped to 0
}

TEST(ClosedForm, OverPenetrationIsFractionOfSamplesAtSkinThickness) {
  Sensor sensor = gridSensor({.num_rows = 4, .num_cols = 6, .pitch_x = 1e-3, .pitch_y = 1e-3, .samples_per_taxel = 2, .thickness = 1e-3});
  const Object box(Box{{2e-3, 3e-3, 10e-3}});  // over 2 x 3 of 4 x 6 taxels
  const auto fraction = [&](double depth) {
    const PlacedObject placed{&box, {{0, 0.5e-3, 5e-3 - depth}}};
    const auto d = reference::penetrations(reference::surfaceHeights(sensor, {&placed, 1}), sensor.skin.thickness);
    return reference::computeContact(sensor, d, {}, 0).over_penetration;
  };
  EXPECT_EQ(fraction(0.9e-3), 0);
  EXPECT_DOUBLE_EQ(fraction(1.5e-3), 6.0 / 24);
  EXPECT_DOUBLE_EQ(fraction(9e-3), 6.0 / 24);  // deeper than the skin: the bottom face is still the lowest surface
}

TEST(ClosedForm, HeightIsThatOfTheLowestObject) {
  const Sensor sensor = sensorWithStep(0.4e-3);
  const Object deep(Sphere{3e-3}), shallow(Box{{4e-3, 4e-3, 4e-3}});
  const std::vector<PlacedObject> both{{&deep, {{1e-3, 0, 2.5e-3}}}, {&shallow, {{0, 0, 1.8e-3}}}};
  const auto together = reference::surfaceHeights(sensor, both);
  const auto first = reference::surfaceHeights(sensor, {both.data(), 1}), second = reference::surfaceHeights(sensor, {both.data() + 1, 1});
  for (std::size_t n = 0; n < together.size(); ++n) {
    EXPECT_EQ(together[n], std::min(first[n], second[n]));
  }
}

TEST(ClosedForm, SampleOnAnEdgeIsCovered) {
  // The only sample is at the origin: on the diagonal between the two triangles of the bottom face, then on its rim.
  const Sensor sensor = gridSensor({.num_rows = 1, .num_cols = 1, .samples_per_taxel = 1});
  const Object box("box", support::boxMesh({0.5, 0.5, 0.5}));
  for (const double x : {0.0, 0.25, -0.25}) {
    const PlacedObject placed{&box, {{x, 0, 0.25 - 0.001}}};
    EXPECT_NEAR(reference::surfaceHeights(sensor, {&placed, 1})[0], -0.001, 1e-15);
  }
}

}  // namespace
}  // namespace taxelsim
