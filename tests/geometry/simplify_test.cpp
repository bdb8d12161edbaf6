// Simplification: the bound holds by an independent measure, the number of triangles falls as documented, and degenerate input is handled.
#include "geometry/simplify.h"

#include "geometry/brute_force_distance.h"
#include "geometry/is_within.h"
#include "geometry/mesh_files.h"
#include "geometry/weld.h"
#include "reference/samples.h"
#include "support/embree_oracle.h"
#include "support/random_scene.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using support::Random;

Mesh ellipsoid(const Vector3& size, int num_subdivisions) {
  Random random(1);
  Mesh mesh = support::icosphere(0.5, num_subdivisions, 0, random);
  for (auto& vertex : mesh.vertices) {
    for (std::size_t axis = 0; axis < 3; ++axis) vertex[axis] *= static_cast<float>(size[axis]);
  }
  return mesh;
}

// An ellipsoid of 20 x 14 x 12 mm with 81,920 triangles, and its simplification at 10 um.
constexpr Vector3 kSize{0.020, 0.014, 0.012};
constexpr double kMaxError = 1e-5;

const Mesh& fineEllipsoid() {
  static const Mesh mesh = ellipsoid(kSize, 6);
  return mesh;
}
const Mesh& simplifiedEllipsoid() {
  static const Mesh mesh = simplifyMesh(fineEllipsoid(), kMaxError);
  return mesh;
}

// A sheet with a smooth height and straight boundaries.
Mesh wavySheet(int num_cells, double size, double height, Random& random) {
  Mesh mesh = support::sheetWithHoles(num_cells, size, 0, 0, random);
  const double phase = random.uniform(0, 6), waves = random.uniform(0.3, 2) * 2 * std::numbers::pi / size;
  for (auto& v : mesh.vertices) v[2] = static_cast<float>(height * std::sin(waves * v[0] + phase) * std::cos(waves * v[1]));
  return mesh;
}

Mesh merged(const Mesh& a, const Mesh& b) {
  Mesh both = a;
  both.vertices.insert(both.vertices.end(), b.vertices.begin(), b.vertices.end());
  const auto first = static_cast<std::uint32_t>(a.vertices.size());
  for (const auto& [i, j, k] : b.triangles) both.triangles.push_back({first + i, first + j, first + k});
  return both;
}

// A box of side 2 cm, each face in num_cells x num_cells cells.
Mesh fineBox(int num_cells) {
  Random random(1);
  const Mesh face = support::sheetWithHoles(num_cells, 0.02, 0, 0, random);
  Mesh box;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const float side : {-0.01f, 0.01f}) {
      Mesh rotated = face;
      for (auto& v : rotated.vertices) {
        const std::array<float, 3> p = v;
        v[axis] = side;
        v[(axis + 1) % 3] = p[0];
        v[(axis + 2) % 3] = p[1];
      }
      if (side < 0) {
        for (auto& t : rotated.triangles) std::swap(t[1], t[2]);
      }
      box = merged(box, rotated);
    }
  }
  return weld(box);
}

// Boundary edges (those with one triangle), by the positions of their ends.
std::set<std::pair<Corner, Corner>> boundaryOf(const Mesh& mesh) {
  std::map<std::pair<Corner, Corner>, int> count;
  for (const auto& t : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) ++count[std::minmax(mesh.vertices.at(t[i]), mesh.vertices.at(t[(i + 1) % 3]))];
  }
  std::set<std::pair<Corner, Corner>> boundary;
  for (const auto& [edge, triangles] : count) {
    if (triangles == 1) boundary.insert(edge);
  }
  return boundary;
}

bool isUnchanged(const Mesh& result, const Mesh& mesh) {
  return result.vertices == mesh.vertices && result.triangles == mesh.triangles;
}

// Proves the bound again for the final mesh. The tolerance covers rounding, since welding reorders the vertices.
bool isProven(const Mesh& result, const Mesh& mesh, double max_error) {
  return isUnchanged(result, mesh) || (isWithin(result, mesh, max_error * (1 + 1e-6)) && isWithin(mesh, result, max_error * (1 + 1e-6)));
}

// Invariants of every result. The distance of random points of both surfaces is measured by brute force.
void expectWithinBound(const Mesh& result, const Mesh& mesh, double max_error, int num_points, Random& random) {
  ASSERT_NO_THROW(checkObject(result));
  EXPECT_LE(result.triangles.size(), mesh.triangles.size());
  const std::set<Corner> vertices(mesh.vertices.begin(), mesh.vertices.end());
  for (const Corner& vertex : result.vertices) ASSERT_TRUE(vertices.contains(vertex));
  EXPECT_TRUE(isProven(result, mesh, max_error));
  EXPECT_LE(sampledDistance(mesh, result, num_points, random, max_error), max_error);
  EXPECT_LE(sampledDistance(result, mesh, num_points, random, max_error), max_error);
}

TEST(Simplify, RemovesNineTenthsOfAnEllipsoid) {
  const Mesh& mesh = simplifiedEllipsoid();
  EXPECT_EQ(fineEllipsoid().triangles.size(), 81920u);
  EXPECT_LT(mesh.triangles.size(), 8192u);
  Random random(1);
  expectWithinBound(mesh, fineEllipsoid(), kMaxError, 200, random);
}

TEST(Simplify, ErrorIsCloseToTheBound) {
  Random random(2);
  EXPECT_GT(sampledDistance(fineEllipsoid(), simplifiedEllipsoid(), 500, random), kMaxError / 2);
  // The number of triangles is about inversely proportional to the bound.
  EXPECT_LT(simplifyMesh(fineEllipsoid(), 10 * kMaxError).triangles.size(), simplifiedEllipsoid().triangles.size() / 5);
}

TEST(Simplify, ZeroKeepsEveryTriangle) {
  EXPECT_TRUE(isUnchanged(simplifyMesh(fineEllipsoid(), 0), fineEllipsoid()));
}

TEST(Simplify, ReturnsTheOriginalWhereFewTrianglesCanBeRemoved) {
  const Mesh coarse = ellipsoid(kSize, 2);
  EXPECT_TRUE(isUnchanged(simplifyMesh(coarse, 1e-6), coarse));
  const Mesh few = fineBox(2);  // 48 triangles; 12 would suffice
  EXPECT_TRUE(isUnchanged(simplifyMesh(few, 1e-5), few));
}

TEST(Simplify, IsDeterministic) {
  const Mesh mesh = ellipsoid(kSize, 5);
  const Mesh once = simplifyMesh(mesh, kMaxError);
  EXPECT_LT(once.triangles.size(), mesh.triangles.size());
  EXPECT_TRUE(isUnchanged(simplifyMesh(mesh, kMaxError), once));
}

TEST(Simplify, MergesCoplanarTriangles) {
  const Mesh box = fineBox(20);
  ASSERT_EQ(box.triangles.size(), 4800u);
  const Mesh result = simplifyMesh(box, 1e-6);
  EXPECT_LE(result.triangles.size(), 24u);
  EXPECT_EQ(boundsOf(result).min, boundsOf(box).min);
  EXPECT_EQ(boundsOf(result).max, boundsOf(box).max);
  Random random(3);
  expectWithinBound(result, box, 1e-6, 300, random);
}

TEST(Simplify, KeepsBoundaryEdges) {
  Random random(4);
  for (const double hole_probability : {0.0, 0.02}) {
    const Mesh sheet = weld(support::sheetWithHoles(40, 0.02, 2e-6, hole_probability, random));
    const Mesh result = simplifyMesh(sheet, kMaxError);
    EXPECT_LT(result.triangles.size(), sheet.triangles.size() * 8 / 10);
    EXPECT_EQ(boundaryOf(result), boundaryOf(sheet));
    expectWithinBound(result, sheet, kMaxError, 300, random);
  }
}

// A rough surface whose triangles are about as large as the bound: takes most rounds of repair, and edge flips.
TEST(Simplify, RepairsScansAtCoarseBounds) {
  const std::string objects = std::string(TAXELSIM_SOURCE_DIR) + "/scenes/objects/";
  Random random(8);
  for (const char* name : {"YcbBanana.obj", "YcbMustardBottle.obj"}) {
    const Mesh scan = loadMesh(objects + name, {.max_depth_error = 0});
    for (const double max_error : {5e-5, 3e-4}) {
      const Mesh result = simplifyMesh(scan, max_error);
      EXPECT_LT(result.triangles.size(), scan.triangles.size() * 8 / 10);
      expectWithinBound(result, scan, max_error, 100, random);
    }
  }
}

TEST(Simplify, IgnoresUnusedVertices) {
  Mesh box = fineBox(10);
  box.vertices.push_back({0, 0, 0});  // 1 cm from the surface
  EXPECT_LE(simplifyMesh(box, 1e-6).triangles.size(), 24u);
}

TEST(Simplify, HandlesNonManifoldAndDegenerateMeshes) {
  Random random(5);
  const Mesh sphere = ellipsoid(kSize, 3);
  Mesh doubled = sphere;
  doubled.triangles.insert(doubled.triangles.end(), sphere.triangles.begin(), sphere.triangles.end());
  Mesh fins = sphere;  // every edge of every tenth triangle has a third triangle
  for (std::size_t t = 0; t < sphere.triangles.size(); t += 10) {
    const auto& [a, b, c] = sphere.triangles[t];
    for (const auto& [i, j] : {std::pair{a, b}, {b, c}, {c, a}}) fins.triangles.push_back({i, j, 0});
  }
  Mesh slivers;  // 10 mm long, down to 1e-20 m wide
  for (int n = 0; n <= 200; ++n) {
    const float y = n == 0 ? 0 : static_cast<float>(std::pow(10, -20 + 0.1 * n));
    slivers.vertices.push_back({0, y, 0});
    slivers.vertices.push_back({0.01f, y, 0});
  }
  for (std::uint32_t n = 0; n < 400; ++n) slivers.triangles.push_back({n, n + 1, n + 2});
  const std::vector<Mesh> meshes = {weld(doubled),
                                    weld(fins),
                                    weld(slivers),
                                    weld(merged(sphere, fineBox(10))),
                                    weld(support::triangleSoup(500, 0.01, random)),
                                    weld(support::sheetWithHoles(20, 0.02, 1e-3, 0.4, random))};
  for (std::size_t n = 0; n < meshes.size(); ++n) {
    for (const double max_error : {1e-12, 1e-7, 1e-5, 1e-4, 1e-3, 0.1, 1e30, 1e300}) {
      SCOPED_TRACE(::testing::Message() << "mesh " << n << " at " << max_error);
      expectWithinBound(simplifyMesh(meshes[n], max_error), meshes[n], max_error, 60, random);
    }
  }
}

// From subnormal to the largest float32 coordinates.
TEST(Simplify, WorksAtAnyScale) {
  Random random(6);
  const Mesh sphere = support::icosphere(1, 3, 0, random);
  for (const double scale : {1e-44, 1e-38, 1e-30, 1e-9, 1e-3, 1e3, 1e30, 3e38}) {
    SCOPED_TRACE(scale);
    Mesh mesh = sphere;
    for (auto& vertex : mesh.vertices) {
      for (float& coordinate : vertex) coordinate = static_cast<float>(scale * coordinate);
    }
    mesh = weld(mesh);
    if (mesh.triangles.empty()) continue;
    for (const double relative : {1e-9, 0.05, 10.0}) {
      const Mesh result = simplifyMesh(mesh, relative * scale);
      expectWithinBound(result, mesh, relative * scale, 60, random);
      const bool is_in_range = scale > 1e-37 && scale < 1e37;
      if (relative == 0.05 && is_in_range) {
        EXPECT_LT(result.triangles.size(), mesh.triangles.size() / 2);
      }
    }
  }
}

RC_GTEST_PROP(SimplifyRandomMeshes, AreWithinTheBound, (std::uint32_t seed)) {
  Random random(seed);
  const double size = std::pow(10, random.uniform(-3, 0));
  Mesh mesh;
  switch (random.integer(0, 4)) {
    case 0:
      mesh = support::icosphere(size / 2, 3, random.chance(0.5) ? 0 : std::pow(10, random.uniform(-4, -1)), random);
      for (auto& vertex : mesh.vertices) vertex[0] *= static_cast<float>(random.uniform(0.95, 1.05));
      break;
    case 1:
      mesh = wavySheet(random.integer(8, 24), size, random.uniform(0, 0.2) * size, random);
      break;
    case 2:
      mesh =
          support::sheetWithHoles(random.integer(8, 24), size, std::pow(10, random.uniform(-5, -2)) * size, random.uniform(0, 0.2), random);
      break;
    case 3:
      mesh = merged(support::triangleSoup(random.integer(30, 200), size, random), ellipsoid({size, size, size / 2}, 2));
      break;
    default:
      mesh = merged(wavySheet(12, size, 0.1 * size, random), ellipsoid({size, size / 2, size / 2}, 3));
  }
  mesh = weld(mesh);
  const double max_error = std::pow(10, random.uniform(-4.5, -1)) * size;
  const Mesh result = simplifyMesh(mesh, max_error);
  RC_CLASSIFY(result.triangles.size() < mesh.triangles.size());
  RC_ASSERT(10 * result.triangles.size() <= 9 * mesh.triangles.size() || isUnchanged(result, mesh));
  RC_ASSERT(boundaryOf(result) == boundaryOf(mesh));
  checkObject(result);
  RC_ASSERT(isProven(result, mesh, max_error));
  RC_ASSERT(sampledDistance(mesh, result, 200, random, max_error) <= max_error);
  RC_ASSERT(sampledDistance(result, mesh, 200, random, max_error) <= max_error);
}

// Compares depths by ray casting against the full and the simplified mesh, at the same samples.
TEST(Simplify, DepthErrorIsAtMostTheBoundOverTheCosineOfTheSlope) {
  // Error of Embree's heights: 1e-6 of the scene's size of 0.02 m (embree_oracle.h), for either mesh.
  constexpr double kRayTolerance = 2 * 1e-6 * 0.02;
  // The angle between a triangle of the full mesh and the ellipsoid is less than the longest edge (0.25 mm) times the largest curvature
  // (half of 20 mm over the square of half of 12 mm, 278 / m): 0.07 rad.
  constexpr double kMaxNormalError = 0.07;
  constexpr double kMaxSlope = std::numbers::pi / 3;
  const Object full(fineEllipsoid()), simple(simplifiedEllipsoid());
  Random random(7);
  std::size_t num_compared = 0;
  double largest = 0;
  for (int n = 0; n < 20; ++n) {
    const Quaternion R_SO = random.rotation();
    const Pose X_SO{{random.uniform(-1e-3, 1e-3), random.uniform(-1e-3, 1e-3), 0}, R_SO};
    const GridPatch patch{"rays", 24, 24, {7.3e-4, 7.3e-4}, {}};
    const reference::PlacedObject placed_full{&full, X_SO}, placed_simple{&simple, X_SO};
    const std::vector<double> before = support::embreeHeights(patch, 2, {&placed_full, 1});
    const std::vector<double> after = support::embreeHeights(patch, 2, {&placed_simple, 1});
    Sensor sensor;
    sensor.patches = {patch};
    sensor.samples_per_taxel = 2;
    const std::vector<reference::Sample> samples = reference::samplesOf(sensor);
    ASSERT_EQ(samples.size(), before.size());
    for (std::size_t s = 0; s < samples.size(); ++s) {
      if (!std::isfinite(before[s])) continue;
      // The ellipsoid's normal at the hit: the gradient of sum (x_i / a_i)^2.
      const Vector3 hit = inverse(X_SO) * Vector3{samples[s].position_P[0], samples[s].position_P[1], before[s]};
      Vector3 gradient;
      for (std::size_t axis = 0; axis < 3; ++axis) gradient[axis] = hit[axis] / (kSize[axis] * kSize[axis]);
      const Vector3 normal = rotate(R_SO, gradient);
      const double slope = std::atan2(std::hypot(normal[0], normal[1]), -normal[2]);
      if (slope > kMaxSlope) continue;
      ++num_compared;
      largest = std::max(largest, std::abs(after[s] - before[s]) * std::cos(slope));
      ASSERT_NEAR(after[s], before[s], kMaxError / std::cos(slope + kMaxNormalError) + kRayTolerance);
    }
  }
  EXPECT_GT(num_compared, 3000u);
  EXPECT_GT(largest, kMaxError / 2);
}

}  // namespace
}  // namespace taxelsim
