#include "support/pressed_shapes.h"

#include "support/random_scene.h"
#include "support/test.h"

namespace taxelsim::support {
namespace {

constexpr double kPi = std::numbers::pi;

std::function<double(double)> flat(double area) {
  return [area](double depth) { return area * depth; };
}

double cap(double radius, double depth) {
  return kPi * depth * depth * (radius - depth / 3);
}

// Area of the segment of a circle.
double segment(double radius, double depth) {
  return radius * radius * std::acos(1 - depth / radius) - (radius - depth) * std::sqrt(2 * radius * depth - depth * depth);
}

Quaternion alongY() {
  return axisAngle({1, 0, 0}, kPi / 2);
}

Mesh pinMesh(double radius, double length) {
  constexpr int kSides = 96;
  constexpr double kAngle = 2 * kPi / kSides;
  const double r = radius * std::sqrt(kAngle / std::sin(kAngle));
  Mesh mesh;
  for (int i = 0; i < kSides; ++i) {
    const auto x = static_cast<float>(r * std::cos(i * kAngle)), y = static_cast<float>(r * std::sin(i * kAngle));
    mesh.vertices.push_back({x, y, static_cast<float>(-length / 2)});
    mesh.vertices.push_back({x, y, static_cast<float>(length / 2)});
  }
  mesh.vertices.push_back({0, 0, static_cast<float>(-length / 2)});
  mesh.vertices.push_back({0, 0, static_cast<float>(length / 2)});
  for (unsigned i = 0; i < kSides; ++i) {
    const unsigned j = (i + 1) % kSides;
    mesh.triangles.insert(mesh.triangles.end(), {{2 * i, 2 * j, 2 * j + 1}, {2 * i, 2 * j + 1, 2 * i + 1}});
    mesh.triangles.insert(mesh.triangles.end(), {{2 * kSides, 2 * i, 2 * j}, {2 * kSides + 1, 2 * j + 1, 2 * i + 1}});
  }
  return mesh;
}

// Adds `more` to a mesh as a part of its own.
void append(Mesh& mesh, const Mesh& more, double x) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const std::array<float, 3>& v : more.vertices) mesh.vertices.push_back({v[0] + static_cast<float>(x), v[1], v[2]});
  for (const std::array<std::uint32_t, 3>& t : more.triangles) mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
}

// One overload per alternative of Shape adds its rows.
struct Rows {
  double skin_area;
  std::vector<PressedShape> rows;

  void add(const std::type_identity<Sphere>&) { rows.push_back(pressed(Sphere{8e-3})); }
  void add(const std::type_identity<Cylinder>&) {
    rows.push_back(pressed(Cylinder{4e-3, 12e-3}));
    rows.push_back(lying(Cylinder{5e-3, 11e-3}));
  }
  void add(const std::type_identity<Capsule>&) { rows.push_back(lying(Capsule{4e-3, 6e-3})); }
  void add(const std::type_identity<Box>&) { rows.push_back(pressed(Box{{8e-3, 7e-3, 10e-3}})); }
  void add(const std::type_identity<HalfSpace>&) { rows.push_back(pressed(HalfSpace{}, skin_area)); }
  void add(const std::type_identity<Cone>&) { rows.push_back(pressed(Cone{.radius = 18e-3, .height = 3e-3})); }
  void add(const std::type_identity<Torus>&) { rows.push_back(pressed(Torus{4e-3, 2e-3})); }
  // A polyhedron, a mesh with large triangles, one with small triangles, two bodies in one mesh, and a mesh that is not closed.
  void add(const std::type_identity<Mesh>&) {
    constexpr double kHeight = 10e-3;
    Random unused(0);
    const Mesh leg = boxMesh({3e-3, 7e-3, kHeight});
    Mesh fork;
    append(fork, leg, -3e-3);
    append(fork, leg, 3e-3);
    const double radius = 8e-3, sheet = 8e-3;
    rows.push_back({Object("polyhedron", boxMesh({7e-3, 8e-3, kHeight})), kHeight / 2, {1, 0, 0, 0}, flat(56e-6)});
    rows.push_back(pressedPin(4e-3, 12e-3));
    rows.push_back(
        {Object("ball", icosphere(radius, 5, 0, unused)), radius, {1, 0, 0, 0}, [=](double depth) { return cap(radius, depth); }});
    rows.push_back({Object("fork", fork), kHeight / 2, {1, 0, 0, 0}, flat(2 * 21e-6)});
    rows.push_back({Object("sheet", sheetWithHoles(3, sheet, 0, 0, unused)), 0, {1, 0, 0, 0}, flat(sheet * sheet), false});
  }
};

}  // namespace

PressedShape pressed(const Sphere& sphere) {
  return {Object(sphere), sphere.radius, {1, 0, 0, 0}, [=](double depth) { return cap(sphere.radius, depth); }};
}

PressedShape pressed(const Cylinder& cylinder) {
  return {Object(cylinder), cylinder.length / 2, {1, 0, 0, 0}, flat(kPi * cylinder.radius * cylinder.radius)};
}

// A straight part between the halves of a ball.
PressedShape pressed(const Capsule& capsule) {
  return {Object(capsule), capsule.length / 2 + capsule.radius, {1, 0, 0, 0}, [=](double depth) { return cap(capsule.radius, depth); }};
}

PressedShape pressed(const Box& box) {
  return {Object(box), box.size[2] / 2, {1, 0, 0, 0}, flat(box.size[0] * box.size[1])};
}

PressedShape pressed(const HalfSpace& half_space, double skin_area) {
  return {Object(half_space), 0, {1, 0, 0, 0}, flat(skin_area)};
}

PressedShape pressed(const Cone& cone) {
  const double slope = cone.radius / cone.height;
  return {Object(cone), 0, {1, 0, 0, 0}, [=](double depth) { return kPi * depth * depth * depth * slope * slope / 3; }};
}

// By Pappus's theorem.
PressedShape pressed(const Torus& torus) {
  return {Object(torus), torus.minor_radius, {1, 0, 0, 0}, [=](double depth) {
            return 2 * kPi * torus.major_radius * segment(torus.minor_radius, depth);
          }};
}

PressedShape lying(const Cylinder& cylinder) {
  return {Object(cylinder), cylinder.radius, alongY(), [=](double depth) { return cylinder.length * segment(cylinder.radius, depth); }};
}

PressedShape lying(const Capsule& capsule) {
  return {Object(capsule), capsule.radius, alongY(),
          [=](double depth) { return capsule.length * segment(capsule.radius, depth) + cap(capsule.radius, depth); }};
}

PressedShape pressedPin(double radius, double length) {
  return {Object("pin", pinMesh(radius, length)), length / 2, {1, 0, 0, 0}, flat(kPi * radius * radius)};
}

std::vector<PressedShape> everyPressedShape(double skin_area) {
  Rows all{.skin_area = skin_area, .rows = {}};
  [&]<std::size_t... I>(std::index_sequence<I...>) {
    (all.add(std::type_identity<std::variant_alternative_t<I, Shape>>{}), ...);
  }
  (std::make_index_sequence<std::variant_size_v<Shape>>{});
  return all.rows;
}

}  // namespace taxelsim::support
