#include "reference/depth.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#include "base/constants.h"
#include "base/vector3.h"
#include "reference/sample_grid.h"
#include "reference/solids.h"
#include "sensor/skin.h"

namespace taxelsim::reference {
namespace {

// Twice the signed area of (a, b, p) in the xy plane.
double edgeFunction(const Vector3& a, const Vector3& b, double x, double y) {
  return (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]);
}

// Lowers `heights` to the triangle where it covers samples and is not below `floor`. `t` is sheared so that the rays run along z.
void lowerToTriangle(const std::array<Vector3, 3>& t, const SampleGrid& grid, double floor, std::span<double> heights) {
  const double area = edgeFunction(t[0], t[1], t[2][0], t[2][1]);
  if (area == 0) {
    return;  // degenerate in projection: covers no sample
  }
  const auto [min_x, max_x] = std::minmax({t[0][0], t[1][0], t[2][0]});
  const auto [min_y, max_y] = std::minmax({t[0][1], t[1][1], t[2][1]});
  const auto [first_u, last_u] = SampleGrid::range(min_x, max_x, grid.step_x, grid.shift[0], grid.rows);
  const auto [first_v, last_v] = SampleGrid::range(min_y, max_y, grid.step_y, grid.shift[1], grid.cols);
  const auto [min_z, max_z] = std::minmax({t[0][2], t[1][2], t[2][2]});
  for (int u = first_u; u <= last_u; ++u) {
    for (int v = first_v; v <= last_v; ++v) {
      const double x = grid.x(u), y = grid.y(v);
      const double w0 = edgeFunction(t[1], t[2], x, y) / area;
      const double w1 = edgeFunction(t[2], t[0], x, y) / area;
      const double w2 = edgeFunction(t[0], t[1], x, y) / area;
      if (w0 < 0 || w1 < 0 || w2 < 0) {
        continue;
      }
      const double z = std::clamp((w0 * t[0][2] + w1 * t[1][2] + w2 * t[2][2]) / (w0 + w1 + w2), min_z, max_z);
      double& height = heights[grid.index(u, v)];
      if (z >= floor) height = std::min(height, z);
    }
  }
}

void lowerToMesh(const Mesh& mesh, const Pose& X_PO, const Rays& rays, const SampleGrid& grid, std::span<double> heights) {
  const Vector3& direction = rays.direction_P;
  std::vector<Vector3> vertices;
  for (const std::array<float, 3>& vertex : mesh.vertices) {
    const Vector3 p = X_PO * Vector3{vertex[0], vertex[1], vertex[2]};
    const double t = p[2] / direction[2];
    vertices.push_back({p[0] - t * direction[0], p[1] - t * direction[1], t});
  }
  for (const std::array<std::uint32_t, 3>& corners : mesh.triangles) {
    lowerToTriangle({vertices[corners[0]], vertices[corners[1]], vertices[corners[2]]}, grid, -rays.view_depth, heights);
  }
}

template <typename Solid>
void lowerToSolid(const Solid& solid, const Pose& X_PO, const Rays& rays, const SampleGrid& grid, std::span<double> heights) {
  const Pose X_OP = inverse(X_PO);
  const Vector3 direction_O = rotate(X_OP.rotation, rays.direction_P);
  for (int u = 0; u < grid.rows; ++u) {
    for (int v = 0; v < grid.cols; ++v) {
      double& height = heights[grid.index(u, v)];
      const double hit = surfaceOver(solid, X_OP * Vector3{grid.x(u), grid.y(v), 0}, direction_O);
      if (hit >= -rays.view_depth) height = std::min(height, hit);
    }
  }
}

}  // namespace

void appendHeights(const GridPatch& patch, int samples_per_taxel, std::span<const PlacedObject> objects, const Rays& rays,
                   std::vector<double>& heights) {
  const SampleGrid grid(patch, samples_per_taxel, rays.shift_P);
  const std::size_t first = heights.size();
  heights.resize(first + grid.size(), kInfinity);
  const std::span<double> patch_heights = std::span(heights).subspan(first);
  const Pose X_PS = inverse(patch.X_SP);
  for (const PlacedObject& placed : objects) {
    const Pose X_PO = X_PS * placed.X_SO;
    std::visit(
        [&](const auto& shape) {
          if constexpr (std::is_same_v<std::decay_t<decltype(shape)>, Mesh>) {
            lowerToMesh(shape, X_PO, rays, grid, patch_heights);
          } else {
            lowerToSolid(shape, X_PO, rays, grid, patch_heights);
          }
        },
        placed.object->shape);
  }
}

std::vector<double> surfaceHeights(const Sensor& sensor, std::span<const PlacedObject> objects, const std::array<double, 2>& shift_P) {
  const std::vector<double> view_depths = viewDepths(sensor);
  std::vector<double> heights;
  for (std::size_t n = 0; n < sensor.patches.size(); ++n) {
    appendHeights(sensor.patches[n], sensor.samples_per_taxel, objects, {.shift_P = shift_P, .view_depth = view_depths[n]}, heights);
  }
  return heights;
}

std::vector<double> penetrations(std::span<const double> heights, double thickness, double reach) {
  std::vector<double> d;
  d.reserve(heights.size());
  for (const double height : heights) {
    d.push_back(std::clamp(-height, -reach, thickness));
  }
  return d;
}

}  // namespace taxelsim::reference
