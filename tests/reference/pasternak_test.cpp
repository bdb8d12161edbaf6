// The two-parameter foundation of the reference against closed forms: flat punches, spheres and cylinders on springs that a shear layer
// joins (A. D. Kerr, "Elastic and viscoelastic foundation models", Journal of Applied Mechanics 31 (1964) 491).
#include "reference/pasternak.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "sensor/pasternak.h"
#include "support/random_scene.h"
#include "taxelsim/stiffness.h"

namespace taxelsim {
namespace {

using reference::Foundation;
using reference::FoundationSolution;
using support::Random;

constexpr double kPi = std::numbers::pi;
constexpr double kNoSurface = -std::numeric_limits<double>::infinity();
constexpr double kStiffness = 5e8;  // N/m^3
constexpr double kDecay = 0.66e-3;  // m
constexpr Pasternak kLaw{.normal_contact_stiffness = kStiffness, .shear_stiffness = kStiffness * kDecay * kDecay};

// Overlap (m) at (x, y) from the middle of the object.
using Overlap = std::function<double(double, double)>;

struct Indenter {
  const char* name;
  double contact_radius;  // m
  double force;           // N
  Overlap overlap;
};

void PrintTo(const Indenter& indenter, std::ostream* out) {
  *out << indenter.name;
}

Indenter pin(const char* name, double radius) {
  constexpr double kDepth = 1e-3;  // m
  return {name, radius, kDepth * pasternakPunchStiffness(kLaw, radius),
          [=](double x, double y) { return std::hypot(x, y) < radius ? kDepth : kNoSurface; }};
}

// A paraboloid with the curvature of a sphere.
Indenter sphere(const char* name, double contact_radius) {
  constexpr double kRadius = 5e-3;  // m
  const double a = contact_radius;
  const double depth = a * a / (2 * kRadius) + a * kDecay / kRadius / besselRatio(a / kDecay);
  const double springs = depth * a * a - a * a * a * a / (4 * kRadius);
  return {name, a, kPi * kStiffness * springs + 2 * kPi * kLaw.shear_stiffness * a * a / kRadius,
          [=](double x, double y) { return depth - (x * x + y * y) / (2 * kRadius); }};
}

// A square of nodes with a decay length around the object, which lies at (x, y) from the middle.
FoundationSolution pressed(const Indenter& indenter, double spacing, double x, double y, LayerNodes& nodes) {
  const int num = 2 * static_cast<int>(std::ceil((1.3 * indenter.contact_radius + 3 * kDecay) / spacing)) + 1;
  nodes = {.num_rows = num, .num_cols = num, .spacing = {spacing, spacing}};
  std::vector<double> overlap;
  for (int u = 0; u < num; ++u) {
    for (int v = 0; v < num; ++v) overlap.push_back(indenter.overlap((u - num / 2) * spacing - x, (v - num / 2) * spacing - y));
  }
  return reference::solveFoundation({kLaw, nodes}, overlap);
}

double forceOf(const FoundationSolution& solution, const LayerNodes& nodes) {
  double sum = 0;
  for (const double pressure : solution.pressure) sum += pressure * nodes.area();
  return sum;
}

struct Accuracy {
  Indenter indenter;
  double places_error;  // largest relative error of 50 places at the spacing of the default sensor's nodes
  double fine_error;    // the same on nodes four times as fine
};

void PrintTo(const Accuracy& accuracy, std::ostream* out) {
  PrintTo(accuracy.indenter, out);
}

class FoundationForms : public ::testing::TestWithParam<Accuracy> {};

// Nodes of the default sensor: taxels of 3.4 mm with 4 x 4 samples, refined by 4.
TEST_P(FoundationForms, ForceAtAnyPlace) {
  constexpr double kSpacing = 3.4e-3 / 16;
  const int places = GetParam().indenter.contact_radius > 3e-3 ? 10 : 50;
  Random random(1);
  double worst = 0;
  for (int n = 0; n < places; ++n) {
    LayerNodes nodes;
    const FoundationSolution solution =
        pressed(GetParam().indenter, kSpacing, random.uniform(-0.5, 0.5) * kSpacing, random.uniform(-0.5, 0.5) * kSpacing, nodes);
    worst = std::max(worst, std::abs(forceOf(solution, nodes) / GetParam().indenter.force - 1));
  }
  RecordProperty("worst", std::to_string(worst));
  EXPECT_LT(worst, GetParam().places_error);
}

TEST_P(FoundationForms, FineNodesApproachTheForce) {
  constexpr double kSpacing = 3.4e-3 / 64;
  LayerNodes nodes;
  const FoundationSolution solution = pressed(GetParam().indenter, kSpacing, 0.3 * kSpacing, 0.1 * kSpacing, nodes);
  EXPECT_NEAR(forceOf(solution, nodes) / GetParam().indenter.force, 1, GetParam().fine_error);
}

// Staircase outlines: the area of a disc of r spacings, counted in nodes, errs by about r^(-3/2).
INSTANTIATE_TEST_SUITE_P(Forms, FoundationForms,
                         ::testing::Values(Accuracy{pin("pin_half_mm", 0.5e-3), 0.10, 0.02}, Accuracy{pin("pin_1_mm", 1e-3), 0.05, 0.01},
                                           Accuracy{pin("pin_2_mm", 2e-3), 0.03, 0.005},
                                           Accuracy{sphere("sphere_half_mm", 0.5e-3), 0.03, 2e-3},
                                           Accuracy{sphere("sphere_1_mm", 1e-3), 0.03, 1e-3},
                                           Accuracy{sphere("sphere_2_mm", 2e-3), 0.03, 1e-3}));

// A list of taxels on a plane, which another solver takes, and its grid.
TEST(LinkedFoundation, ListHasTheForceOfItsGrid) {
  constexpr double kSame = 1e-7;  // relative
  Sensor grid = support::gridSensor({.num_rows = 3, .num_cols = 3, .pitch_x = 2e-3, .pitch_y = 3e-3, .thickness = 2e-3});
  grid.skin.law = kLaw;
  Sensor list = grid;
  list.patches.clear();
  for (const Vector3& p : taxelPositions(grid)) list.patches.push_back(taxelPatch("t", p, {0, 0, 1}, grid.patches[0].pitch));
  const Object ball(Sphere{6e-3}), flat(Box{{1e-3, 8e-3, 0.01}});
  for (const double x : {0.0, 0.4e-3, 2.9e-3}) {
    const std::vector<reference::PlacedObject> pressed{{&ball, {{x, 2e-4, 5.5e-3}, {1, 0, 0, 0}}}};
    const std::vector<reference::PlacedObject> stamped{{&flat, {{x, 2e-4, 4.5e-3}, {1, 0, 0, 0}}}};
    for (const auto& objects : {pressed, stamped}) {
      const double force = reference::foundationContact(grid, objects).total_force;
      EXPECT_NEAR(reference::foundationContact(list, objects).total_force / force, 1, kSame) << x;
    }
  }
}

// Cells that outlines cut, nodes of 0.283 mm: a pin 1 mm deep and a sphere of 5 mm with a contact radius of 1 mm.
TEST(FoundationCells, ForceAtAnyPlace) {
  constexpr double kPinError = 0.015, kSphereError = 0.01;
  Sensor sensor = support::gridSensor({.num_rows = 3, .num_cols = 3, .thickness = 2e-3});
  sensor.skin.law = kLaw;
  sensor.depth_sampling = DepthSampling::kArea;
  constexpr double kRadius = 5e-3, kContact = 1e-3;  // m
  const double edge = std::sqrt(kRadius * kRadius - kContact * kContact), slope = kContact / edge;
  const double depth = kRadius - edge + slope * kDecay / besselRatio(kContact / kDecay);
  const double volume = kPi * kContact * kContact * (depth - kRadius) + 2 * kPi / 3 * (std::pow(kRadius, 3) - std::pow(edge, 3));
  const double sphere_force = kStiffness * volume + 2 * kPi * kLaw.shear_stiffness * kContact * slope;
  const double pin_force = 1e-3 * pasternakPunchStiffness(kLaw, 1e-3);
  const Object flat(Cylinder{1e-3, 0.01}), ball(Sphere{kRadius});
  Random random(2);
  for (int n = 0; n < 10; ++n) {
    const double x = random.uniform(-1e-3, 1e-3), y = random.uniform(-1e-3, 1e-3);
    const std::vector<reference::PlacedObject> pressed_flat{{&flat, {{x, y, 4e-3}, {1, 0, 0, 0}}}};
    const std::vector<reference::PlacedObject> pressed_ball{{&ball, {{x, y, kRadius - depth}, {1, 0, 0, 0}}}};
    EXPECT_NEAR(reference::foundationContact(sensor, pressed_flat).total_force / pin_force, 1, kPinError);
    EXPECT_NEAR(reference::foundationContact(sensor, pressed_ball).total_force / sphere_force, 1, kSphereError);
  }
}

}  // namespace
}  // namespace taxelsim
