// Triangles with outward winding of the shapes that have flat faces.
#pragma once

#include <cmath>
#include <optional>
#include <vector>

#include "reference/clipped_triangles.h"
#include "taxelsim/object.h"

namespace taxelsim::reference {

// In O, of boxes and of closed meshes (outwardMesh()); nothing for other shapes.
std::optional<std::vector<Triangle>> facesOf(const Shape& shape);

// The triangles, given in O, in coordinates in which rays along `direction_P` (z > 0) run along z, and heights are multiples of it.
std::vector<Triangle> inRays(std::vector<Triangle> faces, const Pose& X_PO, const Vector3& direction_P);

// The surface z(x, y) of a plane over a rectangle, wound to look down. Empty if it is not finite.
template <typename HeightAt>
std::vector<Triangle> planeOver(const HeightAt& heightAt, const Rectangle& rectangle) {
  const auto corner = [&](double x, double y) { return Vector3{x, y, heightAt(x, y)}; };
  const Vector3 a = corner(rectangle.min[0], rectangle.min[1]), b = corner(rectangle.min[0], rectangle.max[1]);
  const Vector3 c = corner(rectangle.max[0], rectangle.max[1]), d = corner(rectangle.max[0], rectangle.min[1]);
  for (const Vector3& p : {a, b, c, d}) {
    if (!std::isfinite(p[2])) return {};
  }
  return {{a, b, c}, {a, c, d}};
}

}  // namespace taxelsim::reference
