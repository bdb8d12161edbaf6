#include "geometry/enclosed.h"

#include <algorithm>
#include <array>

#include "base/vector3.h"

namespace taxelsim {
namespace {

// Start of a ray along +z, with the winding number of all other components around it.
struct Ray {
  Vector3 start;
  std::uint32_t component;
  int winding = 0;
};

using Corners = std::array<Vector3, 3>;

Vector3 vertexOf(const Mesh& mesh, std::uint32_t index) {
  const auto& [x, y, z] = mesh.vertices[index];
  return {x, y, z};
}

// The extreme vertices of all components, sorted by x.
std::vector<Ray> raysOf(const Mesh& mesh, std::span<const std::uint32_t> component_of, std::size_t num_components) {
  constexpr std::size_t kExtremes = 6;  // lowest and highest along each axis
  std::vector<Ray> rays(kExtremes * num_components);
  std::vector<bool> is_known(num_components);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const std::uint32_t component = component_of[t];
    Ray* const extremes = &rays[kExtremes * component];
    for (const std::uint32_t index : mesh.triangles[t]) {
      const Vector3 p = vertexOf(mesh, index);
      if (!is_known[component]) std::fill_n(extremes, kExtremes, Ray{p, component});
      is_known[component] = true;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (p[axis] < extremes[2 * axis].start[axis]) extremes[2 * axis].start = p;
        if (p[axis] > extremes[2 * axis + 1].start[axis]) extremes[2 * axis + 1].start = p;
      }
    }
  }
  std::sort(rays.begin(), rays.end(), [](const Ray& a, const Ray& b) { return a.start[0] < b.start[0]; });
  return rays;
}

// Signed crossing of the edge from a to b with the half-line from p along +x, in the xy plane. Half-open in y, so that of the edges that
// meet at a vertex the right number crosses (D. Sunday's winding number). The sign is exact for differences of float32 coordinates of
// similar size, whose products fit a double; edges shared by two triangles then cancel.
int crossing(const Vector3& a, const Vector3& b, const Vector3& p) {
  const double side = (b[0] - a[0]) * (p[1] - a[1]) - (p[0] - a[0]) * (b[1] - a[1]);
  if (a[1] <= p[1]) return b[1] > p[1] && side > 0 ? 1 : 0;
  return b[1] <= p[1] && side < 0 ? -1 : 0;
}

// +1 if the ray leaves through the triangle, -1 if it enters, 0 if it misses or starts on it.
int windingOf(const Corners& t, const Vector3& start) {
  const int covered = crossing(t[0], t[1], start) + crossing(t[1], t[2], start) + crossing(t[2], t[0], start);
  if (covered == 0) return 0;
  const double above = dot(cross(subtract(t[1], t[0]), subtract(t[2], t[0])), subtract(start, t[0]));
  return covered * above < 0 ? covered : 0;
}

}  // namespace

std::vector<bool> enclosedComponents(const Mesh& mesh, std::span<const std::uint32_t> component_of, std::size_t num_components) {
  if (num_components < 2) return std::vector<bool>(num_components, false);
  std::vector<Ray> rays = raysOf(mesh, component_of, num_components);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    const Corners corners{vertexOf(mesh, a), vertexOf(mesh, b), vertexOf(mesh, c)};
    const auto [min_x, max_x] = std::minmax({corners[0][0], corners[1][0], corners[2][0]});
    auto ray = std::lower_bound(rays.begin(), rays.end(), min_x, [](const Ray& r, double x) { return r.start[0] < x; });
    for (; ray != rays.end() && ray->start[0] <= max_x; ++ray) {
      if (ray->component != component_of[t]) ray->winding += windingOf(corners, ray->start);
    }
  }
  std::vector<bool> enclosed(num_components, true);
  for (const Ray& ray : rays) {
    if (ray.winding <= 0) enclosed[ray.component] = false;
  }
  return enclosed;
}

}  // namespace taxelsim
