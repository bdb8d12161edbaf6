#include "geometry/clusters.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>

namespace taxelsim {
namespace {

// Steps left free around the mesh, so that boxes can be rounded outwards to coarser units.
constexpr std::uint32_t kLatticeRim = 128;

constexpr std::uint32_t kLatticeMiddle = 1u << (kLatticeBits - 1);

// Orders `items` so that every run of `leaf` consecutive ones lies close together: halves at a multiple of `leaf`, by the centroid along
// the longest side, until a run is left. Ties keep the order of the indices, which makes the result unique.
void sortIntoRuns(std::span<std::uint32_t> items, const std::vector<std::array<std::uint32_t, 3>>& centroids, std::size_t leaf) {
  if (items.size() <= leaf) return;
  std::array<std::uint32_t, 3> low{~0u, ~0u, ~0u};
  std::array<std::uint32_t, 3> high{0, 0, 0};
  for (const std::uint32_t item : items) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], centroids[item][axis]);
      high[axis] = std::max(high[axis], centroids[item][axis]);
    }
  }
  std::size_t axis = 0;
  for (std::size_t other = 1; other < 3; ++other) {
    if (high[other] - low[other] > high[axis] - low[axis]) axis = other;
  }
  const std::size_t runs = (items.size() + leaf - 1) / leaf;
  const std::size_t middle = (runs + 1) / 2 * leaf;
  std::nth_element(items.begin(), items.begin() + static_cast<std::ptrdiff_t>(middle), items.end(), [&](std::uint32_t a, std::uint32_t b) {
    return centroids[a][axis] != centroids[b][axis] ? centroids[a][axis] < centroids[b][axis] : a < b;
  });
  sortIntoRuns(items.first(middle), centroids, leaf);
  sortIntoRuns(items.subspan(middle), centroids, leaf);
}

void addToBox(const LatticePoint& point, ClusterBox& box) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    box.low[axis] = std::min(box.low[axis], point[axis]);
    box.high[axis] = std::max(box.high[axis], point[axis]);
  }
}

ClusterBox emptyBox(std::size_t first, std::size_t count) {
  return {{~0u, ~0u, ~0u}, {0, 0, 0}, static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(count)};
}

}  // namespace

ClusteredMesh clusterMesh(const Mesh& mesh) {
  ClusteredMesh result;
  Vector3 low{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  Vector3 high{-low[0], -low[1], -low[2]};
  for (const std::array<std::uint32_t, 3>& triangle : mesh.triangles) {
    for (const std::uint32_t index : triangle) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        low[axis] = std::min<double>(low[axis], mesh.vertices[index][axis]);
        high[axis] = std::max<double>(high[axis], mesh.vertices[index][axis]);
      }
    }
  }
  const double extent = std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2], 1e-9});
  result.step = extent / ((1u << kLatticeBits) - kLatticeRim);
  for (std::size_t axis = 0; axis < 3; ++axis) result.middle[axis] = (low[axis] + high[axis]) / 2;

  std::vector<LatticePoint> points(mesh.vertices.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double q = std::round((mesh.vertices[i][axis] - result.middle[axis]) / result.step) + kLatticeMiddle;
      points[i][axis] = static_cast<std::uint32_t>(std::clamp<double>(q, 0, (1u << kLatticeBits) - 1));
    }
  }
  std::vector<std::array<std::uint32_t, 3>> centroids(mesh.triangles.size());
  for (std::size_t i = 0; i < centroids.size(); ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (const std::uint32_t index : mesh.triangles[i]) centroids[i][axis] += points[index][axis];
    }
  }
  std::vector<std::uint32_t> order(mesh.triangles.size());
  std::iota(order.begin(), order.end(), 0u);
  // Runs of a group first, then runs of a cluster within each, so that groups hold whole clusters.
  constexpr std::size_t kTrianglesPerGroup = std::size_t{kTrianglesPerCluster} * kClustersPerGroup;
  sortIntoRuns(order, centroids, kTrianglesPerGroup);
  for (std::size_t start = 0; start < order.size(); start += kTrianglesPerGroup) {
    const std::span<std::uint32_t> group = std::span(order).subspan(start, std::min(kTrianglesPerGroup, order.size() - start));
    sortIntoRuns(group, centroids, kTrianglesPerCluster);
    ClusterBox group_box = emptyBox(result.clusters.size(), (group.size() + kTrianglesPerCluster - 1) / kTrianglesPerCluster);
    for (std::size_t run = 0; run < group.size(); run += kTrianglesPerCluster) {
      const std::span<std::uint32_t> cluster = group.subspan(run, std::min<std::size_t>(kTrianglesPerCluster, group.size() - run));
      ClusterBox box = emptyBox(result.triangles.size(), cluster.size());
      for (const std::uint32_t triangle : cluster) {
        const std::array<std::uint32_t, 3>& indices = mesh.triangles[triangle];
        result.triangles.push_back({points[indices[0]], points[indices[1]], points[indices[2]]});
        for (const LatticePoint& point : result.triangles.back()) {
          addToBox(point, box);
          addToBox(point, group_box);
        }
      }
      result.clusters.push_back(box);
    }
    result.groups.push_back(group_box);
  }
  return result;
}

Mesh latticeMesh(const ClusteredMesh& clustered) {
  Mesh mesh;
  for (const std::array<LatticePoint, 3>& triangle : clustered.triangles) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const LatticePoint& point : triangle) {
      std::array<float, 3>& vertex = mesh.vertices.emplace_back();
      for (std::size_t axis = 0; axis < 3; ++axis) {
        vertex[axis] = static_cast<float>(clustered.middle[axis] + clustered.step * (static_cast<double>(point[axis]) - kLatticeMiddle));
      }
    }
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

}  // namespace taxelsim
