// Mean depth over the cells of samples against closed forms, each with the error of point sampling next to it.
#include "reference/area_depth.h"

#include "base/vector3.h"
#include "reference/frame.h"
#include "reference/solids.h"
#include "support/random_scene.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using reference::PlacedObject;
using support::Random;

constexpr double kPi = std::numbers::pi;
constexpr double kStiffness = 1.73e8;   // N/m^3
constexpr double kThickness = 1.45e-3;  // m
constexpr double kCell = 3.4e-3 / 4;    // m
constexpr double kDepth = 0.3e-3;       // m
constexpr int kPlaces = 200;
// Rounding of sums of at most 1e4 terms in double, and of vertices in float32 (relative to lengths of 1 mm, at coordinates of 10 mm).
constexpr double kExact = 1e-11, kFloat = 1e-5;
// Relative error of a force from solids: an outline of radius R crosses about 8 R / w cells, each within 1e-5 of its area (see
// kMeanDepthTolerance) where the outline is a wall; for R = w / 2 this is 4e-5 / (pi / 4). Rounder contacts have no wall.
constexpr double kSolid = 1e-4;

Sensor pad(DepthSampling sampling) {
  Sensor sensor = support::gridSensor({.num_rows = 4, .num_cols = 5, .thickness = kThickness, .law = {kStiffness, 1, 0}});
  sensor.depth_sampling = sampling;
  return sensor;
}

double forceOf(const Object& object, const Pose& pose, DepthSampling sampling = DepthSampling::kArea) {
  const PlacedObject placed{&object, pose};
  return reference::simulateFrame(pad(sampling), {.objects = {placed}}).contact.total_force;
}

// A convex prism of `sides` sides with its axis along z, of the given circumradius.
Mesh prismMesh(int sides, double radius, double length) {
  std::vector<std::array<double, 2>> outline;
  for (int n = 0; n < sides; ++n) outline.push_back({radius * std::cos(2 * kPi * n / sides), radius * std::sin(2 * kPi * n / sides)});
  Mesh mesh = support::prism(outline, length);
  for (auto& [x, y, z] : mesh.vertices) std::tie(y, z) = std::tuple(-z, y);
  return mesh;
}

Quaternion yawed(double angle) {
  return {std::cos(angle / 2), 0, 0, std::sin(angle / 2)};
}
const Quaternion kLying{std::sqrt(0.5), std::sqrt(0.5), 0, 0};  // z along -y

// Worst relative error of the force over random places, at most 2 mm from the middle and at any yaw, with `lift` (m) the height of the
// origin of O.
struct Errors {
  double area = 0, point = 0;
};
Errors worstErrors(const Object& object, double lift, double expected, const Quaternion& R_SO = {1, 0, 0, 0}, int num_places = kPlaces) {
  Random random(7);
  Errors worst;
  for (int n = 0; n < num_places; ++n) {
    const Pose pose{{random.uniform(-2e-3, 2e-3), random.uniform(-2e-3, 2e-3), lift}, yawed(random.uniform(0, 2 * kPi)) * R_SO};
    worst.area = std::max(worst.area, std::abs(forceOf(object, pose) / expected - 1));
    worst.point = std::max(worst.point, std::abs(forceOf(object, pose, DepthSampling::kPoint) / expected - 1));
  }
  return worst;
}

double capVolume(double radius, double depth) {
  return kPi * depth * depth * (radius - depth / 3);
}
double segmentArea(double radius, double depth) {
  const double height = radius - depth;
  return radius * radius * std::acos(height / radius) - height * std::sqrt(2 * radius * depth - depth * depth);
}

TEST(AreaDepth, FlatPinsPressWithTheirArea) {
  for (const double radius : {0.2e-3, 0.5e-3, 1e-3}) {
    SCOPED_TRACE(radius);
    const Errors cylinder = worstErrors(Cylinder{radius, 0.01}, 0.005 - kDepth, kStiffness * kPi * radius * radius * kDepth);
    EXPECT_LT(cylinder.area, kSolid);
    EXPECT_GT(cylinder.point, 0.3);
    constexpr int kSides = 96;
    const double area = kSides / 2.0 * radius * radius * std::sin(2 * kPi / kSides);
    EXPECT_LT(worstErrors(prismMesh(kSides, radius, 0.01), 0.005 - kDepth, kStiffness * area * kDepth).area, kFloat);
  }
}

TEST(AreaDepth, SpheresPressWithTheirCap) {
  for (const double radius : {0.5e-3, 1e-3, 5e-3}) {
    SCOPED_TRACE(radius);
    const Errors errors = worstErrors(Sphere{radius}, radius - kDepth, kStiffness * capVolume(radius, kDepth));
    EXPECT_LT(errors.area, kSolid);
    EXPECT_GT(errors.point, 0.02);
  }
  EXPECT_LT(worstErrors(Capsule{1e-3, 5e-3}, 3.5e-3 - kDepth, kStiffness * capVolume(1e-3, kDepth), {1, 0, 0, 0}, 20).area, kSolid);
}

TEST(AreaDepth, LyingWiresAndRingsPressWithTheirSegment) {
  const double radius = 0.5e-3, segment = segmentArea(radius, kDepth);
  const Errors wire = worstErrors(Cylinder{radius, 4e-3}, radius - kDepth, kStiffness * segment * 4e-3, kLying);
  EXPECT_LT(wire.area, kSolid);
  EXPECT_GT(wire.point, 0.1);
  // Pappus: the segment's centroid runs along the circle of the major radius.
  EXPECT_LT(worstErrors(Torus{2e-3, radius}, radius - kDepth, kStiffness * segment * 2 * kPi * 2e-3, {1, 0, 0, 0}, 2).area, kSolid);
}

TEST(AreaDepth, ConesPressWithTheirTip) {
  const double tip = 0.8 * kDepth;  // radius at the skin, for radius / height = 0.8
  const double expected = kStiffness * kPi * tip * tip * kDepth / 3;
  EXPECT_LT(worstErrors(Cone{4e-3, 5e-3}, -kDepth, expected, {1, 0, 0, 0}, 20).area, kSolid);
}

TEST(AreaDepth, BoxesPressWithTheirAreaAtAnyYaw) {
  for (const Vector3& size : {Vector3{1e-3, 4e-3, 5e-3}, Vector3{3e-3, 3e-3, 5e-3}}) {
    const double expected = kStiffness * size[0] * size[1] * kDepth;
    const Errors box = worstErrors(Box{size}, 2.5e-3 - kDepth, expected);
    EXPECT_LT(box.area, kExact);
    EXPECT_GT(box.point, 0.1);
    EXPECT_LT(worstErrors(support::boxMesh(size), 2.5e-3 - kDepth, expected).area, kFloat);
  }
}

TEST(AreaDepth, RaysAgreeWithTrianglesForTiltedBoxes) {
  // The same box by rays and by clipped faces, tilted up to 60 degrees, as deep as 1.5 thicknesses: walls, edges, corners and clamping.
  Random random(11);
  const Sensor sensor = pad(DepthSampling::kArea);
  const reference::SampleGrid grid(sensor.patches.front(), sensor.samples_per_taxel);
  double worst = 0;
  for (int n = 0; n < 10; ++n) {
    const Box box{{random.uniform(0.5e-3, 4e-3), random.uniform(0.5e-3, 4e-3), random.uniform(0.5e-3, 4e-3)}};
    const Object object = box;
    const Quaternion R_SO = random.tilt(kPi / 3);
    const double lowest = rotate(R_SO, lowestPoint(object, R_SO))[2];
    const PlacedObject placed{&object, {{0.4e-3, -0.3e-3, -lowest - random.uniform(0.1, 1.5) * kThickness}, R_SO}};
    const std::vector<double> exact = reference::meanPenetrations(sensor, {&placed, 1});
    EXPECT_GT(*std::max_element(exact.begin(), exact.end()), 0);
    const Pose X_OS = inverse(placed.X_SO);
    const reference::HeightAt heightAt = [&](double x, double y) {
      return reference::firstHit(box, X_OS * Vector3{x, y, 0}, rotate(X_OS.rotation, {0, 0, 1}));
    };
    for (int u = 0; u < grid.rows; ++u) {
      for (int v = 0; v < grid.cols; ++v) {
        const reference::Rectangle cell = grid.cell(u, v);
        const double mean = reference::meanDepth(heightAt, cell, cell, {.thickness = kThickness}, false).mean;
        worst = std::max(worst, std::abs(mean - exact[grid.index(u, v)]));
      }
    }
  }
  EXPECT_LE(worst, reference::kMeanDepthTolerance * kThickness);
}

TEST(AreaDepth, TiltedHalfSpacesAreLinear) {
  const Sensor sensor = pad(DepthSampling::kArea);
  const Object plane = HalfSpace{};
  const PlacedObject placed{&plane, {{0, 0, -0.7e-3}, {std::cos(0.01), std::sin(0.01), 0, 0}}};  // 0.02 rad
  const std::vector<double> mean = reference::meanPenetrations(sensor, {&placed, 1});
  const std::vector<double> heights = reference::surfaceHeights(sensor, {&placed, 1});
  for (std::size_t n = 0; n < mean.size(); ++n) EXPECT_NEAR(mean[n], -heights[n], kExact * kThickness) << n;
  const PlacedObject below{&plane, {{0, 0, 1}, {0, 1, 0, 0}}};  // fills everything below z = 1
  for (const double depth : reference::meanPenetrations(sensor, {&below, 1})) EXPECT_DOUBLE_EQ(depth, kThickness);
}

TEST(AreaDepth, DepthIsClampedToTheThickness) {
  const double deep = 2 * kThickness, radius = 5e-3;
  EXPECT_NEAR(forceOf(Box{{3e-3, 2e-3, 0.01}}, {{0.2e-3, 0.1e-3, 0.005 - deep}, yawed(0.3)}) / (kStiffness * 6e-6 * kThickness), 1, kExact);
  const double expected = kStiffness * (capVolume(radius, deep) - capVolume(radius, deep - kThickness));
  EXPECT_NEAR(forceOf(Sphere{radius}, {{0.2e-3, 0.1e-3, radius - deep}, {1, 0, 0, 0}}) / expected, 1, kSolid);
}

TEST(AreaDepth, FoldsAreAveraged) {
  // Two plates of one mesh, one 0.1 mm deep, the other above it and 0.4 mm higher.
  Mesh plates = support::boxMesh({6e-3, 6e-3, 0.2e-3});
  const std::size_t num_vertices = plates.vertices.size(), num_triangles = plates.triangles.size();
  for (std::size_t n = 0; n < num_vertices; ++n) {
    plates.vertices.push_back(plates.vertices[n]);
    plates.vertices.back()[2] += 0.4e-3f;
  }
  for (std::size_t n = 0; n < num_triangles; ++n) {
    plates.triangles.push_back(plates.triangles[n]);
    for (std::uint32_t& index : plates.triangles.back()) index += static_cast<std::uint32_t>(num_vertices);
  }
  const Object object = plates;
  const PlacedObject placed{&object, {{0, 0, -0.9e-3}, {1, 0, 0, 0}}};  // depths 1.0 and 0.6 mm
  const Sensor sensor = pad(DepthSampling::kArea);
  const std::vector<double> mean = reference::meanPenetrations(sensor, {&placed, 1});
  EXPECT_NEAR(*std::max_element(mean.begin(), mean.end()), 0.8e-3, kFloat * 1e-3);
}

TEST(AreaDepth, OpenMeshesHaveTheDepthAtTheMiddle) {
  Random random(5);
  const Object sheet = support::sheetWithHoles(20, 8e-3, 0.3e-3, 0.1, random);
  const PlacedObject placed{&sheet, {{0.1e-3, 0.2e-3, -0.2e-3}, yawed(0.4)}};
  const Sensor sensor = pad(DepthSampling::kArea);
  EXPECT_EQ(reference::meanPenetrations(sensor, {&placed, 1}),
            reference::penetrations(reference::surfaceHeights(sensor, {&placed, 1}), kThickness));
}

TEST(AreaDepth, SurfacesBelowTheViewDepthDoNotCount) {
  // A plane that falls from z = 0 at the left border of a cell to -w at its right border.
  const double w = kCell, thickness = 0.25 * w, view = 0.75 * w;
  const std::vector<reference::Triangle> plane{{{{0, 0, 0}, {0, w, 0}, {w, w, -w}}}, {{{0, 0, 0}, {w, w, -w}, {w, 0, -w}}}};
  const reference::SampleGrid grid({"cell", 1, 1, {w, w}, {}}, 1, {w / 2, w / 2});
  std::vector<reference::CellSums> sums(1);
  reference::addTriangles(plane, grid, {thickness, view}, sums);
  // A ramp up to the thickness over a quarter of the cell, then the thickness over half of it.
  const double expected = thickness * (0.25 / 2 + 0.5);
  EXPECT_NEAR(sums[0].mean(w * w), expected, kExact * w);
  EXPECT_NEAR(sums[0].covered, 0.75 * w * w, kExact * w * w);
  const auto heightAt = [](double x, double) { return -x; };
  EXPECT_NEAR(reference::meanDepth(heightAt, grid.cell(0, 0), grid.cell(0, 0), {thickness, view}, false).mean, expected, 1e-6 * thickness);
}

TEST(AreaDepth, TheLargestMeanOfSeveralObjectsCounts) {
  const Sensor sensor = pad(DepthSampling::kArea);
  const Object needle = Box{{0.1e-3, 0.1e-3, 0.01}}, plate = Box{{0.8e-3, 0.8e-3, 0.01}};
  const double x = kCell / 2, y = kCell / 2;
  const std::vector<PlacedObject> objects{{&needle, {{x, y, 0.004}, {1, 0, 0, 0}}}, {&plate, {{x, y, 0.0049}, {1, 0, 0, 0}}}};
  const reference::AreaDepths depths = reference::AreaDepth(sensor, objects).at();
  const auto sample = static_cast<std::size_t>(std::max_element(depths.mean.begin(), depths.mean.end()) - depths.mean.begin());
  EXPECT_EQ(depths.touching[sample], 1);
  EXPECT_NEAR(depths.mean[sample], 0.1e-3 * 0.64e-6 / (kCell * kCell), kExact * kThickness);
  EXPECT_NEAR(depths.share[sample], 0.64e-6 / (kCell * kCell), kExact);
  EXPECT_NEAR(reference::coveredDepths(depths)[sample], 0.1e-3, kExact * kThickness);
  EXPECT_EQ(std::count(depths.touching.begin(), depths.touching.end(), -1), static_cast<std::ptrdiff_t>(depths.mean.size()) - 1);
  EXPECT_EQ(reference::overPenetration(sensor, depths), 0);
  const reference::AreaDepths deeper = reference::AreaDepth(sensor, objects).at(-1.4e-3);
  EXPECT_EQ(reference::overPenetration(sensor, deeper) * static_cast<double>(depths.mean.size()), 1);
}

TEST(AreaDepth, ForcesChangeContinuously) {
  constexpr double kStep = 1e-6;  // m
  const double radius = 0.5e-3;
  const Object pin = Cylinder{radius, 0.01};
  // A taxel loses at most the strip that the pin's diameter sweeps in a step; the integrals of both poses have an error.
  const double pin_force = kStiffness * kPi * radius * radius * kDepth;
  const double bound = kStiffness * kDepth * 2 * radius * kStep + 2 * kSolid * pin_force;
  const auto worstChange = [&](DepthSampling sampling) {
    double worst = 0;
    std::vector<double> before;
    for (int n = 0; n <= 60; ++n) {
      const PlacedObject placed{&pin, {{0.3e-3 + n * kStep, 0.07e-3, 0.005 - kDepth}, {1, 0, 0, 0}}};
      const std::vector<double> force = reference::simulateFrame(pad(sampling), {.objects = {placed}}).contact.taxel_force;
      for (std::size_t t = 0; t < before.size(); ++t) worst = std::max(worst, std::abs(force[t] - before[t]));
      before = force;
    }
    return worst;
  };
  EXPECT_LT(worstChange(DepthSampling::kArea), bound);
  EXPECT_GT(worstChange(DepthSampling::kPoint), 100 * bound);
}

TEST(AreaDepth, PinsCarryTheirLoad) {
  const Sensor sensor = pad(DepthSampling::kArea);
  const double radius = 0.3e-3, area = kPi * radius * radius, load = kStiffness * area * kDepth;
  const Object pin = Cylinder{radius, 0.01}, mesh = prismMesh(96, radius, 0.01);
  Random random(3);
  int num_missed_by_points = 0;
  for (int n = 0; n < 10; ++n) {
    const Pose pose{{random.uniform(-2e-3, 2e-3), random.uniform(-2e-3, 2e-3), 0.02}, {1, 0, 0, 0}};
    for (const Object* object : {&pin, &mesh}) {
      const PlacedObject placed{object, pose};
      const reference::LoadResult found = reference::findLoad(sensor, {&placed, 1}, load);
      EXPECT_TRUE(found.reached);
      EXPECT_NEAR(found.first_touch, -0.015, kFloat * 0.01);
      EXPECT_NEAR(found.full_depth, found.first_touch - kThickness, 1.01 * (1 - reference::kFullDepth) * kThickness);
      // The area of 96 sides is 7e-4 smaller than that of the circle.
      EXPECT_NEAR(found.first_touch - found.offset, kDepth, 1e-3 * kDepth);
      EXPECT_NEAR(forceOf(*object, {{pose.position[0], pose.position[1], 0.02 + found.offset}, pose.rotation}) / load, 1, kExact);
      num_missed_by_points += reference::findLoad(pad(DepthSampling::kPoint), {&placed, 1}, load).reached ? 0 : 1;
    }
  }
  EXPECT_GT(num_missed_by_points, 0);
  const PlacedObject placed{&pin, {{0, 0, 0.02}, {1, 0, 0, 0}}};
  const reference::LoadResult too_large = reference::findLoad(sensor, {&placed, 1}, 1.01 * kStiffness * area * kThickness);
  EXPECT_FALSE(too_large.reached);
  EXPECT_EQ(too_large.offset, too_large.full_depth);
}

TEST(AreaDepth, EveryLoadUpToFullDepthIsReached) {
  // Over level patches each mean is continuous in the offset, so that no load is lost in a jump of the force.
  constexpr int kScenes = 5;
  constexpr double kTouch = 1e-9;  // m: error of first touch where a rim leaves the pad
  for (int seed = 0; seed < kScenes; ++seed) {
    SCOPED_TRACE(seed);
    Random random(static_cast<std::uint64_t>(seed));
    Sensor sensor = support::randomSensor(random, {.max_rows = 3, .max_cols = 3});
    sensor.skin.law = Winkler{kStiffness, 1, 0};
    sensor.depth_sampling = DepthSampling::kArea;
    const Object object = random.chance(0.5) ? support::randomSolid(random, 4e-3) : support::randomMeshObject(random, 4e-3);
    const Quaternion R_SO = support::randomRotation(random, object);
    const PlacedObject placed{&object, {{random.uniform(-2e-3, 2e-3), random.uniform(-2e-3, 2e-3), 0.02}, R_SO}};
    const reference::LoadResult deepest = reference::findLoad(sensor, {&placed, 1}, 1e9);
    if (!std::isfinite(deepest.first_touch) || deepest.full_depth == 0) continue;
    const auto forceAt = [&](double offset) {
      const std::vector<PlacedObject> moved = reference::movedAlongZ({&placed, 1}, offset);
      return reference::computeContact(sensor, reference::meanPenetrations(sensor, moved), {}, 0).total_force;
    };
    EXPECT_EQ(forceAt(deepest.first_touch + kTouch), 0);
    EXPECT_GT(forceAt(deepest.first_touch - 0.01 * sensor.skin.thickness), 0);
    for (const double fraction : {1e-3, 0.03, 0.5}) {
      const double load = fraction * forceAt(deepest.full_depth);
      const reference::LoadResult found = reference::findLoad(sensor, {&placed, 1}, load);
      EXPECT_TRUE(found.reached) << object.name << " " << fraction << " " << forceAt(found.offset) / load - 1;
    }
  }
}

TEST(AreaDepth, TheEdgeOfAPadIsTouched) {
  // A pin whose axis lies outside of the pad, 0.1 mm of it over the outermost cells.
  const Sensor sensor = pad(DepthSampling::kArea);
  const Object pin = Cylinder{0.5e-3, 0.01};
  const PlacedObject placed{&pin, {{2 * 3.4e-3 + 0.4e-3, 0, 0.02}, {1, 0, 0, 0}}};
  const double area = segmentArea(0.5e-3, 0.1e-3);
  const reference::LoadResult found = reference::findLoad(sensor, {&placed, 1}, kStiffness * area * kDepth);
  EXPECT_TRUE(found.reached);
  EXPECT_NEAR(found.offset, -0.015 - kDepth, 1e-3 * kDepth);
}

TEST(AreaDepth, FrictionActsThroughTheObjectWithTheLargestMean) {
  // A pin that meets no sample point sticks to the skin and moves by 10 um.
  Sensor sensor = pad(DepthSampling::kArea);
  sensor.skin.friction = {.tangential_stiffness = 5e7, .friction_coefficient = 10};
  const double radius = 0.3e-3, slide = 10e-6;
  const Object pin = Cylinder{radius, 0.01};
  const auto at = [&](double x) { return std::vector<PlacedObject>{{&pin, {{x, 0, 0.005 - kDepth}, {1, 0, 0, 0}}}}; };
  const reference::Frame first = reference::simulateFrame(sensor, {.objects = at(0)});
  const reference::Frame second = reference::simulateFrame(sensor, {.objects = at(slide), .previous_friction = first.shear.state});
  // Four cells meet at the origin; in each the covered share shears.
  EXPECT_NEAR(second.shear.wrench[0] / (5e7 * slide * kPi * radius * radius), 1, 10 * reference::kMeanDepthTolerance);
  EXPECT_EQ(reference::simulateFrame(pad(DepthSampling::kPoint), {.objects = at(0)}).contact.total_force, 0);
}

}  // namespace
}  // namespace taxelsim
