#include "reference/clipped_triangles.h"

#include <algorithm>
#include <cmath>

#include "base/vector3.h"

namespace taxelsim::reference {
namespace {

using Polygon = std::vector<Vector3>;

enum class Side { kBelow, kAbove };

// The part of a convex polygon with p[axis] <= bound (kBelow) or >= bound (kAbove).
Polygon clipped(const Polygon& polygon, std::size_t axis, double bound, Side side) {
  Polygon kept;
  for (std::size_t n = 0; n < polygon.size(); ++n) {
    const Vector3 &from = polygon[n], &to = polygon[(n + 1) % polygon.size()];
    const auto excess = [&](const Vector3& p) { return side == Side::kBelow ? p[axis] - bound : bound - p[axis]; };
    const double excess_from = excess(from), excess_to = excess(to);
    if (excess_from <= 0) kept.push_back(from);
    if ((excess_from < 0 && excess_to > 0) || (excess_from > 0 && excess_to < 0)) {
      Vector3 crossing = add(from, scale(excess_from / (excess_from - excess_to), subtract(to, from)));
      crossing[axis] = bound;
      kept.push_back(crossing);
    }
  }
  return kept;
}

// Projected area (m^2, positive if clockwise seen from +z) and integrals over it: of -z (m^3), of z^2 (m^4), of x and y (m^3), of -z x and
// -z y (m^4).
struct Projection {
  double area = 0, volume = 0, square = 0;
  std::array<double, 2> middle{0, 0}, moment{0, 0};
};

Projection project(const Polygon& polygon) {
  Projection sum;
  for (std::size_t n = 2; n < polygon.size(); ++n) {
    const Vector3 &a = polygon[0], &b = polygon[n - 1], &c = polygon[n];
    const double area = ((c[0] - a[0]) * (b[1] - a[1]) - (b[0] - a[0]) * (c[1] - a[1])) / 2;
    sum.area += area;
    sum.volume -= area * (a[2] + b[2] + c[2]) / 3;
    // Of a product of linear functions: area / 12 (sum of both at the corners + product of their sums).
    const auto integral = [&](std::size_t i, std::size_t j) {
      return area / 12 * (a[i] * a[j] + b[i] * b[j] + c[i] * c[j] + (a[i] + b[i] + c[i]) * (a[j] + b[j] + c[j]));
    };
    sum.square += integral(2, 2);
    for (std::size_t axis = 0; axis < 2; ++axis) {
      sum.middle[axis] += area * (a[axis] + b[axis] + c[axis]) / 3;
      sum.moment[axis] -= integral(axis, 2);
    }
  }
  return sum;
}

double lowestOf(const Polygon& polygon) {
  double lowest = std::numeric_limits<double>::infinity();
  for (const Vector3& p : polygon) lowest = std::min(lowest, p[2]);
  return lowest;
}

void addPolygon(const Polygon& polygon, const DepthRange& range, CellSums& sums) {
  const Projection all = project(polygon);
  if (!(all.area > 0)) return;
  const Projection shallow = project(clipped(polygon, 2, -range.thickness, Side::kAbove));
  const Projection full = project(clipped(polygon, 2, -range.thickness, Side::kBelow));
  sums.covered += all.area;
  sums.volume += shallow.volume + full.area * range.thickness;
  sums.square += shallow.square + full.area * range.thickness * range.thickness;
  for (std::size_t axis = 0; axis < 2; ++axis) sums.moment[axis] += shallow.moment[axis] + full.middle[axis] * range.thickness;
}

// Whether the bounds of the triangle lie outside of the grid, above the skin or below the view depth. Most triangles of a mesh do.
bool isOutside(const Triangle& t, const Rectangle& all, double view_depth) {
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const auto [min, max] = std::minmax({t[0][axis], t[1][axis], t[2][axis]});
    if (min >= all.max[axis] || max <= all.min[axis]) return true;
  }
  const auto [min, max] = std::minmax({t[0][2], t[1][2], t[2][2]});
  return min >= 0 || max < -view_depth;
}

Polygon within(Polygon polygon, std::size_t axis, double min, double max) {
  return clipped(clipped(polygon, axis, min, Side::kAbove), axis, max, Side::kBelow);
}

}  // namespace

void addTriangles(std::span<const Triangle> triangles, const SampleGrid& grid, const DepthRange& range, std::span<CellSums> sums) {
  const Rectangle all = grid.all();
  for (const Triangle& triangle : triangles) {
    if (isOutside(triangle, all, range.view_depth)) continue;
    const Polygon seen = within({triangle.begin(), triangle.end()}, 2, -range.view_depth, 0);
    if (!(project(seen).area > 0)) continue;
    const auto compareX = [](const Vector3& a, const Vector3& b) { return a[0] < b[0]; };
    const auto [min_x, max_x] = std::minmax_element(seen.begin(), seen.end(), compareX);
    const auto [first_u, last_u] = SampleGrid::range((*min_x)[0], (*max_x)[0], grid.step_x, grid.shift[0], grid.rows);
    for (int u = first_u; u <= last_u; ++u) {
      const Polygon row = within(seen, 0, grid.cell(u, 0).min[0], grid.cell(u, 0).max[0]);
      if (row.size() < 3) continue;
      const auto compareY = [](const Vector3& a, const Vector3& b) { return a[1] < b[1]; };
      const auto [min_y, max_y] = std::minmax_element(row.begin(), row.end(), compareY);
      const auto [first_v, last_v] = SampleGrid::range((*min_y)[1], (*max_y)[1], grid.step_y, grid.shift[1], grid.cols);
      for (int v = first_v; v <= last_v; ++v) {
        const Rectangle cell = grid.cell(u, v);
        addPolygon(within(row, 1, cell.min[1], cell.max[1]), range, sums[grid.index(u, v)]);
      }
    }
  }
}

double lowestOver(std::span<const Triangle> triangles, const Rectangle& rectangle) {
  double lowest = std::numeric_limits<double>::infinity();
  for (const Triangle& triangle : triangles) {
    const Polygon row = within({triangle.begin(), triangle.end()}, 0, rectangle.min[0], rectangle.max[0]);
    lowest = std::min(lowest, lowestOf(within(row, 1, rectangle.min[1], rectangle.max[1])));
  }
  return lowest;
}

}  // namespace taxelsim::reference
