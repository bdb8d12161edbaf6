// Mean penetration depth over a cell under a surface that is known by rays along z only: the analytic solids.
//
// Integrated along y on lines of constant x, then along x. A line is split where f(z) (clipped_triangles.h) changes between its pieces: 0,
// -z and thickness; the lines are split where the sequence of pieces on them changes.
//
//     y ^  +-------------+      Changes are found on a raster of 32 x 32 intervals and bisected to 2^-30 of an interval. Between them, f
//       |  |    . - ' ---|      may end like a square root (silhouettes, tangents). With x = low + (high - low) sin^2(pi t / 2) it is
//       smooth |  | .'   full   |      in t, and a rule of eight points converges; other kinks, such as the rim of a cylinder, are halved
//       further. |  |/     ___----| |  | ___--   -z  | |  |-------------| |  |      0      |
//       +--+---x1---x2---+--> x     changes of the sequence at x1, x2
#pragma once

#include <array>
#include <functional>

#include "reference/clipped_triangles.h"
#include "reference/sample_grid.h"

namespace taxelsim::reference {

// Height (m) of the lowest surface over (x, y) of P: +infinity where there is none, -infinity under one that extends downwards forever.
using HeightAt = std::function<double(double, double)>;

// Error bound of meanDepth(), as a fraction of the thickness, for outlines with a radius of at least a quarter of a cell. A piece of an
// outline that bulges into a row of the raster by less than one interval c = w / 32 may be missed: a segment of area c^3 / (12 R), which
// for R = w / 4 is 1.0e-5 of the cell. There may be four, one on each side; corners of an outline are rounder or rarer. Quadrature adds
// 4e-6.
inline constexpr double kMeanDepthTolerance = 5e-5;

struct CellDepth {
  double mean = 0;                     // m
  double share = 0;                    // of the cell that the surface covers below the skin, at most 1
  double square = 0;                   // m^2: mean of f^2
  std::array<double, 2> moment{0, 0};  // m^2: means of f x and f y, from the middle of the cell
};

// Means over a cell, of f and of where it is not 0; with `varies` square and moment, too. `domain`: the part of the cell over which the
// surface may be; 0 for an empty one, min >= max.
CellDepth meanDepth(const HeightAt& heightAt, const Rectangle& domain, const Rectangle& cell, const DepthRange& range, bool varies);

// Lowest height over a rectangle, by a raster, the ray at `guess` (m) and a pattern search from the lowest of these; +infinity over an
// empty rectangle.
double lowestHeight(const HeightAt& heightAt, const Rectangle& rectangle, const std::array<double, 2>& guess);

}  // namespace taxelsim::reference
