#include "geometry/polyhedron.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

namespace taxelsim {
namespace {

// Tolerance for coplanarity, as a fraction of the largest coordinate: four rounding errors of float32.
constexpr double kCoplanarTolerance = 4 * 0x1p-24;

// Watertight and consistently oriented: every directed edge occurs once, and so does its reverse.
bool isClosed(const Mesh& mesh) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (const auto& [a, b, c] : mesh.triangles) edges.insert(edges.end(), {{a, b}, {b, c}, {c, a}});
  std::sort(edges.begin(), edges.end());
  if (std::adjacent_find(edges.begin(), edges.end()) != edges.end()) return false;
  return std::all_of(edges.begin(), edges.end(),
                     [&](const auto& edge) { return std::binary_search(edges.begin(), edges.end(), std::pair(edge.second, edge.first)); });
}

}  // namespace

std::optional<std::vector<Face>> convexFaces(const Mesh& mesh, std::size_t max_faces) {
  std::vector<Eigen::Vector3d> points;
  points.reserve(mesh.vertices.size());
  for (const std::array<float, 3>& vertex : mesh.vertices) points.emplace_back(vertex[0], vertex[1], vertex[2]);
  Eigen::AlignedBox3d box;
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
  for (const std::array<std::uint32_t, 3>& triangle : mesh.triangles) {
    for (const std::uint32_t index : triangle) {
      box.extend(points[index]);
      centroid += points[index] / (3 * static_cast<double>(mesh.triangles.size()));
    }
  }
  const double tolerance = kCoplanarTolerance * (box.min().cwiseAbs().cwiseMax(box.max().cwiseAbs())).maxCoeff();

  std::vector<Face> faces;
  int winding = 0;
  for (const auto& [ia, ib, ic] : mesh.triangles) {
    const Eigen::Vector3d &a = points[ia], &b = points[ib], &c = points[ic];
    const Eigen::Vector3d cross = (b - a).cross(c - a);
    if (cross.norm() == 0) return std::nullopt;
    Eigen::Vector3d normal = cross.normalized();
    // The centroid of a convex body is inside, on the same side of all triangles.
    const double height = normal.dot(a - centroid);
    if (std::abs(height) <= tolerance) return std::nullopt;
    const int side = height > 0 ? 1 : -1;
    if (winding == 0) winding = side;
    if (side != winding) return std::nullopt;
    normal *= side;
    const bool known = std::any_of(faces.begin(), faces.end(), [&](const Face& face) {
      const Eigen::Map<const Eigen::Vector3d> n(face.normal.data());
      return std::abs(n.dot(a) - face.offset) <= tolerance && std::abs(n.dot(b) - face.offset) <= tolerance &&
             std::abs(n.dot(c) - face.offset) <= tolerance && n.dot(normal) > 0;
    });
    if (known) continue;
    if (faces.size() == max_faces) return std::nullopt;
    faces.push_back({{normal.x(), normal.y(), normal.z()}, normal.dot(a)});
  }
  for (const Face& face : faces) {
    const Eigen::Map<const Eigen::Vector3d> n(face.normal.data());
    for (const std::array<std::uint32_t, 3>& triangle : mesh.triangles) {
      for (const std::uint32_t index : triangle) {
        if (n.dot(points[index]) - face.offset > tolerance) return std::nullopt;
      }
    }
  }
  if (!isClosed(mesh)) return std::nullopt;
  return faces;
}

}  // namespace taxelsim
