#include "geometry/weld.h"

#include <meshoptimizer.h>

#include <limits>

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
  std::vector<Vertex> vertices = mesh.vertices;
  // meshopt_generateVertexRemap compares bytes; adding 0 turns -0 into 0.
  for (Vertex& vertex : vertices) {
    for (float& coordinate : vertex) coordinate += 0.0f;
  }

  const std::size_t num_indices = 3 * mesh.triangles.size();
  const unsigned int* const indices = mesh.triangles.front().data();
  std::vector<unsigned int> remap(vertices.size());
  const std::size_t num_unique =
      meshopt_generateVertexRemap(remap.data(), indices, num_indices, vertices.data(), vertices.size(), sizeof(Vertex));

  Mesh welded;
  welded.vertices.resize(num_unique);
  meshopt_remapVertexBuffer(welded.vertices.data(), vertices.data(), vertices.size(), sizeof(Vertex), remap.data());
  for (const Triangle& triangle : mesh.triangles) {
    const Triangle remapped{remap[triangle[0]], remap[triangle[1]], remap[triangle[2]]};
    if (hasArea(welded.vertices[remapped[0]], welded.vertices[remapped[1]], welded.vertices[remapped[2]]))
      welded.triangles.push_back(remapped);
  }
  return removeUnusedVertices(welded);
}

}  // namespace taxelsim
