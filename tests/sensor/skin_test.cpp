// Curved skins: distances in closed form, neighbours, view depths, and taxels with individual poses.
#include "sensor/skin.h"

#include "example_sensor.h"
#include "sensor/taxel_mesh.h"
#include "support/input_error.h"
#include "support/test.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

constexpr double kRounding = 1e-14;  // a dozen roundings of lengths of 0.1 m
constexpr double kPi = std::numbers::pi;

Vector3 onSphere(double down, double around) {
  return {std::sin(down) * std::cos(around), std::sin(down) * std::sin(around), std::cos(down)};
}

Vector3 times(double factor, const Vector3& v) {
  return {factor * v[0], factor * v[1], factor * v[2]};
}

TEST(SkinDistance, OnAPlaneIsTheChord) {
  EXPECT_NEAR(skinDistance({0.01, 0.02, 0.03}, {0, 0, 1}, {0.04, 0.06, 0.03}, {0, 0, 1}), 0.05, kRounding);
  EXPECT_EQ(skinDistance({1, 2, 3}, {0, 0, 1}, {1, 2, 3}, {0, 0, 1}), 0);
}

TEST(SkinDistance, OnASphereIsTheGreatCircle) {
  for (const double angle : {1e-9, 0.01, 0.5, 1.5, 3.0}) {
    const Vector3 n = onSphere(0.3, 0.7), m = onSphere(0.3 + angle, 0.7);
    EXPECT_NEAR(skinDistance(times(0.008, n), n, times(0.008, m), m), 0.008 * angle, kRounding) << angle;
  }
}

TEST(SkinDistance, OnACylinderIsTheHelix) {
  for (const double angle : {0.0, 0.01, 0.5, 1.5, 3.0}) {
    const Vector3 n{0, 0, 1}, m{std::sin(angle), 0, std::cos(angle)};
    const double distance = skinDistance({0, 0.001, 0.008}, n, {0.008 * m[0], 0.006, 0.008 * m[2]}, m);
    EXPECT_NEAR(distance, std::hypot(0.008 * angle, 0.005), kRounding) << angle;
  }
}

TEST(SkinDistance, IsSymmetricAndFiniteForOppositeNormals) {
  const Vector3 p{0.001, 0.002, 0.003}, q{-0.004, 0.001, 0.002}, n = onSphere(0.4, 1), m = onSphere(1.1, -2);
  EXPECT_EQ(skinDistance(p, n, q, m), skinDistance(q, m, p, n));
  EXPECT_TRUE(std::isfinite(skinDistance({0, 0, 0}, {0, 0, 1}, {0, 0, -0.003}, {0, 0, -1})));
}

TEST(SkinNeighbours, CrossPatches) {
  Sensor sensor = exampleSensor();
  sensor.psf = {.sigma = 0.0034};  // reach 3 pitches: rounding must not decide which taxels are within
  const auto whole = skinNeighbours(sensor);
  // 29 points of an integer lattice lie within distance 3. From row 3 of rows 0 to 5, the point in row 6 does not exist.
  EXPECT_EQ(whole[3 * 14 + 7].size(), 28u);
  // The same taxels in two patches of three rows.
  sensor.patches[0].num_rows = 3;
  sensor.patches.push_back(sensor.patches[0]);
  sensor.patches[0].X_SP.position[0] = -1.5 * 0.0034;
  sensor.patches[1].X_SP.position[0] = 1.5 * 0.0034;
  const auto halves = skinNeighbours(sensor);
  ASSERT_EQ(halves.size(), whole.size());
  for (std::size_t t = 0; t < whole.size(); ++t) {
    ASSERT_EQ(halves[t].size(), whole[t].size()) << t;
    for (std::size_t k = 0; k < whole[t].size(); ++k) {
      EXPECT_EQ(halves[t][k].taxel, whole[t][k].taxel);
      EXPECT_NEAR(halves[t][k].weight, whole[t][k].weight, kRounding);
    }
  }
}

TEST(SkinNeighbours, HaveGaussianWeights) {
  Sensor sensor = exampleSensor();
  sensor.psf = {.sigma = 0.002, .reach = 0.005};
  const std::vector<Vector3> p = taxelPositions(sensor);
  const auto neighbours = skinNeighbours(sensor);
  for (const SkinNeighbour& neighbour : neighbours[20]) {
    const double square = std::pow(p[neighbour.taxel][0] - p[20][0], 2) + std::pow(p[neighbour.taxel][1] - p[20][1], 2);
    EXPECT_LE(square, 0.005 * 0.005);
    EXPECT_NEAR(neighbour.weight, std::exp(-square / (2 * 0.002 * 0.002)), kRounding);
  }
}

TEST(SkinNeighbours, AreAtMost128) {
  Sensor sensor = exampleSensor();
  sensor.patches[0].num_rows = sensor.patches[0].num_cols = 20;
  sensor.psf = {.sigma = 0.0034, .reach = 6.5 * 0.0034};  // 137 points of the lattice
  EXPECT_THROW(checkSensor(sensor), Error);
  sensor.psf.reach = 6.1 * 0.0034;  // 113
  EXPECT_NO_THROW(checkSensor(sensor));
}

TEST(CheckSensor, SpreadByDistance) {
  const auto refused = [](const Psf& psf) {
    Sensor sensor = exampleSensor();
    sensor.psf = psf;
    EXPECT_THROW(checkSensor(sensor), Error) << psf.sigma << " " << psf.reach;
  };
  for (const double bad : {-1e-3, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    refused({.sigma = bad});
    refused({.sigma = 1e-3, .reach = bad});
  }
  refused({.reach = 1e-3});
  Psf both = gaussianPsf(0.5, 3);
  both.sigma = 1e-3;
  refused(both);
}

// Taxels around a whole cylinder along y, `count` of them.
Sensor ring(double radius, int count) {
  Sensor sensor = exampleSensor();
  sensor.patches.clear();
  for (int i = 0; i < count; ++i) {
    const Vector3 n{std::sin(2 * kPi * i / count), 0, std::cos(2 * kPi * i / count)};
    sensor.patches.push_back(taxelPatch("", times(radius, n), n, {1e-3, 1e-3}));
  }
  return sensor;
}

TEST(ViewDepths, EndAtTheMiddleOfABody) {
  for (const double depth : viewDepths(ring(0.008, 24))) EXPECT_NEAR(depth, 0.008, kRounding);
}

TEST(ViewDepths, AreInfiniteWithoutOpposingSkin) {
  EXPECT_TRUE(std::isinf(viewDepths(exampleSensor())[0]));
  Sensor quarter = ring(0.008, 24);
  quarter.patches.resize(6);  // 0 to 75 degrees
  for (const double depth : viewDepths(quarter)) EXPECT_TRUE(std::isinf(depth));
}

TEST(ViewDepths, AreHalfAPlateAndAtLeastTheThickness) {
  Sensor plate = ring(0.008, 2);
  EXPECT_NEAR(viewDepths(plate)[0], 0.008, kRounding);
  plate.skin.thickness = 0.009;
  EXPECT_EQ(viewDepths(plate)[0], 0.009);
}

TEST(TaxelPatch, HasZAlongItsNormal) {
  for (const Vector3& normal : {Vector3{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {0, -3, 0}, {1e-200, 2e-200, -1e-200}, {1, 2, 3}}) {
    const GridPatch patch = taxelPatch("t", {1, 2, 3}, normal, {0.001, 0.002});
    const Vector3 n = rotate(patch.X_SP.rotation, {0, 0, 1});
    const double length = std::hypot(normal[0] / 1e-200, normal[1] / 1e-200, normal[2] / 1e-200) * 1e-200;
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(n[axis], normal[axis] / length, kRounding);
    EXPECT_EQ(patch.pitch, (std::array<double, 2>{0.001, 0.002}));
    EXPECT_EQ(patch.X_SP.position, (Vector3{1, 2, 3}));
  }
  EXPECT_EQ(taxelPatch("t", {}, {0, 0, 2}, {1, 1}).X_SP, Pose{}) << "no rotation";
  EXPECT_EQ(taxelPatch("t", {}, {0, 0, 2}, {1, 1}, Vector3{3, 0, 1}).X_SP, Pose{});
}

TEST(TaxelPatch, RotatesXByTheShortestRotationOrTowardsXAxis) {
  const Vector3 turned = rotate(taxelPatch("t", {}, {1, 0, 0}, {1, 1}).X_SP.rotation, {1, 0, 0});
  EXPECT_NEAR(turned[2], -1, kRounding) << "as on a cylinder along y";
  const Vector3 projected = rotate(taxelPatch("t", {}, {0, 1, 1}, {1, 1}, Vector3{0, 5, -5}).X_SP.rotation, {1, 0, 0});
  EXPECT_NEAR(projected[1], std::sqrt(0.5), kRounding);
  EXPECT_NEAR(projected[2], -std::sqrt(0.5), kRounding);
}

TEST(TaxelPatch, RejectsZeroDirections) {
  EXPECT_THROW(taxelPatch("t", {}, {0, 0, 0}, {1, 1}), Error);
  EXPECT_THROW(taxelPatch("t", {}, {0, 0, std::numeric_limits<double>::infinity()}, {1, 1}), Error);
  EXPECT_THROW(taxelPatch("t", {}, {0, 1, 1}, {1, 1}, Vector3{0, 2, 2}), Error);
  EXPECT_THROW(taxelPatch("t", {}, {0, 1, 1}, {1, 1}, Vector3{0, 0, 0}), Error);
}

// Vertices are float32: positions of 0.01 m are rounded to 1e-9 m.
constexpr double kFloat = 2e-9;

TEST(TaxelMesh, PairsTrianglesInOrder) {
  // Two taxels of 2 mm x 3 mm side by side along x, the second raised by 1 mm; the second pair starts with another corner.
  const Mesh mesh{{{0, 0, 0},
                   {0.002f, 0, 0},
                   {0.002f, 0.003f, 0},
                   {0, 0.003f, 0},
                   {0.004f, 0, 0.001f},
                   {0.006f, 0, 0.001f},
                   {0.006f, 0.003f, 0.001f},
                   {0.004f, 0.003f, 0.001f}},
                  {{0, 1, 2}, {0, 2, 3}, {7, 4, 6}, {4, 5, 6}}};
  const std::vector<GridPatch> taxels = taxelsOfMesh(mesh);
  ASSERT_EQ(taxels.size(), 2u);
  for (std::size_t t = 0; t < 2; ++t) {
    EXPECT_NEAR(taxels[t].X_SP.position[0], t == 0 ? 0.001 : 0.005, kFloat);
    EXPECT_NEAR(taxels[t].X_SP.position[1], 0.0015, kFloat);
    EXPECT_NEAR(taxels[t].X_SP.position[2], t == 0 ? 0 : 0.001, kFloat);
    EXPECT_NEAR(rotate(taxels[t].X_SP.rotation, {0, 0, 1})[2], 1, kRounding);
    // Either side may be the first; the taxel in S is the same.
    const Vector3 x = rotate(taxels[t].X_SP.rotation, {1, 0, 0});
    const bool along_x = std::abs(x[0]) > 0.5;
    EXPECT_NEAR(taxels[t].pitch[0], along_x ? 0.002 : 0.003, kFloat);
    EXPECT_NEAR(taxels[t].pitch[1], along_x ? 0.003 : 0.002, kFloat);
  }
}

TEST(TaxelMesh, PairsTrianglesByTheirLongestEdge) {
  const Mesh mesh{{{0, 0, 0},
                   {0.002f, 0, 0},
                   {0.002f, 0.002f, 0},
                   {0, 0.002f, 0},
                   {0.004f, 0, 0},
                   {0.006f, 0, 0},
                   {0.006f, 0.002f, 0},
                   {0.004f, 0.002f, 0}},
                  {{0, 1, 2}, {4, 5, 6}, {0, 2, 3}, {4, 6, 7}}};
  const std::vector<GridPatch> taxels = taxelsOfMesh(mesh);
  ASSERT_EQ(taxels.size(), 2u);
  EXPECT_NEAR(taxels[0].X_SP.position[0], 0.001, kFloat);
  EXPECT_NEAR(taxels[1].X_SP.position[0], 0.005, kFloat);
}

TEST(TaxelMesh, KeepsAreaAndOutwardNormals) {
  // A rhombus of 60 degrees in the plane x = 0, counter-clockwise seen from +x.
  const double h = std::sqrt(3) / 2;
  const Mesh mesh{{{0, 0, 0}, {0, 0.002f, 0}, {0, 0.003f, static_cast<float>(0.002 * h)}, {0, 0.001f, static_cast<float>(0.002 * h)}},
                  {{0, 1, 3}, {1, 2, 3}}};
  const GridPatch taxel = taxelsOfMesh(mesh).at(0);
  EXPECT_NEAR(taxel.pitch[0] * taxel.pitch[1], 0.002 * 0.002 * h, kFloat * 0.002);
  EXPECT_NEAR(taxel.pitch[0], taxel.pitch[1], kFloat);
  EXPECT_NEAR(rotate(taxel.X_SP.rotation, {0, 0, 1})[0], 1, kRounding);
}

std::string meshError(const Mesh& mesh) {
  return support::refusal([&] { taxelsOfMesh(mesh); });
}

TEST(TaxelMesh, RejectsTrianglesThatMakeNoTaxel) {
  const std::vector<std::array<float, 3>> square{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  EXPECT_NE(meshError({square, {{0, 1, 2}}}).find("triangle 0 has no other"), std::string::npos);
  EXPECT_NE(meshError({square, {{0, 1, 2}, {0, 2, 3}, {0, 1, 3}}}).find("triangle 2 has no other"), std::string::npos);
  EXPECT_NE(meshError({square, {{0, 1, 2}, {0, 3, 2}}}).find("looks inwards"), std::string::npos);
  EXPECT_NE(meshError({{{0, 0, 0}, {1, 0, 0}, {1, 1, 0.5}, {0, 1, 0}}, {{0, 1, 3}, {1, 2, 3}}}).find("bent"), std::string::npos);
  EXPECT_NE(meshError({{{0, 0, 0}, {2, 0, 0}, {0.5, 0.5, 0}, {0, 2, 0}}, {{0, 1, 2}, {0, 2, 3}}}).find("not convex"), std::string::npos);
  EXPECT_EQ(meshError({{{0, 0, 0}, {1, 0, 0}, {1, 1, 0.2f}, {0, 1, 0}}, {{0, 1, 3}, {1, 2, 3}}}), support::kNoRefusal)
      << "bent by 16 degrees";
}

}  // namespace
}  // namespace taxelsim
