#include "figures/object_surface.h"

#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>

#include "geometry/outward.h"

namespace taxelsim::figures {
namespace {

constexpr int kSegments = 48;  // around an axis of revolution, and along a whole circle of a profile

using Profile = std::vector<std::array<double, 2>>;  // distances from the z axis and heights, m, upwards on the outside

// Appends the corners, counter-clockwise from outside, as two triangles; those without area are left out.
void appendQuad(std::vector<Triangle3>& triangles, const std::array<Vector3, 4>& corners) {
  if (corners[0] != corners[1] && corners[1] != corners[2]) triangles.push_back({corners[0], corners[1], corners[2]});
  if (corners[2] != corners[3] && corners[3] != corners[0]) triangles.push_back({corners[0], corners[2], corners[3]});
}

ObjectSurface revolved(const Profile& profile) {
  const auto at = [](const std::array<double, 2>& point, int segment) -> Vector3 {
    const double angle = 2 * std::numbers::pi * (segment % kSegments) / kSegments;
    return {point[0] * std::cos(angle), point[0] * std::sin(angle), point[1]};
  };
  ObjectSurface surface{.triangles = {}, .is_outward = true};
  for (std::size_t p = 0; p + 1 < profile.size(); ++p) {
    for (int s = 0; s < kSegments; ++s) {
      appendQuad(surface.triangles, {at(profile[p], s), at(profile[p], s + 1), at(profile[p + 1], s + 1), at(profile[p + 1], s)});
    }
  }
  return surface;
}

// Appends an arc about `centre` to a profile, from the angle `first` to `last`, from -z towards the outside.
void appendArc(Profile& profile, double radius, double first, double last, const std::array<double, 2>& centre) {
  const int steps = static_cast<int>(std::lround(kSegments * (last - first) / (2 * std::numbers::pi)));
  for (int k = 0; k <= steps; ++k) {
    const double angle = first + (last - first) * k / steps, sine = std::sin(angle);
    // The poles lie on the axis.
    profile.push_back({centre[0] + radius * (std::abs(sine) < 1e-12 ? 0 : sine), centre[1] - radius * std::cos(angle)});
  }
}

constexpr double kQuarter = std::numbers::pi / 2;

ObjectSurface surfaceOf(const Mesh& file_mesh, double /*half_side*/) {
  const std::optional<Mesh> outward = outwardMesh(file_mesh);
  const Mesh& mesh = outward ? *outward : file_mesh;
  ObjectSurface surface{.triangles = {}, .is_outward = outward.has_value()};
  const auto corner = [&](std::uint32_t v) -> Vector3 { return {mesh.vertices[v][0], mesh.vertices[v][1], mesh.vertices[v][2]}; };
  for (const auto& [a, b, c] : mesh.triangles) surface.triangles.push_back({corner(a), corner(b), corner(c)});
  return surface;
}

ObjectSurface surfaceOf(const Sphere& sphere, double /*half_side*/) {
  Profile profile;
  appendArc(profile, sphere.radius, 0, 2 * kQuarter, {0, 0});
  return revolved(profile);
}

ObjectSurface surfaceOf(const Cylinder& cylinder, double /*half_side*/) {
  const double h = cylinder.length / 2;
  return revolved({{0, -h}, {cylinder.radius, -h}, {cylinder.radius, h}, {0, h}});
}

ObjectSurface surfaceOf(const Capsule& capsule, double /*half_side*/) {
  Profile profile;
  appendArc(profile, capsule.radius, 0, kQuarter, {0, -capsule.length / 2});
  appendArc(profile, capsule.radius, kQuarter, 2 * kQuarter, {0, capsule.length / 2});
  return revolved(profile);
}

// Corners by bits: x, y, z.
ObjectSurface surfaceOf(const Box& box, double /*half_side*/) {
  constexpr int kFaces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  const auto corner = [&box](int bits) -> Vector3 {
    return {((bits & 1) - 0.5) * box.size[0], ((bits >> 1 & 1) - 0.5) * box.size[1], ((bits >> 2 & 1) - 0.5) * box.size[2]};
  };
  ObjectSurface surface{.triangles = {}, .is_outward = true};
  for (const auto& face : kFaces) appendQuad(surface.triangles, {corner(face[0]), corner(face[1]), corner(face[2]), corner(face[3])});
  return surface;
}

ObjectSurface surfaceOf(const HalfSpace&, double half_side) {
  const double h = half_side;
  ObjectSurface surface;
  appendQuad(surface.triangles, {{{-h, -h, 0}, {-h, h, 0}, {h, h, 0}, {h, -h, 0}}});
  return surface;
}

ObjectSurface surfaceOf(const Cone& cone, double /*half_side*/) {
  return revolved({{0, 0}, {cone.radius, cone.height}, {0, cone.height}});
}

ObjectSurface surfaceOf(const Torus& torus, double /*half_side*/) {
  Profile profile;
  appendArc(profile, torus.minor_radius, 0, 4 * kQuarter, {torus.major_radius, 0});
  return revolved(profile);
}

}  // namespace

ObjectSurface surfaceOf(const Shape& shape, double half_side) {
  return std::visit([half_side](const auto& kind) { return surfaceOf(kind, half_side); }, shape);
}

}  // namespace taxelsim::figures
