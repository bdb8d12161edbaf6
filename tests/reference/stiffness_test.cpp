// Predictions of taxelsim/stiffness.h against frames of the reference.
#include "taxelsim/stiffness.h"

#include "reference/elastic_layer.h"
#include "support/test.h"
#include "taxelsim/object.h"

namespace taxelsim {
namespace {

constexpr double kThickness = 0.002;  // m
constexpr double kDepth = 1e-5;       // m
constexpr double kPinLength = 0.01;   // m

// 4 x 4 taxels of 4 mm, samples 0.5 mm apart.
Sensor sensorWith(const Skin& skin) {
  Sensor sensor;
  sensor.patches = {GridPatch{.name = "pad", .num_rows = 4, .num_cols = 4, .pitch = {0.004, 0.004}, .X_SP = {}}};
  sensor.samples_per_taxel = 8;
  sensor.skin = skin;
  return sensor;
}

Skin layerOf(double poisson_ratio) {
  return skinsOf(skinStiffness({.thickness = kThickness, .poisson_ratio = poisson_ratio, .stiffness = KnownModulus{1e6}}))[4];
}

// Samples see a staircase instead of the rim, here 8 and 12 per radius.
TEST(StiffnessPrediction, PinOnASimulatedLayer) {
  constexpr double kRimError = 0.05;
  for (const double nu : {0.3, 0.49}) {
    const Sensor sensor = sensorWith(layerOf(nu));
    for (const double diameter : {0.008, 0.012}) {
      const Object pin(Cylinder{diameter / 2, kPinLength});
      const reference::LayerContact contact =
          reference::layerContact(sensor, std::vector<reference::PlacedObject>{{&pin, {{0, 0, kPinLength / 2 - kDepth}, {1, 0, 0, 0}}}});
      const double force = contact.total_force + contact.off_array_load;
      EXPECT_NEAR(force / pinForce(sensor.skin, diameter, kDepth), 1, kRimError) << nu << " " << diameter;
    }
  }
}

// Force of a flat stamp that covers the nodes where inside(x, y), relative to the area of these nodes.
template <typename Inside>
std::pair<double, double> forceAndArea(const reference::Layer& layer, Inside inside) {
  std::vector<double> overlap;
  double area = 0;
  for (int u = 0; u < layer.nodes.num_rows; ++u) {
    for (int v = 0; v < layer.nodes.num_cols; ++v) {
      const bool covered = inside((u - (layer.nodes.num_rows - 1) / 2.0) * layer.nodes.spacing[0],
                                  (v - (layer.nodes.num_cols - 1) / 2.0) * layer.nodes.spacing[1]);
      overlap.push_back(covered ? kDepth : -std::numeric_limits<double>::infinity());
      area += covered ? layer.nodes.area() : 0;
    }
  }
  return {totalForce(layer, solveLayer(layer, overlap).pressure), area};
}

// docs/how_to/stiffness.md: a hexagon of 124 mm^2 sinks as the disc of the same area, within 2 %.
TEST(StiffnessPrediction, HexagonIsNearlyTheDiscOfTheSameArea) {
  for (const double nu : {0.0, 0.3, 0.49, 0.4999}) {
    const reference::Layer layer = reference::makeLayer(sensorWith(layerOf(nu)));
    const double apothem = std::sqrt(124e-6 / (2 * std::sqrt(3.0)));
    const auto [force, area] = forceAndArea(
        layer, [&](double x, double y) { return std::abs(x) <= apothem && std::abs(x) / 2 + std::abs(y) * std::sqrt(3.0) / 2 <= apothem; });
    const double radius = std::sqrt(124e-6 / std::numbers::pi);
    const auto [disc_force, disc_area] = forceAndArea(layer, [&](double x, double y) { return std::hypot(x, y) <= radius; });
    EXPECT_NEAR(area / disc_area, 1, 0.01);
    EXPECT_NEAR(force / disc_force, 1, 0.02) << nu;
  }
}

}  // namespace
}  // namespace taxelsim
