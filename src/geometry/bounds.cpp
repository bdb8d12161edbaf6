#include <algorithm>
#include <cmath>
#include <limits>

#include "base/constants.h"
#include "geometry/mesh_bounds.h"
#include "taxelsim/object.h"

namespace taxelsim {
namespace {

Bounds centered(double x, double y, double z) {
  return {{-x, -y, -z}, {x, y, z}};
}

struct BoundsVisitor {
  Bounds operator()(const Sphere& s) const { return centered(s.radius, s.radius, s.radius); }
  Bounds operator()(const Cylinder& c) const { return centered(c.radius, c.radius, c.length / 2); }
  Bounds operator()(const Capsule& c) const { return centered(c.radius, c.radius, c.length / 2 + c.radius); }
  Bounds operator()(const Box& b) const { return centered(b.size[0] / 2, b.size[1] / 2, b.size[2] / 2); }
  Bounds operator()(const HalfSpace&) const { return {{-kInfinity, -kInfinity, 0}, {kInfinity, kInfinity, kInfinity}}; }
  Bounds operator()(const Cone& c) const { return {{-c.radius, -c.radius, 0}, {c.radius, c.radius, c.height}}; }
  Bounds operator()(const Torus& t) const {
    const double outer = t.major_radius + t.minor_radius;
    return centered(outer, outer, t.minor_radius);
  }
  Bounds operator()(const Mesh& mesh) const { return meshBounds(mesh); }
};

}  // namespace

Bounds meshBounds(const Mesh& mesh) {
  Bounds bounds{{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t index : triangle) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double coordinate = mesh.vertices[index][axis];
        bounds.min[axis] = std::min(bounds.min[axis], coordinate);
        bounds.max[axis] = std::max(bounds.max[axis], coordinate);
      }
    }
  }
  return bounds;
}

Bounds boundsOf(const Object& object) {
  return std::visit(BoundsVisitor{}, object.shape);
}

}  // namespace taxelsim
