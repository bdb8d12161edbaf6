

#include "geometry/mesh_files.h"
#include "support/test.h"

namespace taxelsim {
namespace {

// Without simplification.
constexpr MeshOptions kFull{.max_depth_error = 0};

const std::filesystem::path kDirectory = std::filesystem::path(TAXELSIM_SOURCE_DIR) / "scenes" / "objects";

// Six times the enclosed volume (divergence theorem); positive if triangles are counter-clockwise seen from outside.
double sixVolumes(const Mesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles) {
    const Corner &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    sum += a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
  }
  return sum;
}

// Every directed edge occurs once, and so does its reverse.
bool isClosed(const Mesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const auto& t : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) ++edges[{t[i], t[(i + 1) % 3]}];
  }
  return std::all_of(edges.begin(), edges.end(), [&](const auto& edge) {
    const auto opposite = edges.find({edge.first.second, edge.first.first});
    return edge.second == 1 && opposite != edges.end() && opposite->second == 1;
  });
}

// m. The files have 9 decimals; coordinates are float32.
constexpr double kTolerance = 4e-9;

TEST(SceneObjects, HexPrism) {
  const Mesh mesh = loadMesh(kDirectory / "hex_prism.obj");
  EXPECT_EQ(mesh.triangles.size(), 24u);
  EXPECT_TRUE(isClosed(mesh));
  // Area of a hexagon 12 mm across its flats: 2 sqrt(3) 6^2 mm^2. The sum is in float32, over 24 terms.
  EXPECT_NEAR(sixVolumes(mesh) / 6, 2 * std::sqrt(3.0) * 36e-6 * 0.06, 1e-5 * 7.5e-6);
  const Vector3 flat = lowestPoint(mesh, {1, 0, 0, 0});
  EXPECT_NEAR(flat[1], 0, kTolerance);
  EXPECT_NEAR(flat[2], -0.006, kTolerance);
  const double edge = rotate(axisAngle({1, 0, 0}, std::numbers::pi / 6), lowestPoint(mesh, axisAngle({1, 0, 0}, std::numbers::pi / 6)))[2];
  EXPECT_NEAR(edge, -0.006 / std::cos(std::numbers::pi / 6), kTolerance);
}

TEST(SceneObjects, EdgeBar) {
  const Mesh mesh = loadMesh(kDirectory / "edge_bar.obj");
  EXPECT_EQ(mesh.triangles.size(), 16u);
  EXPECT_TRUE(isClosed(mesh));
  EXPECT_NEAR(sixVolumes(mesh) / 6, 0.012 * 0.012 * 0.06, 1e-5 * 8.64e-6);
  const Vector3 edge = lowestPoint(mesh, {1, 0, 0, 0});
  EXPECT_NEAR(edge[0], 0, kTolerance);
  EXPECT_NEAR(edge[2], -0.012 / std::sqrt(2.0), kTolerance);
}

TEST(SceneObjects, Knob) {
  const Mesh mesh = loadMesh(kDirectory / "knob_5k.obj", kFull);
  EXPECT_EQ(mesh.triangles.size(), 5120u);
  EXPECT_EQ(mesh.vertices.size(), 2562u);
  EXPECT_TRUE(isClosed(mesh));
  EXPECT_GT(sixVolumes(mesh), 0);
  const Bounds bounds = boundsOf(mesh);
  // The subdivided icosahedron has vertices on all axes, so the bounds are the half-axes.
  EXPECT_NEAR(bounds.max[0], 0.022, kTolerance);
  EXPECT_NEAR(bounds.max[1], 0.010, kTolerance);
  EXPECT_NEAR(bounds.max[2], 0.009, kTolerance);
}

TEST(SceneObjects, ScansAndBunny) {
  for (const char* name : {"YcbBanana.obj", "YcbMustardBottle.obj", "YcbPowerDrill.obj"}) {
    const Mesh mesh = loadMesh(kDirectory / name, kFull);
    EXPECT_GT(mesh.triangles.size(), 15000u) << name;
    EXPECT_LT(boundsOf(mesh).max[2], 0.3) << name;
    EXPECT_NO_THROW(checkObject(mesh));
  }
  EXPECT_EQ(loadMesh(kDirectory / "bunny.obj", kFull).vertices.size(), 1839u);
}

}  // namespace
}  // namespace taxelsim
