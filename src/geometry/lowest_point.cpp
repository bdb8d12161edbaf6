// Closed forms for the support point of each solid against the downward direction of S.
//
// With u the z axis of S seen from O (the third row of R_SO), the height of a point p of the object is u . p; the lowest point is where
// that is smallest. Each solid's form follows from splitting u into its part along the solid's axis and the part across it.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "geometry/mesh_bounds.h"
#include "taxelsim/error.h"
#include "taxelsim/object.h"

namespace taxelsim {
namespace {

// An edge or face counts as lowest as a whole when it lies within this angle (rad) of the skin's plane. Its middle is then at most
// 1e-6 times half its length above its true lowest corner: 50 nm for a face of 10 cm, while seven typed digits of a quaternion still count
// as exact.
constexpr double kLevel = 1e-6;

// Coordinates of mesh vertices are float32: two that should lie at one height differ by some rounding errors of the largest coordinate.
constexpr double kVertexRounding = 4 * static_cast<double>(std::numeric_limits<float>::epsilon());

double opposite(double component) {
  return component > kLevel ? -1.0 : component < -kLevel ? 1.0 : 0.0;
}

struct LowestPoint {
  Vector3 u;

  // Unit vector in the xy plane of O that goes down most steeply; zero when the axis is upright, so that all directions are level.
  std::array<double, 2> downAcross() const {
    const double across = std::hypot(u[0], u[1]);
    if (across <= kLevel) return {0, 0};
    return {-u[0] / across, -u[1] / across};
  }

  Vector3 operator()(const Sphere& s) const { return {-s.radius * u[0], -s.radius * u[1], -s.radius * u[2]}; }

  Vector3 operator()(const Cylinder& c) const {
    const auto [x, y] = downAcross();
    return {c.radius * x, c.radius * y, opposite(u[2]) * c.length / 2};
  }

  Vector3 operator()(const Capsule& c) const {
    return {-c.radius * u[0], -c.radius * u[1], opposite(u[2]) * c.length / 2 - c.radius * u[2]};
  }

  Vector3 operator()(const Box& b) const {
    return {opposite(u[0]) * b.size[0] / 2, opposite(u[1]) * b.size[1] / 2, opposite(u[2]) * b.size[2] / 2};
  }

  // A tilted half-space has no lowest point; its origin stands for it, since every sensor is finite.
  Vector3 operator()(const HalfSpace&) const {
    if (!(u[2] > kLevel)) {
      throw Error(ErrorKind::kInput, "half_space: turned so that its surface does not face the skin, so it has no lowest point");
    }
    return {0, 0, 0};
  }

  // The apex at height 0 against the lowest point of the base's rim.
  Vector3 operator()(const Cone& c) const {
    const auto [x, y] = downAcross();
    const Vector3 rim{c.radius * x, c.radius * y, c.height};
    const double rim_height = u[0] * rim[0] + u[1] * rim[1] + u[2] * rim[2];
    const double level = kLevel * std::hypot(c.radius, c.height);
    if (rim_height > level) return {0, 0, 0};
    if (rim_height < -level) return rim;
    return {rim[0] / 2, rim[1] / 2, rim[2] / 2};
  }

  // Upright, a whole circle is lowest; its middle lies on the axis.
  Vector3 operator()(const Torus& t) const {
    const auto [x, y] = downAcross();
    return {t.major_radius * x - t.minor_radius * u[0], t.major_radius * y - t.minor_radius * u[1], -t.minor_radius * u[2]};
  }

  double height(const std::array<float, 3>& vertex) const { return u[0] * vertex[0] + u[1] * vertex[1] + u[2] * vertex[2]; }

  Vector3 operator()(const Mesh& mesh) const {
    double lowest = std::numeric_limits<double>::infinity();
    for (const auto& triangle : mesh.triangles) {
      for (const std::uint32_t index : triangle) lowest = std::min(lowest, height(mesh.vertices[index]));
    }

    const auto [low, high] = meshBounds(mesh);
    double size = 0;
    double largest = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      size = std::hypot(size, high[axis] - low[axis]);
      largest = std::max({largest, std::abs(low[axis]), std::abs(high[axis])});
    }
    const double level = lowest + kLevel * size + kVertexRounding * largest;

    std::vector<std::uint32_t> level_vertices;
    for (const auto& triangle : mesh.triangles) {
      for (const std::uint32_t index : triangle) {
        if (height(mesh.vertices[index]) <= level) level_vertices.push_back(index);
      }
    }
    std::sort(level_vertices.begin(), level_vertices.end());
    level_vertices.erase(std::unique(level_vertices.begin(), level_vertices.end()), level_vertices.end());

    Vector3 mean{0, 0, 0};
    for (const std::uint32_t index : level_vertices) {
      for (std::size_t axis = 0; axis < 3; ++axis) mean[axis] += mesh.vertices[index][axis];
    }
    for (double& coordinate : mean) coordinate /= static_cast<double>(level_vertices.size());
    return mean;
  }
};

}  // namespace

Vector3 lowestPoint(const Object& object, const Quaternion& R_SO) {
  const double norm = std::sqrt(R_SO[0] * R_SO[0] + R_SO[1] * R_SO[1] + R_SO[2] * R_SO[2] + R_SO[3] * R_SO[3]);
  const std::array<double, 9> matrix = rotationMatrix({R_SO[0] / norm, R_SO[1] / norm, R_SO[2] / norm, R_SO[3] / norm});
  return std::visit(LowestPoint{{matrix[6], matrix[7], matrix[8]}}, object.shape);
}

}  // namespace taxelsim
