#include "geometry/simplify.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "geometry/mend.h"
#include "geometry/weld.h"

namespace taxelsim {
namespace {

using Triangle = Mender::Triangle;

constexpr std::size_t kMinTriangles = 64;
constexpr double kWorthwhile = 0.9;  // of the triangles: a result with more is not worth having

// What the simplifier is asked for, in max_error. It measures a mean, so that asked for 1.2 times the bound it goes too far in places, and
// the vertices that mend those are fewer than what a smaller target leaves everywhere: on ellipsoids 1.0 to 1.5 leave the fewest triangles.
constexpr double kFirstTarget = 1.2;
constexpr double kNextTarget = 0.7;  // of the one before, where mending came to no end
constexpr int kMaxTargets = 8;

// `target` is relative to the mesh's longest side.
std::vector<Triangle> collapsed(const Mesh& mesh, double target) {
  std::vector<Triangle> triangles(mesh.triangles.size());
  const std::size_t num_indices = meshopt_simplify(triangles.front().data(), mesh.triangles.front().data(), 3 * mesh.triangles.size(),
                                                   mesh.vertices.front().data(), mesh.vertices.size(), sizeof(mesh.vertices.front()), 0,
                                                   static_cast<float>(std::min(target, 1.0)), meshopt_SimplifyLockBorder, nullptr);
  triangles.resize(num_indices / 3);
  std::erase_if(triangles, [&](const Triangle& t) { return !hasArea(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]); });
  return triangles;
}

}  // namespace

Mesh simplified(const Mesh& mesh, double max_error) {
  if (!(max_error > 0) || mesh.triangles.size() < kMinTriangles) return mesh;
  const float extent = meshopt_simplifyScale(mesh.vertices.front().data(), mesh.vertices.size(), sizeof(mesh.vertices.front()));
  if (!std::isnormal(1 / extent)) return mesh;  // out of the reach of float32
  const auto max_triangles = static_cast<std::size_t>(kWorthwhile * static_cast<double>(mesh.triangles.size()));
  Mender mender(mesh, max_error);
  double target = kFirstTarget * max_error / extent;
  for (int n = 0; n < kMaxTargets && !mender.isExhausted(); ++n, target *= kNextTarget) {
    std::vector<Triangle> triangles = collapsed(mesh, target);
    if (triangles.size() > max_triangles) break;  // smaller targets leave more
    if (std::optional<std::vector<Triangle>> mended = mender.mend(std::move(triangles), max_triangles)) {
      return weld({mesh.vertices, std::move(*mended)});  // leaves out vertices that are no longer used
    }
  }
  return mesh;
}

}  // namespace taxelsim
