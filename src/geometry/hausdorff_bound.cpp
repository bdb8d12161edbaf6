#include "geometry/hausdorff_bound.h"

#include <algorithm>
#include <cmath>

#include "base/vector3.h"

namespace taxelsim {
namespace {

// Largest number of cuts in a row. A mesh of a million triangles over a flat face of two triangles takes fewer than half of it.
constexpr int kMaxDepth = 128;

// Margin for rounding, as a fraction of the largest coordinate; subtracted from the bound. Each cut moves a corner by the rounding
// of three operations, 2^-53 of a coordinate each along three axes. A distance takes about ten more: (128 x 3 + 10) x sqrt(3) x
// 2^-53 = 7.6e-14.
constexpr double kRounding = 1e-13;

// Polygons of a smaller radius, in multiples of the bound, are not cut further.
constexpr double kMinRadius = 1e-6;

// Polygons of a larger radius, in multiples of the longest edge of the nearest triangle, are bisected: cuts along the triangle
// would leave slivers.
constexpr double kMaxRadius = 4;

// Smallest distance from the plane to the farthest corner, in multiples of the bound, at which the cut is made.
constexpr double kMinOvershoot = 0.01;

}  // namespace

HausdorffBound::HausdorffBound(const TriangleTree& surface, double bound, SearchBudget& budget)
    : surface_(surface), bound_(bound - kRounding * (surface.largestCoordinate() + bound)), budget_(budget) {}

std::optional<Vector3> HausdorffBound::findViolation(const TriangleCorners& triangle) {
  if (!(bound_ > 0) || surface_.numTriangles() == 0) return triangle[0];
  Polygon polygon;
  std::copy(triangle.begin(), triangle.end(), polygon.corners.begin());
  polygon.num_corners = 3;
  stack_.assign(1, polygon);
  while (!stack_.empty()) {
    polygon = stack_.back();
    stack_.pop_back();
    if (isWithinBoundOf(nearest_, polygon)) continue;

    Vector3 centroid{0, 0, 0};
    for (std::size_t i = 0; i < polygon.num_corners; ++i) {
      centroid = add(centroid, scale(1.0 / static_cast<double>(polygon.num_corners), polygon.corners[i]));
    }
    if (budget_.isExhausted()) return centroid;
    const std::optional<TriangleTree::Nearest> nearest = surface_.nearest(centroid, bound_, budget_);
    if (!nearest) return centroid;
    if (nearest->triangle != nearest_ && isWithinBoundOf(nearest->triangle, polygon)) continue;
    nearest_ = nearest->triangle;

    double radius = 0;
    for (std::size_t i = 0; i < polygon.num_corners; ++i) radius = std::max(radius, length(subtract(polygon.corners[i], centroid)));
    if (nearest->distance + radius <= bound_) continue;
    if (radius <= kMinRadius * bound_ || polygon.depth == kMaxDepth) return centroid;
    split(polygon, centroid, radius);
  }
  return {};
}

bool HausdorffBound::isWithinBoundOf(std::uint32_t triangle, const Polygon& polygon) {
  ++budget_.spent;
  const auto end = polygon.corners.begin() + static_cast<std::ptrdiff_t>(polygon.num_corners);
  return std::all_of(polygon.corners.begin(), end,
                     [&](const Vector3& corner) { return squaredDistance(corner, surface_.corners(triangle)) <= bound_ * bound_; });
}

void HausdorffBound::split(const Polygon& polygon, const Vector3& centroid, double radius) {
  Polygon inside, outside;
  const std::optional<Plane> plane = planeAlongNearestTriangle(polygon, centroid, radius);
  if (!(plane && clip(*plane, polygon, inside, outside)) && !clip(bisectorPlane(polygon), polygon, inside, outside)) {
    // Too many corners, or thinner than rounding errors: split into a fan of triangles.
    for (std::size_t i = 2; i < polygon.num_corners; ++i) {
      Polygon& part = stack_.emplace_back();
      part.corners = {polygon.corners[0], polygon.corners[i - 1], polygon.corners[i]};
      part.num_corners = 3;
      part.depth = polygon.depth + 1;
    }
    return;
  }
  stack_.push_back(outside);
  stack_.push_back(inside);
}

// Chooses among three planes, one through each edge of the nearest triangle and perpendicular to the triangle, moved outwards as far as the
// bound allows at the polygon's greatest height above the triangle. Returns the plane with the farthest polygon corner outside. The
// centroid is inside.
std::optional<HausdorffBound::Plane> HausdorffBound::planeAlongNearestTriangle(const Polygon& polygon, const Vector3& centroid,
                                                                               double radius) const {
  const TriangleCorners& triangle = surface_.corners(nearest_);
  const Vector3 normal = cross(subtract(triangle[1], triangle[0]), subtract(triangle[2], triangle[0]));
  const double twice_area = length(normal);
  double longest_edge = 0;
  for (std::size_t edge = 0; edge < 3; ++edge) {
    longest_edge = std::max(longest_edge, length(subtract(triangle[(edge + 1) % 3], triangle[edge])));
  }
  if (!(twice_area > 0) || radius > kMaxRadius * longest_edge) return {};

  double height = 0;
  for (std::size_t i = 0; i < polygon.num_corners; ++i) {
    height = std::max(height, std::abs(dot(normal, subtract(polygon.corners[i], triangle[0]))) / twice_area);
  }
  // Half of the lateral distance that remains, since a corner may be outside two edges.
  const double offset = 0.5 * std::sqrt(std::max(0.0, bound_ * bound_ - height * height));
  double farthest = offset + kMinOvershoot * bound_;
  std::optional<Plane> result;
  for (std::size_t edge = 0; edge < 3; ++edge) {
    Vector3 outwards = cross(subtract(triangle[(edge + 1) % 3], triangle[edge]), normal);
    const double norm = length(outwards);
    if (!(norm > 0)) continue;
    outwards = scale(1 / norm, outwards);
    if (dot(outwards, subtract(centroid, triangle[edge])) >= offset) continue;
    for (std::size_t i = 0; i < polygon.num_corners; ++i) {
      const double distance = dot(outwards, subtract(polygon.corners[i], triangle[edge]));
      if (distance <= farthest) continue;
      farthest = distance;
      result = Plane{outwards, triangle[edge], offset};
    }
  }
  return result;
}

// The perpendicular bisector of the polygon's longest diagonal.
HausdorffBound::Plane HausdorffBound::bisectorPlane(const Polygon& polygon) {
  Plane plane{};
  double longest = -1;
  for (std::size_t i = 0; i < polygon.num_corners; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const Vector3 line = subtract(polygon.corners[i], polygon.corners[j]);
      if (dot(line, line) <= longest) continue;
      longest = dot(line, line);
      plane = {line, scale(0.5, add(polygon.corners[i], polygon.corners[j])), 0};
    }
  }
  return plane;
}

// Sutherland-Hodgman clipping that returns both sides. The new corners are bitwise equal on both. Returns false if a side would have more
// than kMaxCorners corners or fewer than three.
bool HausdorffBound::clip(const Plane& plane, const Polygon& polygon, Polygon& inside, Polygon& outside) {
  inside.num_corners = outside.num_corners = 0;
  inside.depth = outside.depth = polygon.depth + 1;
  std::array<double, kMaxCorners> signed_distance;
  for (std::size_t i = 0; i < polygon.num_corners; ++i)
    signed_distance[i] = dot(plane.normal, subtract(polygon.corners[i], plane.origin)) - plane.offset;
  for (std::size_t i = 0; i < polygon.num_corners; ++i) {
    const std::size_t next = i + 1 == polygon.num_corners ? 0 : i + 1;
    const bool crosses = (signed_distance[i] < 0 && signed_distance[next] > 0) || (signed_distance[i] > 0 && signed_distance[next] < 0);
    if (std::max(inside.num_corners, outside.num_corners) + 2 > kMaxCorners) return false;
    if (signed_distance[i] <= 0) inside.corners[inside.num_corners++] = polygon.corners[i];
    if (signed_distance[i] >= 0) outside.corners[outside.num_corners++] = polygon.corners[i];
    if (!crosses) continue;
    const double fraction = signed_distance[i] / (signed_distance[i] - signed_distance[next]);
    const Vector3 crossing = add(polygon.corners[i], scale(fraction, subtract(polygon.corners[next], polygon.corners[i])));
    inside.corners[inside.num_corners++] = crossing;
    outside.corners[outside.num_corners++] = crossing;
  }
  return inside.num_corners >= 3 && outside.num_corners >= 3;
}

}  // namespace taxelsim
