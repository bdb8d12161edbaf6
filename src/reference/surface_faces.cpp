#include "reference/surface_faces.h"

#include "geometry/outward.h"

namespace taxelsim::reference {
namespace {

std::vector<Triangle> facesOf(const Mesh& outward) {
  std::vector<Triangle> faces;
  faces.reserve(outward.triangles.size());
  for (const std::array<std::uint32_t, 3>& corners : outward.triangles) {
    Triangle& face = faces.emplace_back();
    for (std::size_t n = 0; n < 3; ++n) {
      const auto& [x, y, z] = outward.vertices[corners[n]];
      face[n] = {x, y, z};
    }
  }
  return faces;
}

// In double: a mesh would round the size to float32.
std::vector<Triangle> facesOf(const Box& box) {
  std::vector<Triangle> faces;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const double side : {-0.5, 0.5}) {
      const auto corner = [&](double u, double v) {
        Vector3 p;
        p[axis] = side * box.size[axis];
        p[(axis + 1) % 3] = u * box.size[(axis + 1) % 3];
        p[(axis + 2) % 3] = v * box.size[(axis + 2) % 3];
        return p;
      };
      // Counter-clockwise about +axis, the outward direction of the upper side.
      faces.push_back({corner(-0.5, -0.5), corner(side, -side), corner(0.5, 0.5)});
      faces.push_back({corner(-0.5, -0.5), corner(0.5, 0.5), corner(-side, side)});
    }
  }
  return faces;
}

}  // namespace

std::optional<std::vector<Triangle>> facesOf(const Shape& shape) {
  if (const Box* box = std::get_if<Box>(&shape)) return facesOf(*box);
  const Mesh* mesh = std::get_if<Mesh>(&shape);
  const std::optional<Mesh> outward = mesh ? outwardMesh(*mesh) : std::nullopt;
  return outward ? std::optional(facesOf(*outward)) : std::nullopt;
}

std::vector<Triangle> inRays(std::vector<Triangle> faces, const Pose& X_PO, const Vector3& direction_P) {
  for (Triangle& face : faces) {
    for (Vector3& p : face) {
      const Vector3 p_P = X_PO * p;
      const double t = p_P[2] / direction_P[2];
      p = {p_P[0] - t * direction_P[0], p_P[1] - t * direction_P[1], t};
    }
  }
  return faces;
}

}  // namespace taxelsim::reference
