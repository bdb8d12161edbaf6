// Links of a two-parameter foundation on several patches: those of the grid where patches continue each other, by distance across gaps.
#include "sensor/foundation_links.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "sensor/pasternak.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kStiffness = 5e8, kShear = 217.8;  // N/m^3, N/m: a decay length of 0.66 mm
constexpr double kRounding = 1e-9;                  // relative, of places in space

Sensor sensorOf(std::vector<GridPatch> patches, int samples_per_taxel = 2) {
  Sensor sensor;
  sensor.patches = std::move(patches);
  sensor.samples_per_taxel = samples_per_taxel;
  sensor.skin = {.thickness = 2e-3, .law = Pasternak{kStiffness, kShear, 0}};
  return sensor;
}

// A ring of taxels on a cylinder along y.
Sensor ring(int num_around, int num_along) {
  constexpr double kRadius = 6e-3, kPitch = 1.5e-3;
  std::vector<GridPatch> patches;
  for (int i = 0; i < num_around; ++i) {
    const double angle = 2 * kPi * i / num_around;
    for (int j = 0; j < num_along; ++j) {
      const Vector3 normal{std::sin(angle), 0, std::cos(angle)};
      patches.push_back(taxelPatch("t", {kRadius * normal[0], kPitch * j, kRadius * normal[2]}, normal,
                                   {2 * kPi * kRadius / num_around, kPitch}, Vector3{normal[2], 0, -normal[0]}));
    }
  }
  return sensorOf(std::move(patches));
}

GridPatch taxelAt(double x, double y, const Vector3& normal = {0, 0, 1}) {
  return taxelPatch("t", {x, y, 0}, normal, {2e-3, 3e-3});
}

TEST(FoundationLinks, ListHasTheLinksOfItsGrid) {
  const Sensor grid = sensorOf({{.name = "", .num_rows = 3, .num_cols = 4, .pitch = {2e-3, 3e-3}, .X_SP = {}}});
  std::vector<GridPatch> taxels;
  for (const Vector3& p : taxelPositions(grid)) taxels.push_back(taxelAt(p[0], p[1]));
  const LinkedNodes of_grid = linkedNodes(grid), of_list = linkedNodes(sensorOf(std::move(taxels)));
  ASSERT_EQ(of_list.per_side, of_grid.per_side);
  for (std::size_t n = 0; n < of_grid.links.size(); ++n) {
    ASSERT_EQ(of_list.links[n].size(), of_grid.links[n].size()) << n;
    EXPECT_NEAR(of_list.spring[n], of_grid.spring[n], kRounding * of_grid.spring[n]) << n;
    for (std::size_t k = 0; k < of_grid.links[n].size(); ++k) {
      EXPECT_EQ(of_list.links[n][k].node, of_grid.links[n][k].node);
      EXPECT_NEAR(of_list.links[n][k].stiffness, of_grid.links[n][k].stiffness, kRounding * kShear);
      EXPECT_NEAR(of_list.links[n][k].length, of_grid.links[n][k].length, kRounding);
      EXPECT_EQ(of_list.links[n][k].side, of_grid.links[n][k].side);
      EXPECT_EQ(of_list.links[n][k].other_side, of_grid.links[n][k].other_side);
    }
  }
}

// Around a ring the links are those of the cylinder laid out flat; the skin ends at the two ends of the cylinder only.
TEST(FoundationLinks, RingHasNoEndAround) {
  constexpr int kAround = 16, kAlong = 3;
  const Sensor sensor = ring(kAround, kAlong);
  const LinkedNodes nodes = linkedNodes(sensor);
  const int per_side = nodes.per_side, per_taxel = per_side * per_side;
  const double x = sensor.patches[0].pitch[0] / per_side, y = sensor.patches[0].pitch[1] / per_side;
  const double open = kShear * x / y * (1 - std::exp(-y / decayLength(std::get<Pasternak>(sensor.skin.law))));
  for (int n = 0; n < kAround * kAlong * per_taxel; ++n) {
    const int taxel = n / per_taxel % kAlong, b = n % per_side;
    const bool is_at_end = (taxel == 0 && b == 0) || (taxel == kAlong - 1 && b == per_side - 1);
    EXPECT_NEAR(nodes.spring[static_cast<std::size_t>(n)], kStiffness * x * y + (is_at_end ? open : 0), kRounding * kShear) << n;
    double sum = 0;
    for (const FoundationLink& link : nodes.links[static_cast<std::size_t>(n)]) sum += link.stiffness;
    EXPECT_EQ(nodes.links[static_cast<std::size_t>(n)].size(), is_at_end ? 3u : 4u) << n;
    EXPECT_NEAR(sum, 2 * kShear * (y / x + x / y) - (is_at_end ? kShear * x / y : 0), kRounding * sum) << n;
  }
}

// Stiffness over a gap is inverse to the distance; beyond a decay length, and to a taxel that looks the other way, there is none.
TEST(FoundationLinks, GapsAndOppositeFaces) {
  const auto sumOfLinks = [](const Sensor& sensor) {
    const LinkedNodes nodes = linkedNodes(sensor);
    const std::size_t half = nodes.links.size() / 2;
    double sum = 0;
    for (std::size_t n = 0; n < half; ++n) {
      for (const FoundationLink& link : nodes.links[n]) sum += static_cast<std::size_t>(link.node) >= half ? link.stiffness : 0;
    }
    return sum;
  };
  const double spacing = 2e-3 / linkedNodes(sensorOf({taxelAt(0, 0)})).per_side;
  for (const double gap : {0.0, 0.1e-3, 0.5e-3}) {
    EXPECT_NEAR(sumOfLinks(sensorOf({taxelAt(0, 0), taxelAt(2e-3 + gap, 0)})), kShear * 3e-3 / (spacing + gap), kRounding * kShear) << gap;
  }
  EXPECT_EQ(sumOfLinks(sensorOf({taxelAt(0, 0), taxelAt(2.7e-3, 0)})), 0);
  EXPECT_EQ(sumOfLinks(sensorOf({taxelAt(0, 0), taxelAt(2e-3, 0, {0, 0, -1})})), 0);
  // Moved along the seam by a third of a node: each side is divided between two nodes at the same distance across it.
  EXPECT_NEAR(sumOfLinks(sensorOf({taxelAt(0, 0), taxelAt(2e-3, spacing / 3)})), kShear * 3e-3 / spacing, 0.1 * kShear);
}

std::string refusalOf(const Sensor& sensor) {
  try {
    checkSensor(sensor);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(FoundationLinks, WhatSeveralPatchesAllow) {
  Sensor sensor = sensorOf({taxelAt(0, 0), taxelAt(2e-3, 0)});
  sensor.psf = {.sigma = 1e-3};
  EXPECT_EQ(refusalOf(sensor), "");
  sensor.depth_sampling = DepthSampling::kArea;
  EXPECT_EQ(refusalOf(sensor), "");
  sensor.patches.assign(kMaxLinkedTaxels + 1, sensor.patches[0]);
  EXPECT_EQ(refusalOf(sensor), "patches: 1025 taxels is not allowed: at most 1024 with the law pasternak on several patches");
}

TEST(FoundationLinks, BothNodesOfALinkHaveIt) {
  const LinkedNodes nodes =
      linkedNodes(sensorOf({taxelAt(0, 0), taxelAt(2.1e-3, 0.37e-3, {0.1, 0, 1}), taxelAt(0.4e-3, 3e-3, {0, 0.2, 1})}));
  for (std::size_t n = 0; n < nodes.links.size(); ++n) {
    for (const FoundationLink& link : nodes.links[n]) {
      bool is_found = false;
      for (const FoundationLink& back : nodes.links[static_cast<std::size_t>(link.node)]) {
        is_found = is_found || (back.node == static_cast<int>(n) && back.stiffness == link.stiffness && back.length == link.length &&
                                back.side == link.other_side && back.other_side == link.side);
      }
      EXPECT_TRUE(is_found) << n;
      EXPECT_GT(link.stiffness, 0);
    }
  }
}

// The line to another node leaves a cell through the side in its way, of a wide cell rather through the long one.
TEST(FoundationLinks, SideTowardsANode) {
  EXPECT_EQ(sideTowards({-1, 0.2}, {1, 1}), 0);
  EXPECT_EQ(sideTowards({1, 0.9}, {1, 1}), 1);
  EXPECT_EQ(sideTowards({0.9, -1}, {1, 1}), 2);
  EXPECT_EQ(sideTowards({1, 0.9}, {2, 1}), 3);
  EXPECT_EQ(sideTowards({1, 1 + 1e-12}, {1, 1}), 1);
  // Taxels that are turned against each other by a quarter: the link leaves one along x and enters the other along y.
  const GridPatch square = taxelPatch("t", {0, 0, 0}, {0, 0, 1}, {2e-3, 2e-3});
  GridPatch turned = square;
  turned.X_SP = {{2e-3, 0, 0}, axisAngle({0, 0, 1}, kPi / 2)};
  const LinkedNodes nodes = linkedNodes(sensorOf({square, turned}));
  const std::size_t half = nodes.links.size() / 2;
  int num_over_seam = 0;
  for (std::size_t n = 0; n < half; ++n) {
    for (const FoundationLink& link : nodes.links[n]) {
      if (static_cast<std::size_t>(link.node) < half) continue;
      ++num_over_seam;
      EXPECT_EQ(link.side, 1) << n;
      EXPECT_EQ(link.other_side, 3) << n;  // y of the turned taxel looks along -x
    }
  }
  EXPECT_EQ(num_over_seam, nodes.per_side);
}

TEST(FoundationLinks, BlocksWithinReach) {
  const Sensor sensor = sensorOf({taxelAt(0, 0), taxelAt(2e-3, 0), taxelAt(4e-3, 0), taxelAt(2e-3, 0, {0, 0, -1})});
  EXPECT_EQ(blocksWithin(sensor, 1, 1.3e-3), (std::vector<std::vector<int>>{{0, 1}, {0, 1, 2}, {1, 2}, {3}}));
  EXPECT_EQ(blocksWithin(sensor, 1, 2.2e-3)[0], (std::vector<int>{0, 1, 2}));
  // Halves of 1 by 1.5 mm: the second along x and the first along y, next to the second taxel.
  EXPECT_EQ(blocksWithin(sensor, 2, 0.3e-3)[2], (std::vector<int>{0, 1, 2, 3, 4, 5}));
}

}  // namespace
}  // namespace taxelsim
