// Exact integrals of the penetration depth of triangles over the cells of a grid.
//
//        z ^      \            /            f(z) = 0     above the skin, and below -view_depth
//        0 |-------\----------/---- skin         -z      down to -thickness
//          |########\        /                   thickness below that
//   -thickness -------\------/-----
//          |  full     \____/           Each triangle is clipped to a cell and to the three layers by the algorithm of I. E. Sutherland and
//          +---------------------> x    G. W. Hodgman (Comm. ACM 17(1), 1974). On what remains f is linear: area x mean over the corners.
#pragma once

#include <array>
#include <limits>
#include <span>
#include <vector>

#include "reference/sample_grid.h"
#include "taxelsim/pose.h"

namespace taxelsim::reference {

using Triangle = std::array<Vector3, 3>;

// f(z), the penetration depth at a surface of height z.
struct DepthRange {
  double thickness = 0;                                         // m
  double view_depth = std::numeric_limits<double>::infinity();  // m, at least the thickness

  double depthAt(double z) const { return z < -view_depth ? 0 : std::clamp(-z, 0.0, thickness); }
};

// Sums over the triangles of a surface in one cell.
struct CellSums {
  double volume = 0;                   // m^3: integral of f
  double covered = 0;                  // m^2: area with -view_depth <= z < 0
  double square = 0;                   // m^4: integral of f^2
  std::array<double, 2> moment{0, 0};  // m^4: integrals of f x and f y, in P

  // Mean of f over a cell of this area (m^2). Where the surface folds over itself, the covered area exceeds the cell's; the mean is then
  // that over the covered area.
  double mean(double area) const { return volume / std::max(area, covered); }
};

// Adds those of the `triangles` (in P, outward winding) that look down, -z, to `sums`, one per cell in the order of `grid`.
void addTriangles(std::span<const Triangle> triangles, const SampleGrid& grid, const DepthRange& range, std::span<CellSums> sums);

// Lowest z of the triangles over a rectangle; +infinity where there is none.
double lowestOver(std::span<const Triangle> triangles, const Rectangle& rectangle);

}  // namespace taxelsim::reference
