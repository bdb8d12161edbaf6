#include "geometry/surface_distance.h"

#include <algorithm>
#include <cmath>

#include "base/vector3.h"

namespace taxelsim {
namespace {

// Cuts that may lie over one another; meshes of a million triangles over a flat face of two take fewer than half.
constexpr int kMaxDepth = 128;

// Taken off the bound, times the largest coordinate. Each of the cuts above a piece moves a corner by the rounding of three operations,
// 2^-53 of a coordinate each along three axes, and a distance adds some ten more: (128 x 3 + 10) x sqrt(3) x 2^-53 = 7.6e-14.
constexpr double kRounding = 1e-13;

// Radius of a piece, in bounds, that is cut no further.
constexpr double kTiny = 1e-6;

// A piece much larger than the triangle below it is halved first, or the cuts would leave long shreds. In longest edges.
constexpr double kMaxRadius = 4;

// How far beyond a cut a corner must lie to be worth it, in bounds.
constexpr double kMinOvershoot = 0.01;

}  // namespace

BoundCheck::BoundCheck(const TriangleTree& surface, double bound, Effort& effort)
    : surface_(surface), bound_(bound - kRounding * (surface.largestCoordinate() + bound)), effort_(effort) {}

std::optional<Vector3> BoundCheck::findBeyond(const TriangleCorners& triangle) {
  if (!(bound_ > 0) || surface_.numTriangles() == 0) return triangle[0];
  Piece piece;
  std::copy(triangle.begin(), triangle.end(), piece.corners.begin());
  piece.num_corners = 3;
  waiting_.assign(1, piece);
  while (!waiting_.empty()) {
    piece = waiting_.back();
    waiting_.pop_back();
    if (isCoveredBy(nearest_, piece)) continue;

    Vector3 middle{0, 0, 0};
    for (std::size_t i = 0; i < piece.num_corners; ++i) {
      middle = add(middle, scale(1.0 / static_cast<double>(piece.num_corners), piece.corners[i]));
    }
    if (effort_.isExhausted()) return middle;
    const std::optional<TriangleTree::Nearest> nearest = surface_.nearest(middle, bound_, effort_);
    if (!nearest) return middle;
    if (nearest->triangle != nearest_ && isCoveredBy(nearest->triangle, piece)) continue;
    nearest_ = nearest->triangle;

    double radius = 0;
    for (std::size_t i = 0; i < piece.num_corners; ++i) radius = std::max(radius, length(subtract(piece.corners[i], middle)));
    if (nearest->distance + radius <= bound_) continue;
    if (radius <= kTiny * bound_ || piece.depth == kMaxDepth) return middle;
    split(piece, middle, radius);
  }
  return {};
}

bool BoundCheck::isCoveredBy(std::uint32_t triangle, const Piece& piece) {
  ++effort_.spent;
  const auto end = piece.corners.begin() + static_cast<std::ptrdiff_t>(piece.num_corners);
  return std::all_of(piece.corners.begin(), end,
                     [&](const Vector3& corner) { return squaredDistance(corner, surface_.corners(triangle)) <= bound_ * bound_; });
}

void BoundCheck::split(const Piece& piece, const Vector3& middle, double radius) {
  Piece inside, outside;
  const std::optional<Cut> cut = cutAlongNearest(piece, middle, radius);
  if (!(cut && apply(*cut, piece, inside, outside)) && !apply(cutInHalf(piece), piece, inside, outside)) {
    // Too many corners, or thinner than rounding: a fan of triangles always works.
    for (std::size_t i = 2; i < piece.num_corners; ++i) {
      Piece& part = waiting_.emplace_back();
      part.corners = {piece.corners[0], piece.corners[i - 1], piece.corners[i]};
      part.num_corners = 3;
      part.depth = piece.depth + 1;
    }
    return;
  }
  waiting_.push_back(outside);
  waiting_.push_back(inside);
}

// The plane through an edge of the nearest triangle, square to the triangle, moved outwards as far as the bound allows at the piece's
// greatest height over the triangle. Of three such planes that with the farthest corner of the piece beyond; its middle must not be.
std::optional<BoundCheck::Cut> BoundCheck::cutAlongNearest(const Piece& piece, const Vector3& middle, double radius) const {
  const TriangleCorners& triangle = surface_.corners(nearest_);
  const Vector3 normal = cross(subtract(triangle[1], triangle[0]), subtract(triangle[2], triangle[0]));
  const double twice_area = length(normal);
  double longest_edge = 0;
  for (std::size_t edge = 0; edge < 3; ++edge) {
    longest_edge = std::max(longest_edge, length(subtract(triangle[(edge + 1) % 3], triangle[edge])));
  }
  if (!(twice_area > 0) || radius > kMaxRadius * longest_edge) return {};

  double height = 0;
  for (std::size_t i = 0; i < piece.num_corners; ++i) {
    height = std::max(height, std::abs(dot(normal, subtract(piece.corners[i], triangle[0]))) / twice_area);
  }
  // Half of what is left sideways, since a corner may lie beyond two edges.
  const double offset = 0.5 * std::sqrt(std::max(0.0, bound_ * bound_ - height * height));
  double farthest = offset + kMinOvershoot * bound_;
  std::optional<Cut> result;
  for (std::size_t edge = 0; edge < 3; ++edge) {
    Vector3 outwards = cross(subtract(triangle[(edge + 1) % 3], triangle[edge]), normal);
    const double norm = length(outwards);
    if (!(norm > 0)) continue;
    outwards = scale(1 / norm, outwards);
    if (dot(outwards, subtract(middle, triangle[edge])) >= offset) continue;
    for (std::size_t i = 0; i < piece.num_corners; ++i) {
      const double distance = dot(outwards, subtract(piece.corners[i], triangle[edge]));
      if (distance <= farthest) continue;
      farthest = distance;
      result = Cut{outwards, triangle[edge], offset};
    }
  }
  return result;
}

// Square to the line between the two corners that are farthest apart, half way.
BoundCheck::Cut BoundCheck::cutInHalf(const Piece& piece) {
  Cut cut{};
  double longest = -1;
  for (std::size_t i = 0; i < piece.num_corners; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const Vector3 line = subtract(piece.corners[i], piece.corners[j]);
      if (dot(line, line) <= longest) continue;
      longest = dot(line, line);
      cut = {line, scale(0.5, add(piece.corners[i], piece.corners[j])), 0};
    }
  }
  return cut;
}

// False when a side would get too many corners or be no polygon. Both sides share the new corners to the bit.
bool BoundCheck::apply(const Cut& cut, const Piece& piece, Piece& inside, Piece& outside) {
  inside.num_corners = outside.num_corners = 0;
  inside.depth = outside.depth = piece.depth + 1;
  std::array<double, kMaxCorners> beyond;
  for (std::size_t i = 0; i < piece.num_corners; ++i) beyond[i] = dot(cut.normal, subtract(piece.corners[i], cut.origin)) - cut.offset;
  for (std::size_t i = 0; i < piece.num_corners; ++i) {
    const std::size_t next = i + 1 == piece.num_corners ? 0 : i + 1;
    const bool crosses = (beyond[i] < 0 && beyond[next] > 0) || (beyond[i] > 0 && beyond[next] < 0);
    if (std::max(inside.num_corners, outside.num_corners) + 2 > kMaxCorners) return false;
    if (beyond[i] <= 0) inside.corners[inside.num_corners++] = piece.corners[i];
    if (beyond[i] >= 0) outside.corners[outside.num_corners++] = piece.corners[i];
    if (!crosses) continue;
    const double part = beyond[i] / (beyond[i] - beyond[next]);
    const Vector3 crossing = add(piece.corners[i], scale(part, subtract(piece.corners[next], piece.corners[i])));
    inside.corners[inside.num_corners++] = crossing;
    outside.corners[outside.num_corners++] = crossing;
  }
  return inside.num_corners >= 3 && outside.num_corners >= 3;
}

}  // namespace taxelsim
