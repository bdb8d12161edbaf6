#include "geometry/enclosed.h"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "base/vector3.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

// Start of a ray along +z, with the winding number of all other components around it.
struct Ray {
  Vector3 start;
  std::uint32_t component = 0;
  int winding = 0;
  std::size_t axis = 0;  // along which it splits its part of the tree
};

using Corners = std::array<Vector3, 3>;

Vector3 vertexOf(const Mesh& mesh, std::uint32_t index) {
  const auto& [x, y, z] = mesh.vertices[index];
  return {x, y, z};
}

constexpr std::size_t kExtremes = 6;  // lowest and highest along x, y, z

// The extreme vertices of all components, kExtremes for each.
std::vector<Ray> raysOf(const Mesh& mesh, std::span<const std::uint32_t> component_of, std::size_t num_components) {
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
  return rays;
}

// A k-d tree in an array: the ray in the middle splits the others along the axis on which they are spread most, and so on on each side.
class RayTree {
 public:
  explicit RayTree(std::vector<Ray> rays) : rays_(std::move(rays)) { split(0, rays_.size()); }

  const std::vector<Ray>& rays() const { return rays_; }

  // Calls visit(Ray&) for each ray that starts in the box or on its surface.
  template <typename Visit>
  void visitBox(const Bounds& box, const Visit& visit) {
    visitBox(box, visit, 0, rays_.size());
  }

 private:
  void split(std::size_t begin, std::size_t end) {
    if (end - begin < 2) return;
    const auto at = [&](std::size_t i) { return rays_.begin() + static_cast<std::ptrdiff_t>(i); };
    std::size_t axis = 0;
    double widest = -1;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax_element(at(begin), at(end), [&](const Ray& a, const Ray& b) { return a.start[k] < b.start[k]; });
      if (high->start[k] - low->start[k] <= widest) continue;
      widest = high->start[k] - low->start[k];
      axis = k;
    }
    const std::size_t middle = (begin + end) / 2;
    std::nth_element(at(begin), at(middle), at(end), [&](const Ray& a, const Ray& b) { return a.start[axis] < b.start[axis]; });
    rays_[middle].axis = axis;
    split(begin, middle);
    split(middle + 1, end);
  }

  template <typename Visit>
  void visitBox(const Bounds& box, const Visit& visit, std::size_t begin, std::size_t end) {
    if (begin == end) return;
    const std::size_t middle = (begin + end) / 2;
    Ray& ray = rays_[middle];
    bool is_inside = true;
    for (std::size_t k = 0; k < 3; ++k) is_inside = is_inside && ray.start[k] >= box.min[k] && ray.start[k] <= box.max[k];
    if (is_inside) visit(ray);
    const std::size_t axis = ray.axis;
    if (box.min[axis] <= ray.start[axis]) visitBox(box, visit, begin, middle);
    if (box.max[axis] >= ray.start[axis]) visitBox(box, visit, middle + 1, end);
  }

  std::vector<Ray> rays_;
};

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

std::vector<bool> enclosedComponents(const Mesh& mesh, std::span<const std::uint32_t> component_of, std::size_t num_components,
                                     std::uint64_t max_tests) {
  if (num_components < 2) return std::vector<bool>(num_components, false);
  std::vector<Ray> rays = raysOf(mesh, component_of, num_components);
  std::vector<double> lowest(num_components);  // z, below which a component encloses nothing
  for (std::size_t c = 0; c < num_components; ++c) lowest[c] = rays[kExtremes * c + 4].start[2];
  RayTree tree(std::move(rays));
  std::uint64_t num_tests = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    const Corners corners{vertexOf(mesh, a), vertexOf(mesh, b), vertexOf(mesh, c)};
    Bounds box{.min = {0, 0, lowest[component_of[t]]}, .max = {}};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto [min, max] = std::minmax({corners[0][axis], corners[1][axis], corners[2][axis]});
      if (axis < 2) box.min[axis] = min;
      box.max[axis] = max;
    }
    tree.visitBox(box, [&](Ray& ray) {
      if (ray.component == component_of[t]) return;
      ray.winding += windingOf(corners, ray.start);
      if (++num_tests > max_tests)
        throw Error(ErrorKind::kInput, std::to_string(num_components) + " parts are inside of each other: it takes too long to tell which");
    });
  }
  std::vector<bool> enclosed(num_components, true);
  for (const Ray& ray : tree.rays()) {
    if (ray.winding <= 0) enclosed[ray.component] = false;
  }
  return enclosed;
}

}  // namespace taxelsim
