#include "geometry/clusters.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <tuple>

#include "geometry/mesh_bounds.h"

namespace taxelsim {
namespace {

// Unused steps around the mesh, so that boxes can be rounded outwards to a coarser unit without overflow.
constexpr std::uint32_t kLatticeMargin = 128;

constexpr std::uint32_t kLatticeMiddle = 1u << (kLatticeBits - 1);

// Sorts `items` so that every run of `run_size` consecutive items is spatially compact: recursive median splits of the centroids along the
// longest side of their bounding box, at multiples of `run_size`.
void sortIntoRuns(std::span<std::uint32_t> items, const std::vector<std::array<std::uint32_t, 3>>& centroids, std::size_t run_size) {
  if (items.size() <= run_size) return;
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
  const std::size_t num_runs = (items.size() + run_size - 1) / run_size;
  const std::size_t middle = (num_runs + 1) / 2 * run_size;
  std::nth_element(items.begin(), items.begin() + static_cast<std::ptrdiff_t>(middle), items.end(), [&](std::uint32_t a, std::uint32_t b) {
    return centroids[a][axis] != centroids[b][axis] ? centroids[a][axis] < centroids[b][axis] : a < b;
  });
  sortIntoRuns(items.first(middle), centroids, run_size);
  sortIntoRuns(items.subspan(middle), centroids, run_size);
}

void extend(ClusterBox& box, const LatticePoint& point) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    box.low[axis] = std::min(box.low[axis], point[axis]);
    box.high[axis] = std::max(box.high[axis], point[axis]);
  }
}

ClusterBox emptyBox(std::size_t first) {
  return {{~0u, ~0u, ~0u}, {0, 0, 0}, static_cast<std::uint32_t>(first), 0};
}

// Adds a cluster to the box of its group.
void extend(ClusterBox& box, const ClusterBox& cluster) {
  extend(box, cluster.low);
  extend(box, cluster.high);
  ++box.count;
}

std::vector<std::span<std::uint32_t>> runsOf(std::span<std::uint32_t> items, std::size_t size) {
  std::vector<std::span<std::uint32_t>> runs;
  for (std::size_t start = 0; start < items.size(); start += size) {
    runs.push_back(items.subspan(start, std::min(size, items.size() - start)));
  }
  return runs;
}

using Triangle = std::array<std::uint32_t, 3>;

double squaredLength(const LatticePoint& a, const LatticePoint& b) {
  double sum = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double side = static_cast<double>(a[axis]) - static_cast<double>(b[axis]);
    sum += side * side;
  }
  return sum;
}

constexpr std::uint32_t kNoNeighbor = ~0u;

// Adjacency: result[t][k] is the triangle across the edge from corner k of triangle t to the next corner, or kNoNeighbor.
std::vector<Triangle> neighborsOf(const std::vector<Triangle>& triangles) {
  struct Edge {
    std::uint32_t low, high, triangle, corner;
  };
  std::vector<Edge> edges;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(triangles[t][k], triangles[t][(k + 1) % 3]);
      edges.push_back({low, high, t, k});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
    return std::tie(a.low, a.high, a.triangle, a.corner) < std::tie(b.low, b.high, b.triangle, b.corner);
  });
  std::vector<Triangle> neighbors(triangles.size(), {kNoNeighbor, kNoNeighbor, kNoNeighbor});
  for (std::size_t e = 0; e + 1 < edges.size(); ++e) {
    const Edge &a = edges[e], &b = edges[e + 1];
    if (a.low != b.low || a.high != b.high || a.triangle == b.triangle) continue;
    neighbors[a.triangle][a.corner] = b.triangle;
    neighbors[b.triangle][b.corner] = a.triangle;
    ++e;
  }
  return neighbors;
}

// Greedy matching of adjacent triangles; returns the corners of the quads. Triangles with a single unmatched neighbor are matched first,
// which leaves few unmatched (R. M. Karp, M. Sipser, "Maximum matchings in sparse random graphs", FOCS 1981). Among several neighbors the
// one across the longest edge is taken, since that quad has the smallest box.
std::vector<std::array<std::uint32_t, 4>> pairTriangles(const std::vector<Triangle>& triangles, const std::vector<LatticePoint>& points) {
  const std::vector<Triangle> neighbors = neighborsOf(triangles);
  std::vector<bool> taken(triangles.size(), false);
  const auto isFree = [&](std::uint32_t t) { return t != kNoNeighbor && !taken[t]; };
  const auto numFree = [&](std::uint32_t t) { return std::count_if(neighbors[t].begin(), neighbors[t].end(), isFree); };
  std::vector<std::array<std::uint32_t, 4>> quads;
  std::vector<std::uint32_t> urgent;
  const auto match = [&](std::uint32_t t) {
    const Triangle& corners = triangles[t];
    std::size_t across = 3;
    double longest = -1;
    for (std::size_t k = 0; k < 3; ++k) {
      const double length = squaredLength(points[corners[k]], points[corners[(k + 1) % 3]]);
      if (isFree(neighbors[t][k]) && length > longest) across = k, longest = length;
    }
    taken[t] = true;
    if (across == 3) {
      quads.push_back({corners[0], corners[1], corners[2], corners[2]});
      return;
    }
    const std::uint32_t other = neighbors[t][across];
    taken[other] = true;
    const std::uint32_t q = corners[across], r = corners[(across + 1) % 3];
    const std::uint32_t s =
        *std::find_if(triangles[other].begin(), triangles[other].end(), [&](std::uint32_t c) { return c != q && c != r; });
    quads.push_back({corners[(across + 2) % 3], q, r, s});
    for (const std::uint32_t matched : {t, other}) {
      for (const std::uint32_t next : neighbors[matched]) {
        if (isFree(next) && numFree(next) == 1) urgent.push_back(next);
      }
    }
  };
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    if (!taken[t]) match(t);
    while (!urgent.empty()) {
      const std::uint32_t next = urgent.back();
      urgent.pop_back();
      if (!taken[next]) match(next);
    }
  }
  return quads;
}

}  // namespace

ClusteredMesh clusterMesh(const Mesh& mesh) {
  ClusteredMesh result;
  const auto [low, high] = meshBounds(mesh);
  const double extent = std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2], 1e-9});
  result.step = extent / ((1u << kLatticeBits) - kLatticeMargin);
  for (std::size_t axis = 0; axis < 3; ++axis) result.middle[axis] = (low[axis] + high[axis]) / 2;

  std::vector<LatticePoint> points(mesh.vertices.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double q = std::round((mesh.vertices[i][axis] - result.middle[axis]) / result.step) + kLatticeMiddle;
      points[i][axis] = static_cast<std::uint32_t>(std::clamp<double>(q, 0, (1u << kLatticeBits) - 1));
    }
  }
  std::vector<Quad> quads;
  for (const std::array<std::uint32_t, 4>& corners : pairTriangles(mesh.triangles, points)) {
    quads.push_back({points[corners[0]], points[corners[1]], points[corners[2]], points[corners[3]]});
  }
  std::vector<std::array<std::uint32_t, 3>> centroids(quads.size());
  for (std::size_t i = 0; i < quads.size(); ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (const LatticePoint& point : quads[i]) centroids[i][axis] += point[axis];
    }
  }
  std::vector<std::uint32_t> order(quads.size());
  std::iota(order.begin(), order.end(), 0u);
  // Groups first, then clusters within each group, so that every cluster belongs to one group.
  constexpr std::size_t kQuadsPerGroup = std::size_t{kQuadsPerCluster} * kClustersPerGroup;
  sortIntoRuns(order, centroids, kQuadsPerGroup);
  for (const std::span<std::uint32_t> group : runsOf(order, kQuadsPerGroup)) {
    sortIntoRuns(group, centroids, kQuadsPerCluster);
    ClusterBox group_box = emptyBox(result.clusters.size());
    for (const std::span<std::uint32_t> cluster : runsOf(group, kQuadsPerCluster)) {
      ClusterBox box = emptyBox(result.quads.size());
      for (const std::uint32_t quad : cluster) {
        result.quads.push_back(quads[quad]);
        for (const LatticePoint& point : quads[quad]) extend(box, point);
      }
      box.count = static_cast<std::uint32_t>(cluster.size());
      result.clusters.push_back(box);
      extend(group_box, box);
    }
    result.groups.push_back(group_box);
  }
  return result;
}

Mesh latticeMesh(const ClusteredMesh& clustered) {
  Mesh mesh;
  for (const Quad& quad : clustered.quads) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const LatticePoint& point : quad) {
      std::array<float, 3>& vertex = mesh.vertices.emplace_back();
      for (std::size_t axis = 0; axis < 3; ++axis) {
        vertex[axis] = static_cast<float>(clustered.middle[axis] + clustered.step * (static_cast<double>(point[axis]) - kLatticeMiddle));
      }
    }
    mesh.triangles.push_back({first, first + 1, first + 2});
    if (quad[3] != quad[2]) mesh.triangles.push_back({first + 2, first + 1, first + 3});
  }
  return mesh;
}

}  // namespace taxelsim
