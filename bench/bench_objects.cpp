#include "bench_objects.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <utility>

namespace taxelsim::bench {
namespace {

using Corners = std::array<std::uint32_t, 3>;

constexpr double kPi = std::numbers::pi;
constexpr double kMaxTilt = kPi / 180;
constexpr double kMinDepth = 0.0003, kMaxDepth = 0.0015;  // m
constexpr double kHalfX = 0.005, kHalfY = 0.015;          // m

Vector3 onUnitSphere(const Vector3& p) {
  const double norm = std::sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
  return {p[0] / norm, p[1] / norm, p[2] / norm};
}

}  // namespace

Mesh ellipsoid(const Vector3& size, int levels) {
  const double g = std::numbers::phi;
  std::vector<Vector3> points;
  for (const Vector3& p : {Vector3{-1, g, 0},
                           {1, g, 0},
                           {-1, -g, 0},
                           {1, -g, 0},
                           {0, -1, g},
                           {0, 1, g},
                           {0, -1, -g},
                           {0, 1, -g},
                           {g, 0, -1},
                           {g, 0, 1},
                           {-g, 0, -1},
                           {-g, 0, 1}}) {
    points.push_back(onUnitSphere(p));
  }
  std::vector<Corners> triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                                    {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                                    {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [place, is_new] = middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(points.size()));
      if (is_new) {
        const Vector3 p = points[a], q = points[b];
        points.push_back(onUnitSphere({p[0] + q[0], p[1] + q[1], p[2] + q[2]}));
      }
      return place->second;
    };
    std::vector<Corners> finer;
    for (const auto& [a, b, c] : triangles) {
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      for (const Corners& corners : {Corners{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}}) finer.push_back(corners);
    }
    triangles = std::move(finer);
  }
  Mesh mesh;
  for (const Vector3& p : points) {
    mesh.vertices.push_back(
        {static_cast<float>(p[0] * size[0] / 2), static_cast<float>(p[1] * size[1] / 2), static_cast<float>(p[2] * size[2] / 2)});
  }
  mesh.triangles = std::move(triangles);
  return mesh;
}

Mesh hexPrism() {
  constexpr double kFlatToFlat = 0.012, kLength = 0.06;  // m
  constexpr std::uint32_t kSides = 6;
  const double radius = kFlatToFlat / 2 / std::cos(kPi / kSides);
  Mesh mesh;
  for (const double x : {-kLength / 2, kLength / 2}) {
    for (std::uint32_t side = 0; side < kSides; ++side) {
      const double angle = kPi / 3 * side;
      mesh.vertices.push_back(
          {static_cast<float>(x), static_cast<float>(radius * std::cos(angle)), static_cast<float>(radius * std::sin(angle))});
    }
  }
  const auto middle = static_cast<std::uint32_t>(mesh.vertices.size());  // of the end at -x; the one at +x follows
  for (const double x : {-kLength / 2, kLength / 2}) mesh.vertices.push_back({static_cast<float>(x), 0, 0});
  for (std::uint32_t a = 0; a < kSides; ++a) {
    const std::uint32_t b = (a + 1) % kSides;
    for (const Corners& corners :
         {Corners{a, b, kSides + b}, {a, kSides + b, kSides + a}, {middle, b, a}, {middle + 1, kSides + a, kSides + b}}) {
      mesh.triangles.push_back(corners);
    }
  }
  return mesh;
}

Mesh tessellatedCylinder(double radius, double length, int segments) {
  Mesh mesh;
  const auto half = static_cast<float>(length / 2);
  for (int s = 0; s < segments; ++s) {
    const double angle = 2 * kPi * s / segments;
    const auto x = static_cast<float>(radius * std::cos(angle)), y = static_cast<float>(radius * std::sin(angle));
    mesh.vertices.push_back({x, y, -half});
    mesh.vertices.push_back({x, y, half});
  }
  const auto bottom = static_cast<std::uint32_t>(mesh.vertices.size()), top = bottom + 1;
  mesh.vertices.push_back({0, 0, -half});
  mesh.vertices.push_back({0, 0, half});
  for (int s = 0; s < segments; ++s) {
    const auto a = static_cast<std::uint32_t>(2 * s), b = static_cast<std::uint32_t>(2 * ((s + 1) % segments));
    for (const Corners& corners : {Corners{a, b, b + 1}, {a, b + 1, a + 1}, {bottom, b, a}, {top, a + 1, b + 1}})
      mesh.triangles.push_back(corners);
  }
  return mesh;
}

std::vector<Pose> randomPoses(const Object& object, const PoseSpread& spread, int count, std::uint64_t seed) {
  // The standard fixes the output of the engine, not that of distributions.
  std::mt19937_64 engine(seed);
  const auto uniform = [&](double low, double high) { return low + (high - low) * static_cast<double>(engine() >> 11) * 0x1p-53; };
  std::vector<Pose> poses;
  for (int i = 0; i < count; ++i) {
    const double tilt_direction = uniform(-kPi, kPi), tilt = uniform(0, kMaxTilt), yaw = uniform(-kPi, kPi);
    const double roll = uniform(-kPi, kPi), x = uniform(-kHalfX, kHalfX), y = uniform(-kHalfY, kHalfY);
    Quaternion R_SO = spread.rolls ? axisAngle({1, 0, 0}, roll) * spread.laid : spread.laid;
    R_SO = axisAngle({std::cos(tilt_direction), std::sin(tilt_direction), 0}, tilt) * (axisAngle({0, 0, 1}, yaw) * R_SO);
    const Vector3 lowest = rotate(R_SO, lowestPoint(object, R_SO));
    poses.push_back({{x - lowest[0], y - lowest[1], -uniform(kMinDepth, kMaxDepth) - lowest[2]}, R_SO});
  }
  return poses;
}

}  // namespace taxelsim::bench
