// Triangulation of polygons in space: a fan where the polygon is convex, otherwise ear clipping (G. H. Meisters, "Polygons have ears",
// Am. Math. Monthly 82, 1975) in the plane of its area vector.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "taxelsim/object.h"

namespace taxelsim {

inline constexpr std::size_t kMaxPolygonCorners = 1000;

class Triangulator {
 public:
  using Vertex = std::array<float, 3>;
  using Triangle = std::array<std::uint32_t, 3>;

  // Appends the triangles of a polygon, `corners` in order. Fewer than three corners give none. A polygon without an ear, which crosses
  // itself, gives a fan of what is left. Returns false if all calls together would take more than 1e9 tests, about 10 s: a test for an ear
  // takes a time proportional to the corners, and a hostile polygon takes a number of such tests that is quadratic in them.
  bool operator()(std::span<const Vertex> vertices, std::span<const std::uint32_t> corners, std::vector<Triangle>& triangles);

 private:
  using Point = std::array<double, 2>;

  bool isEar(std::size_t at);

  std::vector<Point> points_;
  std::vector<std::uint32_t> left_;  // corners that are not clipped, as indices of points_
  std::uint64_t num_tests_ = 0;
};

}  // namespace taxelsim
