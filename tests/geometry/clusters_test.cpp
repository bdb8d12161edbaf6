#include "geometry/clusters.h"
#include "support/test.h"

namespace taxelsim {
namespace {

Mesh sceneObject(const char* name) {
  return loadMesh(std::filesystem::path(TAXELSIM_SOURCE_DIR) / "scenes/objects" / name);
}

// Positions of the corners of all triangles.
std::vector<std::array<std::array<float, 3>, 3>> cornerPositions(const Mesh& mesh) {
  std::vector<std::array<std::array<float, 3>, 3>> positions;
  for (const auto& t : mesh.triangles) positions.push_back({mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]});
  return positions;
}

// Corners of all triangles in lattice steps relative to the middle; corners and triangles sorted.
std::vector<std::array<std::array<long, 3>, 3>> latticeCorners(const Mesh& mesh, const ClusteredMesh& clustered) {
  std::vector<std::array<std::array<long, 3>, 3>> all;
  for (const auto& triangle : mesh.triangles) {
    std::array<std::array<long, 3>, 3>& corners = all.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        corners[k][axis] = std::lround((mesh.vertices[triangle[k]][axis] - clustered.middle[axis]) / clustered.step);
      }
    }
    std::sort(corners.begin(), corners.end());
  }
  std::sort(all.begin(), all.end());
  return all;
}

bool contains(const ClusterBox& box, const LatticePoint& point) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (point[axis] < box.low[axis] || point[axis] > box.high[axis]) return false;
  }
  return true;
}

TEST(Clusters, ContainEveryTriangleOnce) {
  for (const char* name : {"hex_prism.obj", "knob_5k.obj", "bunny.obj"}) {
    const Mesh mesh = sceneObject(name);
    const ClusteredMesh clustered = clusterMesh(mesh);
    EXPECT_EQ(latticeCorners(latticeMesh(clustered), clustered), latticeCorners(mesh, clustered)) << name;
    std::uint32_t next_cluster = 0, next_quad = 0;
    for (const ClusterBox& group : clustered.groups) {
      ASSERT_EQ(group.first, next_cluster);
      ASSERT_GE(group.count, 1u);
      ASSERT_LE(group.count, kClustersPerGroup);
      next_cluster += group.count;
      for (std::uint32_t c = group.first; c < next_cluster; ++c) {
        const ClusterBox& cluster = clustered.clusters[c];
        ASSERT_EQ(cluster.first, next_quad);
        ASSERT_GE(cluster.count, 1u);
        ASSERT_LE(cluster.count, kQuadsPerCluster);
        next_quad += cluster.count;
        for (std::uint32_t q = cluster.first; q < next_quad; ++q) {
          for (const LatticePoint& point : clustered.quads[q]) ASSERT_TRUE(contains(cluster, point) && contains(group, point)) << name;
        }
      }
    }
    EXPECT_EQ(next_cluster, clustered.clusters.size());
    EXPECT_EQ(next_quad, clustered.quads.size());
  }
}

TEST(Clusters, QuantizeVerticesToTheNearestLatticePoint) {
  const Mesh mesh = sceneObject("knob_5k.obj");
  const ClusteredMesh clustered = clusterMesh(mesh);
  const Mesh back = latticeMesh(clustered);
  const Bounds bounds = boundsOf(Object(Shape(mesh)));
  EXPECT_LT(clustered.step, 1.1e-6 * (bounds.max[0] - bounds.min[0] + bounds.max[1] - bounds.min[1] + bounds.max[2] - bounds.min[2]));
  // Half a step, and the rounding of a float32 coordinate of at most 0.1 m.
  const double tolerance = clustered.step / 2 + 0.1 * 0x1p-24;
  std::vector<std::array<float, 3>> vertices;
  for (const auto& triangle : cornerPositions(mesh)) vertices.insert(vertices.end(), triangle.begin(), triangle.end());
  for (const std::array<float, 3>& vertex : back.vertices) {
    double nearest = 1;
    for (const std::array<float, 3>& other : vertices) {
      double distance = 0;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        distance = std::max(distance, std::abs(static_cast<double>(vertex[axis]) - static_cast<double>(other[axis])));
      }
      nearest = std::min(nearest, distance);
      if (nearest <= tolerance) break;
    }
    ASSERT_LE(nearest, tolerance);
  }
}

// In a closed mesh, where each triangle has three neighbors, a perfect matching exists (Petersen's theorem). The greedy matching
// is not perfect.
TEST(Clusters, LeaveFewTrianglesUnmatched) {
  constexpr double kMaxUnmatched = 0.05;  // fraction of the quads; measured: 0.6 % and 1.8 %
  for (const char* name : {"knob_5k.obj", "bunny.obj"}) {
    const std::vector<Quad> quads = clusterMesh(sceneObject(name)).quads;
    const auto unmatched = std::count_if(quads.begin(), quads.end(), [](const Quad& quad) { return quad[3] == quad[2]; });
    EXPECT_LE(static_cast<double>(unmatched), kMaxUnmatched * static_cast<double>(quads.size()))
        << name << ": " << unmatched << " of " << quads.size();
  }
}

TEST(Clusters, AreDeterministic) {
  const Mesh mesh = sceneObject("bunny.obj");
  const ClusteredMesh a = clusterMesh(mesh), b = clusterMesh(mesh);
  EXPECT_EQ(a.quads, b.quads);
}

TEST(Clusters, OfASingleTriangle) {
  const Mesh mesh{{{0, 0, 0}, {0.01f, 0, 0}, {0, 0.01f, 0}}, {{0, 1, 2}}};
  const ClusteredMesh clustered = clusterMesh(mesh);
  EXPECT_EQ(clustered.groups.size(), 1u);
  EXPECT_EQ(clustered.clusters.size(), 1u);
}

}  // namespace
}  // namespace taxelsim
