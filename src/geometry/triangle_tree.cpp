#include "geometry/triangle_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "base/vector3.h"

namespace taxelsim {
namespace {

constexpr std::uint32_t kLeafSize = 4;

// Capacity of the traversal stack: at most 32 levels for fewer than 2^32 triangles, one pending child per level.
constexpr std::size_t kStackSize = 34;

double squaredDistanceToBox(const Vector3& point, const std::array<float, 3>& low, const std::array<float, 3>& high) {
  double sum = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double outside = std::max(0.0, std::max(low[axis] - point[axis], point[axis] - high[axis]));
    sum += outside * outside;
  }
  return sum;
}

}  // namespace

TriangleCorners cornersOf(const Mesh& mesh, std::uint32_t triangle) {
  TriangleCorners corners;
  for (std::size_t corner = 0; corner < 3; ++corner) {
    const std::array<float, 3>& vertex = mesh.vertices[mesh.triangles[triangle][corner]];
    corners[corner] = {vertex[0], vertex[1], vertex[2]};
  }
  return corners;
}

// Closest point by Voronoi regions (C. Ericson, Real-Time Collision Detection, 2005, section 5.1.5). The barycentric coordinates are
// clamped, so that rounding never moves the point out of the triangle.
double squaredDistance(const Vector3& point, const TriangleCorners& triangle) {
  const auto& [a, b, c] = triangle;
  const Vector3 ab = subtract(b, a), ac = subtract(c, a), ap = subtract(point, a);
  const auto squaredTo = [&](double weight_b, double weight_c) {
    const Vector3 difference = subtract(ap, add(scale(weight_b, ab), scale(weight_c, ac)));
    return dot(difference, difference);
  };
  const double ab_ap = dot(ab, ap), ac_ap = dot(ac, ap);
  if (ab_ap <= 0 && ac_ap <= 0) return squaredTo(0, 0);
  const Vector3 bp = subtract(point, b);
  const double ab_bp = dot(ab, bp), ac_bp = dot(ac, bp);
  if (ab_bp >= 0 && ac_bp <= ab_bp) return squaredTo(1, 0);
  const Vector3 cp = subtract(point, c);
  const double ab_cp = dot(ab, cp), ac_cp = dot(ac, cp);
  if (ac_cp >= 0 && ab_cp <= ac_cp) return squaredTo(0, 1);

  const auto ratio = [](double part, double whole) { return whole > 0 ? std::clamp(part / whole, 0.0, 1.0) : 0.0; };
  const double area_c = ab_ap * ac_bp - ab_bp * ac_ap;
  if (area_c <= 0 && ab_ap >= 0 && ab_bp <= 0) return squaredTo(ratio(ab_ap, ab_ap - ab_bp), 0);
  const double area_b = ab_cp * ac_ap - ab_ap * ac_cp;
  if (area_b <= 0 && ac_ap >= 0 && ac_cp <= 0) return squaredTo(0, ratio(ac_ap, ac_ap - ac_cp));
  const double area_a = ab_bp * ac_cp - ab_cp * ac_bp;
  if (area_a <= 0 && ac_bp >= ab_bp && ab_cp >= ac_cp) {
    const double weight_c = ratio(ac_bp - ab_bp, (ac_bp - ab_bp) + (ab_cp - ac_cp));
    return squaredTo(1 - weight_c, weight_c);
  }
  const double area = area_a + area_b + area_c;
  const double weight_b = ratio(area_b, area);
  return squaredTo(weight_b, std::min(ratio(area_c, area), 1 - weight_b));
}

TriangleTree::TriangleTree(const Mesh& mesh) {
  if (mesh.triangles.empty()) return;
  order_.resize(mesh.triangles.size());
  std::iota(order_.begin(), order_.end(), 0u);
  corners_.reserve(order_.size());
  for (const std::uint32_t triangle : order_) corners_.push_back(cornersOf(mesh, triangle));
  build(mesh, 0, static_cast<std::uint32_t>(order_.size()));
}

// Splits at the median along the longest side of the centroids' bounding box. Ties are broken by index, so that the tree is deterministic.
void TriangleTree::build(const Mesh& mesh, std::uint32_t first, std::uint32_t end) {
  constexpr float kFar = std::numeric_limits<float>::infinity();
  const auto sumAlong = [&](std::uint32_t triangle, std::size_t axis) {
    const TriangleCorners& corners = corners_[triangle];
    return corners[0][axis] + corners[1][axis] + corners[2][axis];
  };
  Node node{{kFar, kFar, kFar}, {-kFar, -kFar, -kFar}, first, end - first};
  Vector3 low{kFar, kFar, kFar}, high{-kFar, -kFar, -kFar};  // bounds of three times the centroids
  for (std::uint32_t i = first; i < end; ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], sumAlong(order_[i], axis));
      high[axis] = std::max(high[axis], sumAlong(order_[i], axis));
      for (const std::uint32_t vertex : mesh.triangles[order_[i]]) {
        node.low[axis] = std::min(node.low[axis], mesh.vertices[vertex][axis]);
        node.high[axis] = std::max(node.high[axis], mesh.vertices[vertex][axis]);
      }
    }
  }
  const std::size_t index = nodes_.size();
  nodes_.push_back(node);
  if (node.count <= kLeafSize) return;

  std::size_t axis = 0;
  for (std::size_t other = 1; other < 3; ++other) {
    if (high[other] - low[other] > high[axis] - low[axis]) axis = other;
  }
  const std::uint32_t middle = first + node.count / 2;
  std::nth_element(order_.begin() + first, order_.begin() + middle, order_.begin() + end, [&](std::uint32_t a, std::uint32_t b) {
    const double sum_a = sumAlong(a, axis), sum_b = sumAlong(b, axis);
    return sum_a != sum_b ? sum_a < sum_b : a < b;
  });
  build(mesh, first, middle);
  nodes_[index].first = static_cast<std::uint32_t>(nodes_.size());
  nodes_[index].count = 0;
  build(mesh, middle, end);
}

std::optional<TriangleTree::Nearest> TriangleTree::nearest(const Vector3& point, double limit, SearchBudget& budget) const {
  if (nodes_.empty()) return {};
  struct Entry {
    std::uint32_t node;
    double squared_distance;
  };
  std::array<Entry, kStackSize> stack;
  std::size_t stack_size = 0;
  const auto push = [&](std::uint32_t node) {
    stack[stack_size++] = {node, squaredDistanceToBox(point, nodes_[node].low, nodes_[node].high)};
  };

  double best = limit * limit;
  std::optional<std::uint32_t> found;
  push(0);
  while (stack_size > 0) {
    const auto [index, squared_distance] = stack[--stack_size];
    ++budget.spent;
    if (squared_distance > best) continue;
    const Node& node = nodes_[index];
    if (node.count == 0) {
      push(node.first);
      push(index + 1);
      if (stack[stack_size - 1].squared_distance > stack[stack_size - 2].squared_distance) {
        std::swap(stack[stack_size - 1], stack[stack_size - 2]);
      }
      continue;
    }
    budget.spent += node.count;
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      const double squared = squaredDistance(point, corners_[order_[i]]);
      if (squared < best || (squared == best && !found)) {
        best = squared;
        found = order_[i];
      }
    }
  }
  if (!found) return {};
  return Nearest{*found, std::sqrt(best)};
}

double TriangleTree::largestCoordinate() const {
  double largest = 0;
  if (nodes_.empty()) return largest;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    largest = std::max<double>({largest, std::abs(nodes_[0].low[axis]), std::abs(nodes_[0].high[axis])});
  }
  return largest;
}

}  // namespace taxelsim
