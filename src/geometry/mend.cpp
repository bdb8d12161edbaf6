#include "geometry/mend.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "base/vector3.h"
#include "geometry/weld.h"

namespace taxelsim {
namespace {

constexpr double kAnywhere = std::numeric_limits<double>::infinity();

// Smooth meshes take 5, scans up to 19; where some places are left after these, it was simplified too far.
constexpr int kMaxRounds = 20;

// Boxes and triangles to look at, per triangle of the original: smooth meshes take 400, scans up to 3,000. Ends what is made to take long.
constexpr std::uint64_t kMaxEffort = 10'000;

}  // namespace

// Sorted by their ends, edges that triangles share stand side by side.
bool Mender::isBefore(const Edge& a, const Edge& b) {
  return std::pair(a.low, a.high) < std::pair(b.low, b.high);
}

Mender::Mender(const Mesh& original, double max_error)
    : original_(original), tree_(original), max_error_(max_error), effort_{.max = kMaxEffort * original.triangles.size()} {
  std::vector<bool> is_used(original.vertices.size(), false);
  for (const Triangle& triangle : original.triangles) {
    for (const std::uint32_t vertex : triangle) is_used[vertex] = true;
  }
  for (std::uint32_t vertex = 0; vertex < is_used.size(); ++vertex) {
    if (is_used[vertex]) vertices_.push_back(vertex);
  }
  draft_.vertices = original.vertices;
}

std::optional<std::vector<Mender::Triangle>> Mender::mend(std::vector<Triangle> triangles, std::size_t max_triangles) {
  draft_.triangles = std::move(triangles);
  is_within_.assign(draft_.triangles.size(), false);
  is_in_draft_.assign(original_.vertices.size(), false);
  for (const Triangle& triangle : draft_.triangles) {
    for (const std::uint32_t vertex : triangle) is_in_draft_[vertex] = true;
  }
  for (int round = 0; round < kMaxRounds && !draft_.triangles.empty() && draft_.triangles.size() <= max_triangles; ++round) {
    const TriangleTree tree(draft_);
    faults_.assign(draft_.triangles.size(), {});
    has_faults_ = false;
    // Vertices first: that is quick, and tells which faults are the worst.
    findVerticesBeyond(tree);
    if (!has_faults_) findTrianglesBeyond(tree);
    if (isExhausted()) return {};
    if (!has_faults_) return std::move(draft_.triangles);
    if (!mendFaults()) return {};
  }
  return {};
}

void Mender::findVerticesBeyond(const TriangleTree& tree) {
  for (std::size_t i = 0; i < vertices_.size() && !isExhausted(); ++i) {
    const Vector3 place = positionOf(vertices_[i]);
    const std::optional<TriangleTree::Nearest> nearest = tree.nearest(place, kAnywhere, effort_);
    if (nearest->distance <= max_error_) continue;
    has_faults_ = true;
    Fault& fault = faults_[nearest->triangle];
    if (nearest->distance > fault.distance) fault = {nearest->distance, vertices_[i], place};
  }
}

// What is proven of a triangle of the draft stays so, since the original does not change; the way back must be proven against all of it.
void Mender::findTrianglesBeyond(const TriangleTree& tree) {
  BoundCheck original_near_draft(tree, max_error_, effort_);
  for (std::uint32_t triangle = 0; triangle < original_.triangles.size() && !isExhausted(); ++triangle) {
    const std::optional<Vector3> place = original_near_draft.findBeyond(tree_.corners(triangle));
    if (place) addFault(tree.nearest(*place, kAnywhere, effort_)->triangle, original_.triangles[triangle], *place);
  }
  BoundCheck draft_near_original(tree_, max_error_, effort_);
  for (std::uint32_t triangle = 0; triangle < draft_.triangles.size() && !isExhausted(); ++triangle) {
    if (is_within_[triangle]) continue;
    const std::optional<Vector3> place = draft_near_original.findBeyond(tree.corners(triangle));
    is_within_[triangle] = !place;
    if (place) addFault(triangle, original_.triangles[tree_.nearest(*place, kAnywhere, effort_)->triangle], *place);
  }
}

// The draft's `triangle` needs a corner of `missing`, a triangle of the original: of those that the draft lacks the one nearest to `place`.
void Mender::addFault(std::uint32_t triangle, const Triangle& missing, const Vector3& place) {
  has_faults_ = true;
  Fault& fault = faults_[triangle];
  if (fault.distance > 0) return;
  fault = {max_error_, {}, place};
  double nearest = kAnywhere;
  for (const std::uint32_t vertex : missing) {
    const Vector3 corner = positionOf(vertex);
    const double squared = squaredDistance(place, {corner, corner, corner});
    if (is_in_draft_[vertex] || squared >= nearest) continue;
    nearest = squared;
    fault.vertex = vertex;
  }
}

// The worst faults first. A triangle is changed once a round: what its neighbours need may be different afterwards. False when nothing
// could be changed.
bool Mender::mendFaults() {
  std::vector<std::uint32_t> order;
  edges_.clear();
  for (std::uint32_t triangle = 0; triangle < draft_.triangles.size(); ++triangle) {
    const auto& [a, b, c] = draft_.triangles[triangle];
    edges_.insert(edges_.end(), {{a, b, triangle}, {b, c, triangle}, {c, a, triangle}});
    if (faults_[triangle].distance > 0) order.push_back(triangle);
  }
  std::stable_sort(edges_.begin(), edges_.end(), isBefore);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return faults_[a].distance > faults_[b].distance; });
  is_changed_.assign(draft_.triangles.size(), false);
  bool any = false;
  for (const std::uint32_t triangle : order) {
    if (is_changed_[triangle]) continue;
    any = (faults_[triangle].vertex ? insertVertex(triangle) : turnEdge(triangle)) || any;
  }
  return any;
}

// At the edge nearest to the fault, where all triangles that share it are cut; inside the triangle where no edge will do.
bool Mender::insertVertex(std::uint32_t triangle) {
  const Fault& fault = faults_[triangle];
  const std::uint32_t vertex = *fault.vertex;
  if (is_in_draft_[vertex]) return false;  // a fault nearby has brought it
  std::span<const Edge> best;
  double nearest = kAnywhere;
  for (const Edge& edge : edgesOf(triangle)) {
    const std::span<const Edge> sharing = sharingOf(edge);
    const double squared = squaredDistanceTo(edge, fault.place);
    if (sharing.size() < 2 || squared >= nearest) continue;  // an edge of a single triangle stays
    const auto canBeCut = [&](const Edge& shared) {
      const std::array<Triangle, 2> halves = halvesOf(shared, vertex);
      return is_changed_[shared.triangle] || (hasArea(halves[0]) && hasArea(halves[1]));
    };
    if (!std::all_of(sharing.begin(), sharing.end(), canBeCut)) continue;
    nearest = squared;
    best = sharing;
  }
  if (std::any_of(best.begin(), best.end(), [&](const Edge& shared) { return is_changed_[shared.triangle]; })) return false;
  for (const Edge& shared : best) replace(shared.triangle, halvesOf(shared, vertex));
  if (best.empty()) {
    const auto& [a, b, c] = draft_.triangles[triangle];
    const std::array<Triangle, 3> parts{{{a, b, vertex}, {b, c, vertex}, {c, a, vertex}}};
    if (!std::all_of(parts.begin(), parts.end(), [&](const Triangle& part) { return hasArea(part); })) return false;
    replace(triangle, parts);
  }
  is_in_draft_[vertex] = true;
  return true;
}

// Where all vertices are there already, the draft joins them in another way than the original. Of the edges that can be turned the one
// nearest to the fault, a-b, becomes c-d:
//
//       c               c
//      / \             /|\     both triangles
//     a---b    ->     a | b    stay between the
//      \ /             \|/     same four corners
//       d               d
bool Mender::turnEdge(std::uint32_t triangle) {
  const Fault& fault = faults_[triangle];
  std::optional<std::uint32_t> best_other;
  std::array<Triangle, 2> best;
  double nearest = kAnywhere;
  for (const Edge& edge : edgesOf(triangle)) {
    const std::span<const Edge> sharing = sharingOf(edge);
    const double squared = squaredDistanceTo(edge, fault.place);
    if (sharing.size() != 2 || squared >= nearest) continue;
    const std::uint32_t other = sharing[0].triangle == triangle ? sharing[1].triangle : sharing[0].triangle;
    std::array<Triangle, 2> turned{draft_.triangles[triangle], draft_.triangles[other]};
    const std::uint32_t c = cornerOpposite(edge, turned[0]), d = cornerOpposite(edge, turned[1]);
    std::replace(turned[0].begin(), turned[0].end(), edge.low, d);
    std::replace(turned[1].begin(), turned[1].end(), edge.high, c);
    const bool is_new = sharingOf({c, d, triangle}).empty();
    if (is_changed_[other] || !is_new || !hasArea(turned[0]) || !hasArea(turned[1])) continue;
    nearest = squared;
    best_other = other;
    best = turned;
  }
  if (!best_other) return false;
  replace(triangle, {&best[0], 1});
  replace(*best_other, {&best[1], 1});
  return true;
}

std::array<Mender::Edge, 3> Mender::edgesOf(std::uint32_t triangle) const {
  const auto& [a, b, c] = draft_.triangles[triangle];
  return {Edge{a, b, triangle}, {b, c, triangle}, {c, a, triangle}};
}

// As they were when the round began.
std::span<const Mender::Edge> Mender::sharingOf(const Edge& edge) const {
  const auto [begin, end] = std::equal_range(edges_.begin(), edges_.end(), edge, isBefore);
  return {begin, end};
}

double Mender::squaredDistanceTo(const Edge& edge, const Vector3& place) const {
  const Vector3 end = positionOf(edge.high);
  return squaredDistance(place, {positionOf(edge.low), end, end});
}

std::uint32_t Mender::cornerOpposite(const Edge& edge, const Triangle& triangle) {
  return *std::find_if(triangle.begin(), triangle.end(), [&](std::uint32_t corner) { return corner != edge.low && corner != edge.high; });
}

// The triangle of an edge, cut from a point of the edge, which becomes `vertex`, to the corner on its other side.
std::array<Mender::Triangle, 2> Mender::halvesOf(const Edge& edge, std::uint32_t vertex) const {
  std::array<Triangle, 2> halves{draft_.triangles[edge.triangle], draft_.triangles[edge.triangle]};
  std::replace(halves[0].begin(), halves[0].end(), edge.low, vertex);
  std::replace(halves[1].begin(), halves[1].end(), edge.high, vertex);
  return halves;
}

void Mender::replace(std::uint32_t triangle, std::span<const Triangle> parts) {
  is_changed_[triangle] = true;
  is_within_[triangle] = false;
  draft_.triangles[triangle] = parts[0];
  draft_.triangles.insert(draft_.triangles.end(), parts.begin() + 1, parts.end());
  is_within_.resize(draft_.triangles.size(), false);
}

bool Mender::hasArea(const Triangle& t) const {
  return taxelsim::hasArea(draft_.vertices[t[0]], draft_.vertices[t[1]], draft_.vertices[t[2]]);
}

Vector3 Mender::positionOf(std::uint32_t vertex) const {
  const std::array<float, 3>& position = original_.vertices[vertex];
  return {position[0], position[1], position[2]};
}

}  // namespace taxelsim
