// Clusters: every triangle once, inside its boxes, with its vertices within half a lattice step.
#include "geometry/clusters.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace taxelsim {
namespace {

Mesh shipped(const char* name) {
  return loadMesh(std::string(TAXELSIM_SOURCE_DIR) + "/scenes/objects/" + name);
}

// Corners of all triangles, sorted, as a mesh's content without its order.
std::vector<std::array<std::array<float, 3>, 3>> contentOf(const Mesh& mesh) {
  std::vector<std::array<std::array<float, 3>, 3>> content;
  for (const auto& t : mesh.triangles) content.push_back({mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]});
  return content;
}

bool inside(const ClusterBox& box, const LatticePoint& point) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (point[axis] < box.low[axis] || point[axis] > box.high[axis]) return false;
  }
  return true;
}

TEST(Clusters, HoldEveryTriangleOnceInsideTheirBoxes) {
  for (const char* name : {"hex_prism.obj", "knob_5k.obj", "bunny.obj"}) {
    const Mesh mesh = shipped(name);
    const ClusteredMesh clustered = clusterMesh(mesh);
    ASSERT_EQ(clustered.triangles.size(), mesh.triangles.size()) << name;
    std::uint32_t next_cluster = 0, next_triangle = 0;
    for (const ClusterBox& group : clustered.groups) {
      ASSERT_EQ(group.first, next_cluster);
      ASSERT_LE(group.count, kClustersPerGroup);
      next_cluster += group.count;
      for (std::uint32_t c = group.first; c < group.first + group.count; ++c) {
        const ClusterBox& cluster = clustered.clusters[c];
        ASSERT_EQ(cluster.first, next_triangle);
        ASSERT_GE(cluster.count, 1u);
        ASSERT_LE(cluster.count, kTrianglesPerCluster);
        next_triangle += cluster.count;
        for (std::uint32_t t = cluster.first; t < cluster.first + cluster.count; ++t) {
          for (const LatticePoint& point : clustered.triangles[t]) ASSERT_TRUE(inside(cluster, point) && inside(group, point)) << name;
        }
      }
    }
    EXPECT_EQ(next_cluster, clustered.clusters.size());
    EXPECT_EQ(next_triangle, clustered.triangles.size());
  }
}

TEST(Clusters, MoveVerticesByHalfALatticeStepAtMost) {
  const Mesh mesh = shipped("knob_5k.obj");
  const ClusteredMesh clustered = clusterMesh(mesh);
  const Mesh back = latticeMesh(clustered);
  const Bounds bounds = boundsOf(Object(Shape(mesh)));
  EXPECT_LT(clustered.step, 1.1e-6 * (bounds.max[0] - bounds.min[0] + bounds.max[1] - bounds.min[1] + bounds.max[2] - bounds.min[2]));
  // Half a step and the rounding of a float32 coordinate, of at most 0.1 m.
  const double tolerance = clustered.step / 2 + 0.1 * 0x1p-24;
  std::vector<std::array<float, 3>> vertices;
  for (const auto& triangle : contentOf(mesh)) vertices.insert(vertices.end(), triangle.begin(), triangle.end());
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

TEST(Clusters, AreTheSameEveryTime) {
  const Mesh mesh = shipped("bunny.obj");
  const ClusteredMesh a = clusterMesh(mesh), b = clusterMesh(mesh);
  EXPECT_EQ(a.triangles, b.triangles);
}

TEST(Clusters, OfOneFlatTriangleAreFine) {
  const Mesh mesh{{{0, 0, 0}, {0.01f, 0, 0}, {0, 0.01f, 0}}, {{0, 1, 2}}};
  const ClusteredMesh clustered = clusterMesh(mesh);
  EXPECT_EQ(clustered.groups.size(), 1u);
  EXPECT_EQ(clustered.clusters.size(), 1u);
}

}  // namespace
}  // namespace taxelsim
