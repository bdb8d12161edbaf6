// Support mapping of each shape for the direction -z of S, in closed form.
//
// Let u be the z axis of S in O (the third row of R_SO). The height of a point p of the object is u . p, and the lowest point minimises it.
// For solids of revolution u is split into its components along and perpendicular to the axis of revolution.
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

// Edges and faces within this angle (rad) of the plane z = 0 of S are treated as parallel to it; the result is then their midpoint. The
// midpoint is at most 1e-6 times half the length above the lowest corner: 50 nm for a face of 10 cm. Quaternions given with seven digits
// stay within it.
constexpr double kParallelAngle = 1e-6;

// Tolerance for equal heights of mesh vertices, as a fraction of the largest coordinate. Coordinates are float32.
constexpr double kVertexRounding = 4 * static_cast<double>(std::numeric_limits<float>::epsilon());

// -1, 0 or 1: minus the sign of `component`, with a tolerance around 0.
double oppositeSign(double component) {
  return component > kParallelAngle ? -1.0 : component < -kParallelAngle ? 1.0 : 0.0;
}

struct LowestPoint {
  Vector3 u;  // z axis of S, in O

  // Unit vector in the xy plane of O along which the height falls most; zero if the z axis of O is vertical.
  std::array<double, 2> steepestDescentXY() const {
    const double norm = std::hypot(u[0], u[1]);
    if (norm <= kParallelAngle) return {0, 0};
    return {-u[0] / norm, -u[1] / norm};
  }

  Vector3 operator()(const Sphere& s) const { return {-s.radius * u[0], -s.radius * u[1], -s.radius * u[2]}; }

  Vector3 operator()(const Cylinder& c) const {
    const auto [x, y] = steepestDescentXY();
    return {c.radius * x, c.radius * y, oppositeSign(u[2]) * c.length / 2};
  }

  Vector3 operator()(const Capsule& c) const {
    return {-c.radius * u[0], -c.radius * u[1], oppositeSign(u[2]) * c.length / 2 - c.radius * u[2]};
  }

  Vector3 operator()(const Box& b) const {
    return {oppositeSign(u[0]) * b.size[0] / 2, oppositeSign(u[1]) * b.size[1] / 2, oppositeSign(u[2]) * b.size[2] / 2};
  }

  // A tilted half-space has no lowest point. Its origin is used instead.
  Vector3 operator()(const HalfSpace&) const {
    if (!(u[2] > kParallelAngle)) {
      throw Error(ErrorKind::kInput, "half_space: its surface does not face the skin, so it has no lowest point");
    }
    return {0, 0, 0};
  }

  // The apex (height 0) or the lowest point of the base's rim; the midpoint between them if both are at the same height.
  Vector3 operator()(const Cone& c) const {
    const auto [x, y] = steepestDescentXY();
    const Vector3 rim{c.radius * x, c.radius * y, c.height};
    const double rim_height = u[0] * rim[0] + u[1] * rim[1] + u[2] * rim[2];
    const double tolerance = kParallelAngle * std::hypot(c.radius, c.height);
    if (rim_height > tolerance) return {0, 0, 0};
    if (rim_height < -tolerance) return rim;
    return {rim[0] / 2, rim[1] / 2, rim[2] / 2};
  }

  // With a vertical axis a whole circle is lowest; the result is its center.
  Vector3 operator()(const Torus& t) const {
    const auto [x, y] = steepestDescentXY();
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
    const double max_height = lowest + kParallelAngle * size + kVertexRounding * largest;

    std::vector<std::uint32_t> lowest_vertices;
    for (const auto& triangle : mesh.triangles) {
      for (const std::uint32_t index : triangle) {
        if (height(mesh.vertices[index]) <= max_height) lowest_vertices.push_back(index);
      }
    }
    std::sort(lowest_vertices.begin(), lowest_vertices.end());
    lowest_vertices.erase(std::unique(lowest_vertices.begin(), lowest_vertices.end()), lowest_vertices.end());

    Vector3 mean{0, 0, 0};
    for (const std::uint32_t index : lowest_vertices) {
      for (std::size_t axis = 0; axis < 3; ++axis) mean[axis] += mesh.vertices[index][axis];
    }
    for (double& coordinate : mean) coordinate /= static_cast<double>(lowest_vertices.size());
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
