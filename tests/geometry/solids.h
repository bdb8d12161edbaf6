// Brute-force oracle for bounds and lowest points: each analytic solid as an implicit function and as points on its surface.
#pragma once

#include "support/test.h"
#include "taxelsim/object.h"

namespace taxelsim {

// Implicit function at p: < 0 inside, 0 on the surface, > 0 outside; equals the distance (m) near the surface.
struct ImplicitFunction {
  Vector3 p;

  double axisDistance() const { return std::hypot(p[0], p[1]); }
  double operator()(const Sphere& s) const { return std::hypot(p[0], p[1], p[2]) - s.radius; }
  double operator()(const Cylinder& c) const { return std::max(axisDistance() - c.radius, std::abs(p[2]) - c.length / 2); }
  double operator()(const Capsule& c) const { return std::hypot(axisDistance(), std::max(std::abs(p[2]) - c.length / 2, 0.0)) - c.radius; }
  double operator()(const Box& b) const {
    return std::max({std::abs(p[0]) - b.size[0] / 2, std::abs(p[1]) - b.size[1] / 2, std::abs(p[2]) - b.size[2] / 2});
  }
  double operator()(const HalfSpace&) const { return -p[2]; }
  double operator()(const Cone& c) const {
    const double slant = std::hypot(c.radius, c.height);
    return std::max((axisDistance() * c.height - p[2] * c.radius) / slant, p[2] - c.height);
  }
  double operator()(const Torus& t) const { return std::hypot(axisDistance() - t.major_radius, p[2]) - t.minor_radius; }
  double operator()(const Mesh&) const { return 0; }
};

// Points on the surface, including rims and corners. `n`: points of a circle.
struct SurfacePoints {
  int n = 48;

  std::vector<Vector3> revolve(const std::vector<std::array<double, 2>>& profile) const {
    std::vector<Vector3> points;
    for (const auto& [r, z] : profile) {
      for (int i = 0; i < n; ++i) {
        const double angle = 2 * std::numbers::pi * i / n;
        points.push_back({r * std::cos(angle), r * std::sin(angle), z});
      }
    }
    return points;
  }
  std::vector<std::array<double, 2>> arc(double r, double z, double radius) const {
    std::vector<std::array<double, 2>> profile;
    for (int i = 0; i <= 2 * n; ++i) {
      const double angle = std::numbers::pi * (static_cast<double>(i) / n - 0.5);
      profile.push_back({r + radius * std::cos(angle), z + radius * std::sin(angle)});
    }
    return profile;
  }
  std::vector<Vector3> operator()(const Sphere& s) const { return revolve(arc(0, 0, s.radius)); }
  std::vector<Vector3> operator()(const Cylinder& c) const {
    return revolve({{0, -c.length / 2},
                    {c.radius / 2, -c.length / 2},
                    {c.radius, -c.length / 2},
                    {c.radius, 0},
                    {c.radius, c.length / 2},
                    {0, c.length / 2}});
  }
  std::vector<Vector3> operator()(const Capsule& c) const {
    auto profile = arc(0, c.length / 2, c.radius);
    std::erase_if(profile, [&](const auto& point) { return point[1] < c.length / 2; });
    const std::size_t half = profile.size();
    for (std::size_t i = 0; i < half; ++i) profile.push_back({profile[i][0], -profile[i][1]});
    return revolve(profile);
  }
  std::vector<Vector3> operator()(const Box& b) const {
    std::vector<Vector3> points;
    for (int i = 0; i < 27; ++i)
      points.push_back({(i % 3 - 1) * b.size[0] / 2, (i / 3 % 3 - 1) * b.size[1] / 2, (i / 9 - 1) * b.size[2] / 2});
    return points;
  }
  std::vector<Vector3> operator()(const HalfSpace&) const { return {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}; }
  std::vector<Vector3> operator()(const Cone& c) const {
    return revolve({{0, 0}, {c.radius / 2, c.height / 2}, {c.radius, c.height}, {0, c.height}});
  }
  std::vector<Vector3> operator()(const Torus& t) const { return revolve(arc(t.major_radius, 0, t.minor_radius)); }
  std::vector<Vector3> operator()(const Mesh& mesh) const {
    std::vector<Vector3> points;
    for (const auto& v : mesh.vertices) points.push_back({v[0], v[1], v[2]});
    return points;
  }
};

}  // namespace taxelsim
