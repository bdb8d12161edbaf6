#include "sensor/taxel_mesh.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "base/text.h"
#include "base/vector3.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;
using Pair = std::array<std::size_t, 2>;

constexpr double kMostBend = 0.9396926207859084;  // cosine of 20 degrees

[[noreturn]] void fail(std::size_t triangle, const std::string& what) {
  throw Error(ErrorKind::kInput, "triangle " + std::to_string(triangle) + " " + what);
}

Vector3 vertex(const Mesh& mesh, std::uint32_t index) {
  const std::array<float, 3>& v = mesh.vertices[index];
  return {v[0], v[1], v[2]};
}

// The start corner, in each triangle, of the edge that two triangles share in opposite directions; none if there is no such edge.
std::optional<std::size_t> sharedEdge(const std::array<std::uint32_t, 3>& a, const std::array<std::uint32_t, 3>& b) {
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      if (a[i] == b[(j + 1) % 3] && a[(i + 1) % 3] == b[j]) return i;
    }
  }
  return {};
}

Edge longestEdge(const Mesh& mesh, const std::array<std::uint32_t, 3>& triangle) {
  Edge longest;
  double most = -1;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::uint32_t a = triangle[i], b = triangle[(i + 1) % 3];
    // From the lower to the higher number, so that both triangles find the same length.
    const double here = length(subtract(vertex(mesh, std::min(a, b)), vertex(mesh, std::max(a, b))));
    if (here > most) {
      most = here;
      longest = std::minmax(a, b);
    }
  }
  return longest;
}

std::vector<Pair> pairsByLongestEdge(const Mesh& mesh) {
  std::map<Edge, std::size_t> waiting;
  std::vector<Pair> pairs;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Edge edge = longestEdge(mesh, mesh.triangles[t]);
    const auto [entry, is_new] = waiting.try_emplace(edge, t);
    if (is_new) continue;
    pairs.push_back({entry->second, t});
    waiting.erase(entry);
  }
  if (!waiting.empty()) {
    std::size_t lone = mesh.triangles.size();
    for (const auto& [edge, t] : waiting) lone = std::min(lone, t);
    fail(lone, "has no other with which it makes a taxel: the next one shares no edge with it, nor does another share its longest edge");
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

std::vector<Pair> pairsOf(const Mesh& mesh) {
  std::vector<Pair> pairs;
  for (std::size_t t = 0; t + 1 < mesh.triangles.size(); t += 2) {
    if (!sharedEdge(mesh.triangles[t], mesh.triangles[t + 1])) return pairsByLongestEdge(mesh);
    pairs.push_back({t, t + 1});
  }
  if (mesh.triangles.size() % 2 != 0) return pairsByLongestEdge(mesh);
  return pairs;
}

// Corners a, b, c, d of the two triangles, counter-clockwise; b and d are those of the shared edge.
std::array<Vector3, 4> cornersOf(const Mesh& mesh, const Pair& pair) {
  const std::array<std::uint32_t, 3>&first = mesh.triangles[pair[0]], &second = mesh.triangles[pair[1]];
  const std::optional<std::size_t> edge = sharedEdge(first, second);
  if (!edge) fail(pair[0], "and triangle " + std::to_string(pair[1]) + " run the same way along their edge: one of them looks inwards");
  const std::uint32_t b = first[*edge], d = first[(*edge + 1) % 3], a = first[(*edge + 2) % 3];
  std::uint32_t c = second[0];
  for (const std::uint32_t corner : second) c = corner != b && corner != d ? corner : c;
  return {vertex(mesh, a), vertex(mesh, b), vertex(mesh, c), vertex(mesh, d)};
}

GridPatch taxelOf(const Mesh& mesh, const Pair& pair, std::size_t number) {
  // a is the tip of the first triangle, b the start of the shared edge: a, b, d run counter-clockwise, so the outline is a, b, c, d.
  const auto [a, b, c, d] = cornersOf(mesh, pair);
  const Vector3 normal = cross(subtract(c, a), subtract(d, b));
  const auto normalAt = [](const Vector3& before, const Vector3& corner, const Vector3& after) {
    return cross(subtract(after, corner), subtract(before, corner));
  };
  const Vector3 one = normalAt(d, a, b), other = normalAt(b, c, d);
  const std::string both = "and triangle " + std::to_string(pair[1]);
  if (dot(one, other) < kMostBend * length(one) * length(other)) {
    fail(pair[0], both + " are bent against each other by more than 20 degrees: no nearly planar taxel");
  }
  for (const Vector3& corner : {one, normalAt(a, b, c), other, normalAt(c, d, a)}) {
    if (!(dot(corner, normal) > 0)) fail(pair[0], both + " make a quadrilateral that is not convex");
  }
  const Vector3 x = scale(0.5, add(subtract(b, a), subtract(c, d)));
  const Vector3 y = scale(0.5, add(subtract(d, a), subtract(c, b)));
  const double area = length(normal) / 2, side_x = length(x), side_y = length(y);
  const double keep_area = std::sqrt(area / (side_x * side_y));
  const Vector3 middle = scale(0.25, add(add(a, b), add(c, d)));
  return taxelPatch("taxel_" + std::to_string(number), middle, normal, {side_x * keep_area, side_y * keep_area}, x);
}

}  // namespace

std::vector<GridPatch> taxelsOfMesh(const Mesh& mesh) {
  std::vector<GridPatch> taxels;
  for (const Pair& pair : pairsOf(mesh)) taxels.push_back(taxelOf(mesh, pair, taxels.size()));
  return taxels;
}

}  // namespace taxelsim
