#include "geometry/clusters.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <tuple>

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

ClusterBox emptyBox(std::size_t first) {
  return {{~0u, ~0u, ~0u}, {0, 0, 0}, static_cast<std::uint32_t>(first), 0};
}

// The next one that a box of the level above holds.
void addToBox(const ClusterBox& part, ClusterBox& box) {
  addToBox(part.low, box);
  addToBox(part.high, box);
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

// The triangles across the edges of each: neighbours[t][k] lies across the edge from corner k to the next.
constexpr std::uint32_t kNobody = ~0u;
std::vector<Triangle> neighboursOf(const std::vector<Triangle>& triangles) {
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
  std::vector<Triangle> neighbours(triangles.size(), {kNobody, kNobody, kNobody});
  for (std::size_t e = 0; e + 1 < edges.size(); ++e) {
    const Edge &a = edges[e], &b = edges[e + 1];
    if (a.low != b.low || a.high != b.high || a.triangle == b.triangle) continue;
    neighbours[a.triangle][a.corner] = b.triangle;
    neighbours[b.triangle][b.corner] = a.triangle;
    ++e;
  }
  return neighbours;
}

// Corners of quads that hold every triangle once. A triangle with a single free neighbour goes first, which leaves few alone (Karp and
// Sipser, "Maximum matchings in sparse random graphs", 1981); of several neighbours the one across the longest edge, since that
// quad's box is the smallest.
std::vector<std::array<std::uint32_t, 4>> pairTriangles(const std::vector<Triangle>& triangles, const std::vector<LatticePoint>& points) {
  const std::vector<Triangle> neighbours = neighboursOf(triangles);
  std::vector<bool> taken(triangles.size(), false);
  const auto isFree = [&](std::uint32_t t) { return t != kNobody && !taken[t]; };
  const auto numFree = [&](std::uint32_t t) { return std::count_if(neighbours[t].begin(), neighbours[t].end(), isFree); };
  std::vector<std::array<std::uint32_t, 4>> quads;
  std::vector<std::uint32_t> urgent;
  const auto pair = [&](std::uint32_t t) {
    const Triangle& corners = triangles[t];
    std::size_t across = 3;
    double longest = -1;
    for (std::size_t k = 0; k < 3; ++k) {
      const double length = squaredLength(points[corners[k]], points[corners[(k + 1) % 3]]);
      if (isFree(neighbours[t][k]) && length > longest) across = k, longest = length;
    }
    taken[t] = true;
    if (across == 3) {
      quads.push_back({corners[0], corners[1], corners[2], corners[2]});
      return;
    }
    const std::uint32_t other = neighbours[t][across];
    taken[other] = true;
    const std::uint32_t q = corners[across], r = corners[(across + 1) % 3];
    const std::uint32_t s =
        *std::find_if(triangles[other].begin(), triangles[other].end(), [&](std::uint32_t c) { return c != q && c != r; });
    quads.push_back({corners[(across + 2) % 3], q, r, s});
    for (const std::uint32_t done : {t, other}) {
      for (const std::uint32_t next : neighbours[done]) {
        if (isFree(next) && numFree(next) == 1) urgent.push_back(next);
      }
    }
  };
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    if (!taken[t]) pair(t);
    while (!urgent.empty()) {
      const std::uint32_t next = urgent.back();
      urgent.pop_back();
      if (!taken[next]) pair(next);
    }
  }
  return quads;
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
  // Runs of a group first, then runs of a cluster within each, so that a group holds whole clusters.
  constexpr std::size_t kQuadsPerGroup = std::size_t{kQuadsPerCluster} * kClustersPerGroup;
  sortIntoRuns(order, centroids, kQuadsPerGroup);
  for (const std::span<std::uint32_t> group : runsOf(order, kQuadsPerGroup)) {
    sortIntoRuns(group, centroids, kQuadsPerCluster);
    ClusterBox group_box = emptyBox(result.clusters.size());
    for (const std::span<std::uint32_t> cluster : runsOf(group, kQuadsPerCluster)) {
      ClusterBox box = emptyBox(result.quads.size());
      for (const std::uint32_t quad : cluster) {
        result.quads.push_back(quads[quad]);
        for (const LatticePoint& point : quads[quad]) addToBox(point, box);
      }
      box.count = static_cast<std::uint32_t>(cluster.size());
      result.clusters.push_back(box);
      addToBox(box, group_box);
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
