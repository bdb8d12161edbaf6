#include "episodes/lowest_vertex.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <variant>

namespace taxelsim {
namespace {

constexpr std::uint32_t kLeafSize = 16;

// Tolerances of a level face; must equal those of lowestPoint(), which the tests verify.
constexpr double kLevelTolerance = 1e-6;  // rad
constexpr double kVertexRounding = 4 * static_cast<double>(std::numeric_limits<float>::epsilon());

double height(const std::array<float, 3>& vertex, const Vector3& u) {
  return u[0] * vertex[0] + u[1] * vertex[1] + u[2] * vertex[2];
}

}  // namespace

LowestVertex::LowestVertex(const Object& object) : object_(object) {
  const Mesh* mesh = std::get_if<Mesh>(&object.shape);
  if (!mesh || mesh->triangles.empty()) return;
  std::vector<bool> used(mesh->vertices.size(), false);
  for (const auto& triangle : mesh->triangles) {
    for (const std::uint32_t index : triangle) used[index] = true;
  }
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (used[i]) vertices_.push_back(mesh->vertices[i]);
  }
  build(0, static_cast<std::uint32_t>(vertices_.size()));

  double size = 0;
  double largest = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double low = nodes_[0].min[axis];
    const double high = nodes_[0].max[axis];
    size = std::hypot(size, high - low);
    largest = std::max({largest, std::abs(low), std::abs(high)});
  }
  slack_ = kLevelTolerance * size + kVertexRounding * largest;
}

void LowestVertex::build(std::uint32_t first, std::uint32_t end) {
  Node node{vertices_[first], vertices_[first], first, end, 0};
  for (std::uint32_t i = first; i < end; ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      node.min[axis] = std::min(node.min[axis], vertices_[i][axis]);
      node.max[axis] = std::max(node.max[axis], vertices_[i][axis]);
    }
  }
  const std::size_t index = nodes_.size();
  nodes_.push_back(node);
  if (end - first <= kLeafSize) return;

  std::size_t longest = 0;
  for (std::size_t axis = 1; axis < 3; ++axis) {
    if (node.max[axis] - node.min[axis] > node.max[longest] - node.min[longest]) longest = axis;
  }
  // Ties are broken by the whole vertex, so that the order of the sums is the same with every standard library.
  const std::uint32_t middle = first + (end - first) / 2;
  std::sort(vertices_.begin() + first, vertices_.begin() + end,
            [longest](const Vertex& a, const Vertex& b) { return a[longest] != b[longest] ? a[longest] < b[longest] : a < b; });
  build(first, middle);
  nodes_[index].right = static_cast<std::uint32_t>(nodes_.size());
  build(middle, end);
}

// Lower lowerBound on the height of the node's vertices. Exact in floating point: rounding is monotone, and the corner is summed in the
// order of height().
double LowestVertex::lowerBound(const Node& node, const Vector3& u) const {
  return height({u[0] > 0 ? node.min[0] : node.max[0], u[1] > 0 ? node.min[1] : node.max[1], u[2] > 0 ? node.min[2] : node.max[2]}, u);
}

void LowestVertex::findLowest(std::uint32_t index, const Vector3& u, double& lowest) const {
  const Node& node = nodes_[index];
  if (node.right == 0) {
    for (std::uint32_t i = node.first; i < node.end; ++i) lowest = std::min(lowest, height(vertices_[i], u));
    return;
  }
  std::uint32_t near = index + 1, far = node.right;
  double near_bound = lowerBound(nodes_[near], u), far_bound = lowerBound(nodes_[far], u);
  if (far_bound < near_bound) {
    std::swap(near, far);
    std::swap(near_bound, far_bound);
  }
  if (near_bound < lowest) findLowest(near, u, lowest);
  if (far_bound < lowest) findLowest(far, u, lowest);
}

void LowestVertex::sumBelow(std::uint32_t index, const Vector3& u, double level, Vector3& sum, double& count) const {
  const Node& node = nodes_[index];
  if (lowerBound(node, u) > level) return;
  if (node.right != 0) {
    sumBelow(index + 1, u, level, sum, count);
    sumBelow(node.right, u, level, sum, count);
    return;
  }
  for (std::uint32_t i = node.first; i < node.end; ++i) {
    if (height(vertices_[i], u) > level) continue;
    for (std::size_t axis = 0; axis < 3; ++axis) sum[axis] += vertices_[i][axis];
    ++count;
  }
}

Vector3 LowestVertex::find(const Quaternion& R_SO) const {
  if (vertices_.empty()) return lowestPoint(object_, R_SO);
  const std::array<double, 9> matrix = rotationMatrix(R_SO);
  const Vector3 u{matrix[6], matrix[7], matrix[8]};
  double lowest = std::numeric_limits<double>::infinity();
  findLowest(0, u, lowest);
  Vector3 sum{0, 0, 0};
  double count = 0;
  sumBelow(0, u, lowest + slack_, sum, count);
  return {sum[0] / count, sum[1] / count, sum[2] / count};
}

}  // namespace taxelsim
