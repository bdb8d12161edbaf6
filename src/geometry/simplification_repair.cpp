#include "geometry/simplification_repair.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "base/constants.h"
#include "base/vector3.h"
#include "geometry/weld.h"

namespace taxelsim {
namespace {

// Smooth meshes take 5 rounds, scans up to 19. Violations that remain after 20 mean that the target error was too large.
constexpr int kMaxRounds = 20;

// Boxes and triangles visited per triangle of the original. Smooth meshes take 400, scans up to 3,000. Bounds the time for malicious files.
constexpr std::uint64_t kMaxVisitsPerTriangle = 10'000;

// The same for a whole mesh: about a minute. A mesh of millions of triangles that takes more is left as it is.
constexpr std::uint64_t kMaxVisits = 1'000'000'000;

// What building a tree and sorting the edges takes, in visits per triangle.
constexpr std::uint64_t kVisitsPerRound = 20;

}  // namespace

bool SimplificationRepair::isBefore(const Edge& a, const Edge& b) {
  return std::pair(a.low, a.high) < std::pair(b.low, b.high);
}

SimplificationRepair::SimplificationRepair(const Mesh& original, double max_error)
    : original_(original),
      original_tree_(original),
      max_error_(max_error),
      budget_{.max = std::min(kMaxVisits, kMaxVisitsPerTriangle * original.triangles.size()), .stop = stopOfThisThread()} {
  std::vector<bool> is_used(original.vertices.size(), false);
  for (const Triangle& triangle : original.triangles) {
    for (const std::uint32_t vertex : triangle) is_used[vertex] = true;
  }
  for (std::uint32_t vertex = 0; vertex < is_used.size(); ++vertex) {
    if (is_used[vertex]) vertices_.push_back(vertex);
  }
  simplified_.vertices = original.vertices;
}

std::optional<std::vector<SimplificationRepair::Triangle>> SimplificationRepair::run(std::vector<Triangle> triangles,
                                                                                     std::size_t max_triangles) {
  simplified_.triangles = std::move(triangles);
  is_proven_.assign(simplified_.triangles.size(), false);
  is_used_.assign(original_.vertices.size(), false);
  for (const Triangle& triangle : simplified_.triangles) {
    for (const std::uint32_t vertex : triangle) is_used_[vertex] = true;
  }
  for (int round = 0; round < kMaxRounds && !simplified_.triangles.empty() && simplified_.triangles.size() <= max_triangles; ++round) {
    budget_.spent += kVisitsPerRound * simplified_.triangles.size();
    const TriangleTree tree(simplified_);
    violations_.assign(simplified_.triangles.size(), {});
    has_violations_ = false;
    // Vertices first: this is cheap and finds the largest violations.
    findViolationsAtVertices(tree);
    if (!has_violations_) findViolationsOfTriangles(tree);
    if (isExhausted()) return {};
    if (!has_violations_) return std::move(simplified_.triangles);
    if (!repairViolations()) return {};
  }
  return {};
}

void SimplificationRepair::findViolationsAtVertices(const TriangleTree& tree) {
  for (std::size_t i = 0; i < vertices_.size() && !isExhausted(); ++i) {
    if (is_used_[vertices_[i]]) continue;  // at distance 0
    const Vector3 point = positionOf(vertices_[i]);
    const std::optional<TriangleTree::Nearest> nearest = tree.nearest(point, kInfinity, budget_);
    if (nearest->distance <= max_error_) continue;
    has_violations_ = true;
    Violation& violation = violations_[nearest->triangle];
    if (nearest->distance > violation.distance) violation = {nearest->distance, vertices_[i], point};
  }
}

// A proven triangle of the simplified mesh stays proven until it is changed, since the original is constant. The other direction must be
// proven again in each round.
void SimplificationRepair::findViolationsOfTriangles(const TriangleTree& tree) {
  HausdorffBound original_to_simplified(tree, max_error_, budget_);
  for (std::uint32_t triangle = 0; triangle < original_.triangles.size() && !isExhausted(); ++triangle) {
    const std::optional<Vector3> point = original_to_simplified.findViolation(original_tree_.corners(triangle));
    if (point) addViolation(tree.nearest(*point, kInfinity, budget_)->triangle, original_.triangles[triangle], *point);
  }
  HausdorffBound simplified_to_original(original_tree_, max_error_, budget_);
  for (std::uint32_t triangle = 0; triangle < simplified_.triangles.size() && !isExhausted(); ++triangle) {
    if (is_proven_[triangle]) continue;
    const std::optional<Vector3> point = simplified_to_original.findViolation(tree.corners(triangle));
    is_proven_[triangle] = !point;
    if (point) addViolation(triangle, original_.triangles[original_tree_.nearest(*point, kInfinity, budget_)->triangle], *point);
  }
}

// Records a violation of `triangle`. The vertex to insert is the corner of the nearest original triangle that is nearest to `point` among
// those that the simplified mesh does not use.
void SimplificationRepair::addViolation(std::uint32_t triangle, const Triangle& nearest_original, const Vector3& point) {
  has_violations_ = true;
  Violation& violation = violations_[triangle];
  if (violation.distance > 0) return;
  violation = {max_error_, {}, point};
  double nearest = kInfinity;
  for (const std::uint32_t vertex : nearest_original) {
    const Vector3 corner = positionOf(vertex);
    const double squared = squaredDistance(point, {corner, corner, corner});
    if (is_used_[vertex] || squared >= nearest) continue;
    nearest = squared;
    violation.vertex = vertex;
  }
}

// Repairs the largest violations first, each triangle at most once a round: a repair may resolve violations nearby. Returns false if no
// triangle could be changed.
bool SimplificationRepair::repairViolations() {
  std::vector<std::uint32_t> order;
  edges_.clear();
  for (std::uint32_t triangle = 0; triangle < simplified_.triangles.size(); ++triangle) {
    const auto& [a, b, c] = simplified_.triangles[triangle];
    edges_.insert(edges_.end(), {{a, b, triangle}, {b, c, triangle}, {c, a, triangle}});
    if (violations_[triangle].distance > 0) order.push_back(triangle);
  }
  std::stable_sort(edges_.begin(), edges_.end(), isBefore);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return violations_[a].distance > violations_[b].distance; });
  is_changed_.assign(simplified_.triangles.size(), false);
  bool any = false;
  for (const std::uint32_t triangle : order) {
    if (is_changed_[triangle]) continue;
    any = (violations_[triangle].vertex ? insertVertex(triangle) : flipEdge(triangle)) || any;
  }
  return any;
}

// Inserts the missing vertex at the edge nearest to the violation and splits all triangles that share the edge, or inside the triangle if
// no edge can be split without a degenerate triangle.
bool SimplificationRepair::insertVertex(std::uint32_t triangle) {
  const Violation& violation = violations_[triangle];
  const std::uint32_t vertex = *violation.vertex;
  if (is_used_[vertex]) return false;  // inserted for a neighbour
  std::span<const Edge> best;
  double nearest = kInfinity;
  for (const Edge& edge : edgesOf(triangle)) {
    const std::span<const Edge> sharing = edgesEqualTo(edge);
    const double squared = squaredDistanceTo(edge, violation.point);
    if (sharing.size() < 2 || squared >= nearest) continue;  // boundary edges are kept
    const auto canBeSplit = [&](const Edge& shared) {
      const std::array<Triangle, 2> halves = splitAtEdge(shared, vertex);
      return is_changed_[shared.triangle] || (hasArea(halves[0]) && hasArea(halves[1]));
    };
    if (!std::all_of(sharing.begin(), sharing.end(), canBeSplit)) continue;
    nearest = squared;
    best = sharing;
  }
  if (std::any_of(best.begin(), best.end(), [&](const Edge& shared) { return is_changed_[shared.triangle]; })) return false;
  for (const Edge& shared : best) replace(shared.triangle, splitAtEdge(shared, vertex));
  if (best.empty()) {
    const auto& [a, b, c] = simplified_.triangles[triangle];
    const std::array<Triangle, 3> parts{{{a, b, vertex}, {b, c, vertex}, {c, a, vertex}}};
    if (!std::all_of(parts.begin(), parts.end(), [&](const Triangle& part) { return hasArea(part); })) return false;
    replace(triangle, parts);
  }
  is_used_[vertex] = true;
  return true;
}

// For violations without a missing vertex: flips the edge a-b nearest to the violation to c-d, if both new triangles have an area and c-d
// is no edge yet.
//
//       c                c
//      / \              /|\       .
//     a---b     ->     a | b
//      \ /              \|/
//       d                d
bool SimplificationRepair::flipEdge(std::uint32_t triangle) {
  const Violation& violation = violations_[triangle];
  std::optional<std::uint32_t> best_other;
  std::array<Triangle, 2> best;
  double nearest = kInfinity;
  for (const Edge& edge : edgesOf(triangle)) {
    const std::span<const Edge> sharing = edgesEqualTo(edge);
    const double squared = squaredDistanceTo(edge, violation.point);
    if (sharing.size() != 2 || squared >= nearest) continue;
    const std::uint32_t other = sharing[0].triangle == triangle ? sharing[1].triangle : sharing[0].triangle;
    std::array<Triangle, 2> flipped{simplified_.triangles[triangle], simplified_.triangles[other]};
    const std::uint32_t c = cornerOpposite(edge, flipped[0]), d = cornerOpposite(edge, flipped[1]);
    std::replace(flipped[0].begin(), flipped[0].end(), edge.low, d);
    std::replace(flipped[1].begin(), flipped[1].end(), edge.high, c);
    const bool is_new = edgesEqualTo({c, d, triangle}).empty();
    if (is_changed_[other] || !is_new || !hasArea(flipped[0]) || !hasArea(flipped[1])) continue;
    nearest = squared;
    best_other = other;
    best = flipped;
  }
  if (!best_other) return false;
  replace(triangle, {&best[0], 1});
  replace(*best_other, {&best[1], 1});
  return true;
}

std::array<SimplificationRepair::Edge, 3> SimplificationRepair::edgesOf(std::uint32_t triangle) const {
  const auto& [a, b, c] = simplified_.triangles[triangle];
  return {Edge{a, b, triangle}, {b, c, triangle}, {c, a, triangle}};
}

// All entries of edges_ for the same pair of vertices: one per triangle that shared the edge at the start of the round.
std::span<const SimplificationRepair::Edge> SimplificationRepair::edgesEqualTo(const Edge& edge) const {
  const auto [begin, end] = std::equal_range(edges_.begin(), edges_.end(), edge, isBefore);
  return {begin, end};
}

double SimplificationRepair::squaredDistanceTo(const Edge& edge, const Vector3& point) const {
  const Vector3 end = positionOf(edge.high);
  return squaredDistance(point, {positionOf(edge.low), end, end});
}

std::uint32_t SimplificationRepair::cornerOpposite(const Edge& edge, const Triangle& triangle) {
  return *std::find_if(triangle.begin(), triangle.end(), [&](std::uint32_t corner) { return corner != edge.low && corner != edge.high; });
}

// Splits the edge's triangle in two, from `vertex` inserted in the edge to the opposite corner.
std::array<SimplificationRepair::Triangle, 2> SimplificationRepair::splitAtEdge(const Edge& edge, std::uint32_t vertex) const {
  std::array<Triangle, 2> halves{simplified_.triangles[edge.triangle], simplified_.triangles[edge.triangle]};
  std::replace(halves[0].begin(), halves[0].end(), edge.low, vertex);
  std::replace(halves[1].begin(), halves[1].end(), edge.high, vertex);
  return halves;
}

void SimplificationRepair::replace(std::uint32_t triangle, std::span<const Triangle> parts) {
  is_changed_[triangle] = true;
  is_proven_[triangle] = false;
  simplified_.triangles[triangle] = parts[0];
  simplified_.triangles.insert(simplified_.triangles.end(), parts.begin() + 1, parts.end());
  is_proven_.resize(simplified_.triangles.size(), false);
}

bool SimplificationRepair::hasArea(const Triangle& t) const {
  return taxelsim::hasArea(simplified_.vertices[t[0]], simplified_.vertices[t[1]], simplified_.vertices[t[2]]);
}

Vector3 SimplificationRepair::positionOf(std::uint32_t vertex) const {
  const std::array<float, 3>& position = original_.vertices[vertex];
  return {position[0], position[1], position[2]};
}

}  // namespace taxelsim
