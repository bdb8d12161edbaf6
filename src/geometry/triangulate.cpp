#include "geometry/triangulate.h"

#include <algorithm>
#include <cmath>

#include "base/vector3.h"

namespace taxelsim {
namespace {

constexpr std::uint64_t kMaxTests = 1'000'000'000;

Vector3 vectorOf(const Triangulator::Vertex& vertex) {
  return {vertex[0], vertex[1], vertex[2]};
}

// Sum of the cross products of edges and corners, twice the area times the normal.
Vector3 areaVector(std::span<const Triangulator::Vertex> vertices, std::span<const std::uint32_t> corners) {
  const Vector3 origin = vectorOf(vertices[corners[0]]);
  Vector3 sum{0, 0, 0};
  for (std::size_t i = 2; i < corners.size(); ++i) {
    sum = add(sum, cross(subtract(vectorOf(vertices[corners[i - 1]]), origin), subtract(vectorOf(vertices[corners[i]]), origin)));
  }
  return sum;
}

// Twice the signed area of a triangle in the plane.
double area(const std::array<double, 2>& a, const std::array<double, 2>& b, const std::array<double, 2>& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

}  // namespace

bool Triangulator::isEar(std::size_t at) {
  const std::size_t n = left_.size();
  const Point &a = points_[left_[(at + n - 1) % n]], &b = points_[left_[at]], &c = points_[left_[(at + 1) % n]];
  ++num_tests_;
  if (area(a, b, c) <= 0) return false;
  num_tests_ += n;
  for (std::size_t i = 2; i < n - 1; ++i) {
    const Point& p = points_[left_[(at + i) % n]];
    const bool is_corner = p == a || p == b || p == c;
    if (!is_corner && area(a, b, p) >= 0 && area(b, c, p) >= 0 && area(c, a, p) >= 0) return false;
  }
  return true;
}

bool Triangulator::operator()(std::span<const Vertex> vertices, std::span<const std::uint32_t> corners, std::vector<Triangle>& triangles) {
  const std::size_t n = corners.size();
  const auto addFan = [&](std::span<const std::uint32_t> fan) {
    for (std::size_t i = 2; i < fan.size(); ++i) triangles.push_back({fan[0], fan[i - 1], fan[i]});
  };
  if (n <= 3) {
    addFan(corners);
    return true;
  }
  // Drops the axis along which the polygon's area vector is longest, and keeps the orientation.
  const Vector3 normal = areaVector(vertices, corners);
  std::size_t axis = 0;
  for (std::size_t other = 1; other < 3; ++other) {
    if (std::abs(normal[other]) > std::abs(normal[axis])) axis = other;
  }
  const double sign = normal[axis] < 0 ? -1 : 1;
  points_.clear();
  left_.clear();
  for (std::uint32_t i = 0; i < n; ++i) {
    const Vector3 p = vectorOf(vertices[corners[i]]);
    points_.push_back({sign * p[(axis + 1) % 3], p[(axis + 2) % 3]});
    left_.push_back(i);
  }
  const auto isConvexAt = [&](std::size_t i) { return area(points_[(i + n - 1) % n], points_[i], points_[(i + 1) % n]) >= 0; };
  std::size_t first_concave = 0;
  while (first_concave < n && isConvexAt(first_concave)) ++first_concave;
  if (first_concave == n) {
    addFan(corners);
    return true;
  }
  for (std::size_t at = 0, num_failures = 0; left_.size() > 3 && num_failures < left_.size();) {
    if (num_tests_ > kMaxTests) return false;
    if (!isEar(at)) {
      at = (at + 1) % left_.size();
      ++num_failures;
      continue;
    }
    const std::size_t size = left_.size();
    triangles.push_back({corners[left_[(at + size - 1) % size]], corners[left_[at]], corners[left_[(at + 1) % size]]});
    left_.erase(left_.begin() + static_cast<std::ptrdiff_t>(at));
    at %= left_.size();
    num_failures = 0;
  }
  for (std::size_t i = 2; i < left_.size(); ++i) triangles.push_back({corners[left_[0]], corners[left_[i - 1]], corners[left_[i]]});
  return true;
}

}  // namespace taxelsim
