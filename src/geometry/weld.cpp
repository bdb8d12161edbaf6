#include "geometry/weld.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <numeric>

namespace taxelsim {
namespace {

using Triangle = std::array<std::uint32_t, 3>;
using Vertex = std::array<float, 3>;

Mesh removeUnusedVertices(const Mesh& mesh) {
  constexpr std::uint32_t kUnused = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> new_index(mesh.vertices.size(), kUnused);
  Mesh used;
  used.triangles = mesh.triangles;
  for (Triangle& triangle : used.triangles) {
    for (std::uint32_t& index : triangle) {
      if (new_index[index] == kUnused) {
        new_index[index] = static_cast<std::uint32_t>(used.vertices.size());
        used.vertices.push_back(mesh.vertices[index]);
      }
      index = new_index[index];
    }
  }
  return used;
}

// Index of the first vertex with the same bits, for each vertex. bench/sweep links this file without shared libraries.
std::vector<std::uint32_t> firstEqual(const std::vector<Vertex>& vertices) {
  const auto bitsOf = [&](std::uint32_t v) { return std::bit_cast<std::array<std::uint32_t, 3>>(vertices[v]); };
  std::vector<std::uint32_t> order(vertices.size()), first(vertices.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return std::pair(bitsOf(a), a) < std::pair(bitsOf(b), b); });
  for (std::size_t n = 0; n < order.size(); ++n) {
    const bool starts = n == 0 || bitsOf(order[n]) != bitsOf(order[n - 1]);
    first[order[n]] = starts ? order[n] : first[order[n - 1]];
  }
  return first;
}

}  // namespace

// Computed in double, so that rounding does not turn the area of a sliver with float32 vertices into zero.
bool hasArea(const Vertex& a, const Vertex& b, const Vertex& c) {
  const auto edge = [&](const Vertex& end, std::size_t axis) { return static_cast<double>(end[axis]) - static_cast<double>(a[axis]); };
  const double x = edge(b, 1) * edge(c, 2) - edge(b, 2) * edge(c, 1);
  const double y = edge(b, 2) * edge(c, 0) - edge(b, 0) * edge(c, 2);
  const double z = edge(b, 0) * edge(c, 1) - edge(b, 1) * edge(c, 0);
  return x != 0 || y != 0 || z != 0;
}

Mesh weld(const Mesh& mesh) {
  if (mesh.triangles.empty()) return {};
  Mesh welded;
  welded.vertices = mesh.vertices;
  for (Vertex& vertex : welded.vertices) {
    for (float& coordinate : vertex) coordinate += 0.0f;  // turns -0 into 0
  }
  const std::vector<std::uint32_t> remap = firstEqual(welded.vertices);
  for (const Triangle& triangle : mesh.triangles) {
    const Triangle remapped{remap[triangle[0]], remap[triangle[1]], remap[triangle[2]]};
    if (hasArea(welded.vertices[remapped[0]], welded.vertices[remapped[1]], welded.vertices[remapped[2]]))
      welded.triangles.push_back(remapped);
  }
  return removeUnusedVertices(welded);
}

}  // namespace taxelsim
