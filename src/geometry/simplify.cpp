#include "geometry/simplify.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "geometry/simplification_repair.h"
#include "geometry/weld.h"

namespace taxelsim {
namespace {

using Triangle = SimplificationRepair::Triangle;

constexpr std::size_t kMinTriangles = 64;
constexpr double kMaxRemaining = 0.9;  // fraction of the triangles; a result with more is discarded

// Target error of the edge collapse, as a multiple of max_error. The collapse measures a mean error, so a target above 1 violates
// the bound in places; repairing those takes fewer vertices than a smaller target leaves everywhere. On ellipsoids 1.0 to 1.5 leave
// the fewest triangles.
constexpr double kFirstTarget = 1.2;
constexpr double kTargetFactor = 0.7;  // after a failed repair
constexpr int kMaxTargets = 8;

// `target_error` is relative to the longest side of the mesh's bounding box.
std::vector<Triangle> collapseEdges(const Mesh& mesh, double target_error) {
  std::vector<Triangle> triangles(mesh.triangles.size());
  const std::size_t num_indices = meshopt_simplify(triangles.front().data(), mesh.triangles.front().data(), 3 * mesh.triangles.size(),
                                                   mesh.vertices.front().data(), mesh.vertices.size(), sizeof(mesh.vertices.front()), 0,
                                                   static_cast<float>(std::min(target_error, 1.0)), meshopt_SimplifyLockBorder, nullptr);
  triangles.resize(num_indices / 3);
  std::erase_if(triangles, [&](const Triangle& t) { return !hasArea(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]); });
  return triangles;
}

}  // namespace

Mesh simplifyMesh(const Mesh& mesh, double max_error) {
  if (!(max_error > 0) || mesh.triangles.size() < kMinTriangles) return mesh;
  const float extent = meshopt_simplifyScale(mesh.vertices.front().data(), mesh.vertices.size(), sizeof(mesh.vertices.front()));
  if (!std::isnormal(1 / extent)) return mesh;  // the relative error would overflow float32
  const auto max_triangles = static_cast<std::size_t>(kMaxRemaining * static_cast<double>(mesh.triangles.size()));
  SimplificationRepair repair(mesh, max_error);
  double target = kFirstTarget * max_error / extent;
  for (int n = 0; n < kMaxTargets && !repair.isExhausted(); ++n, target *= kTargetFactor) {
    std::vector<Triangle> triangles = collapseEdges(mesh, target);
    if (triangles.size() > max_triangles) break;  // a smaller target leaves more triangles
    if (std::optional<std::vector<Triangle>> repaired = repair.run(std::move(triangles), max_triangles)) {
      return weld({mesh.vertices, std::move(*repaired)});  // removes unused vertices
    }
  }
  return mesh;
}

}  // namespace taxelsim
