#include "reference/pasternak.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "reference/area_depth.h"
#include "reference/linked_foundation.h"
#include "sensor/pasternak.h"

namespace taxelsim::reference {
namespace {

// Factor c of the link between nodes with overlaps a and b, `spacing` apart.
double linkFactor(double a, double b, double spacing) {
  if (std::max(a, b) <= 0) return 1;
  return 1 + std::clamp(std::abs(a - b) / spacing - 1, 0.0, 1.0);
}

// The equation of a node: diagonal w - sum of link w' = f.
struct NodeEquation {
  double diagonal = 0;                     // N/m
  std::array<std::size_t, 4> neighbour{};  // of the links
  std::array<double, 4> link{};            // N/m; 0 without a neighbour

  double pull(const std::vector<double>& w) const {
    double sum = 0;
    for (std::size_t n = 0; n < 4; ++n) sum += link[n] * w[neighbour[n]];
    return sum;
  }
};

std::vector<NodeEquation> nodeEquations(const Foundation& foundation, std::span<const double> overlap, std::span<const Arms> arms) {
  const LayerNodes& nodes = foundation.nodes;
  const double decay = decayLength(foundation.law);
  std::vector<NodeEquation> equations;
  for (int u = 0; u < nodes.num_rows; ++u) {
    for (int v = 0; v < nodes.num_cols; ++v) {
      const auto at = [&](int row, int col) { return static_cast<std::size_t>(row * nodes.num_cols + col); };
      NodeEquation& equation = equations.emplace_back();
      equation.diagonal = foundation.law.normal_contact_stiffness * nodes.area();
      const auto addLink = [&](std::size_t number, int row, int col, double length, double width) {
        const double plain = foundation.law.shear_stiffness * width / length;
        if (row < 0 || col < 0 || row >= nodes.num_rows || col >= nodes.num_cols) {
          equation.diagonal += plain * (1 - std::exp(-length / decay));
          return;
        }
        const std::size_t here = at(u, v), there = at(row, col);
        const double covered = arms.empty() ? 0 : arms[here][number] + arms[there][number ^ 1u];
        equation.neighbour[number] = there;
        equation.link[number] = plain * (arms.empty() ? linkFactor(overlap[here], overlap[there], length)
                                                      : cutLinkFactor(overlap[here], overlap[there], covered, length));
        equation.diagonal += equation.link[number];
      };
      const auto [along_x, along_y] = nodes.spacing;
      addLink(0, u - 1, v, along_x, along_y);
      addLink(1, u + 1, v, along_x, along_y);
      addLink(2, u, v - 1, along_y, along_x);
      addLink(3, u, v + 1, along_y, along_x);
    }
  }
  return equations;
}

double sumOfPlainLinks(const Foundation& foundation) {
  const auto [x, y] = foundation.nodes.spacing;
  return 2 * foundation.law.shear_stiffness * (y / x + x / y);
}

LayerContact solveContact(const Sensor& sensor, const Foundation& foundation, std::span<const double> heights) {
  LayerContact contact;
  for (const double height : heights) contact.overlap.push_back(std::min(-height, sensor.skin.thickness));
  contact.solution.pressure = solveFoundation(foundation, contact.overlap).pressure;
  sumForces(sensor, foundation.nodes, contact);
  return contact;
}

// The same with cut links, the objects `depth` (m) below their poses.
LayerContact solveCutContact(const Sensor& sensor, const Foundation& foundation, const LayerCells& cells, const FoundationCells& cut,
                             double depth) {
  const double thickness = sensor.skin.thickness;
  LayerContact contact;
  for (const double height : cut.height) contact.overlap.push_back(std::min(depth - height, thickness));
  contact.solution.pressure = solveFoundation(foundation, contact.overlap, armsAtDepth(cut, depth)).pressure;
  sumForces(sensor, foundation.nodes, contact);
  const std::vector<Sample> samples = layerSamples(sensor, foundation.nodes);
  const double per_taxel = sensor.samples_per_taxel * sensor.samples_per_taxel;
  std::fill(contact.mean_penetration.begin(), contact.mean_penetration.end(), 0);
  contact.over_penetration = 0;
  for (std::size_t n = 0; n < samples.size(); ++n) {
    const double mean = cells.covered[n] * std::clamp(depth - cells.height[n], 0.0, thickness);
    contact.mean_penetration[static_cast<std::size_t>(samples[n].taxel)] += mean / per_taxel;
    contact.over_penetration += contact.overlap[n] >= kFullDepth * thickness ? 1 / static_cast<double>(samples.size()) : 0;
  }
  return contact;
}

// The sensor with its nodes as samples.
Sensor refinedGrid(const Sensor& sensor) {
  Sensor result = sensor;
  result.samples_per_taxel *= pasternakRefinement(sensor);
  return result;
}

}  // namespace

Foundation makeFoundation(const Sensor& sensor) {
  return {std::get<Pasternak>(sensor.skin.law), pasternakNodes(sensor)};
}

FoundationSolution solveFoundation(const Foundation& foundation, std::span<const double> overlap, std::span<const Arms> arms) {
  constexpr int kMaxSweeps = 20000;
  constexpr double kTolerance = 1e-13;  // of the deepest overlap, by which no node moves any more
  FoundationSolution solution{std::vector<double>(overlap.size(), 0), std::vector<double>(overlap.size(), 0)};
  const double deepest = *std::max_element(overlap.begin(), overlap.end());
  if (deepest <= 0) return solution;
  std::vector<double>& w = solution.displacement;
  const std::vector<NodeEquation> equations = nodeEquations(foundation, overlap, arms);
  const double largest = sweepRelaxation(foundation.law, foundation.nodes);
  const double whole = foundation.law.normal_contact_stiffness * foundation.nodes.area() + sumOfPlainLinks(foundation);
  double change = std::numeric_limits<double>::infinity();
  for (int sweep = 0; change > kTolerance * deepest; ++sweep) {
    if (sweep == kMaxSweeps) throw std::runtime_error("two-parameter foundation: no convergence");
    change = 0;
    for (std::size_t n = 0; n < w.size(); ++n) {
      // Less where a cut link holds a free node to one under the object, which it would lift by moving too far.
      const double relaxation = 1 + (largest - 1) * std::min(whole / equations[n].diagonal, 1.0);
      const double free = w[n] + relaxation * (equations[n].pull(w) / equations[n].diagonal - w[n]);
      const double next = std::max({free, overlap[n], 0.0});
      change = std::max(change, std::abs(next - w[n]));
      w[n] = next;
    }
  }
  for (std::size_t n = 0; n < w.size(); ++n) {
    const double force = equations[n].diagonal * w[n] - equations[n].pull(w);
    if (w[n] <= overlap[n]) solution.pressure[n] = std::max(force, 0.0) / foundation.nodes.area();
  }
  return solution;
}

LayerContact foundationContact(const Sensor& sensor, std::span<const PlacedObject> objects) {
  if (sensor.patches.size() > 1) return linkedContact(sensor, objects);
  const Foundation foundation = makeFoundation(sensor);
  const Sensor nodes = refinedGrid(sensor);
  const std::vector<double> heights = layerHeights(nodes, foundation.nodes, objects);
  const LayerCells cells = layerCells(nodes, foundation.nodes, objects);
  const std::vector<std::array<double, 2>> sizes(heights.size(), foundation.nodes.spacing);
  return cells.covered.empty() ? solveContact(nodes, foundation, heights)
                               : solveCutContact(nodes, foundation, cells, foundationCells(cells, sizes, heights), 0);
}

LayerContact loadedFoundationContact(const Sensor& sensor, std::span<const PlacedObject> objects, double load) {
  if (sensor.patches.size() > 1) return loadedLinkedContact(sensor, objects, load);
  const Foundation foundation = makeFoundation(sensor);
  const Sensor nodes = refinedGrid(sensor);
  const std::vector<double> heights = layerHeights(nodes, foundation.nodes, objects);
  const double lowest = *std::min_element(heights.begin(), heights.end()), thickness = sensor.skin.thickness;
  if (sensor.depth_sampling != DepthSampling::kArea || !std::isfinite(lowest) || load <= 0) {
    return searchDepth(heights, 0, thickness, load, [&](std::span<const double> moved) { return solveContact(nodes, foundation, moved); });
  }
  // The cells change with the depth, so that each depth is a frame.
  const auto at = [&](double offset) {
    std::vector<PlacedObject> moved(objects.begin(), objects.end());
    for (PlacedObject& object : moved) object.X_SO.position[2] += offset;
    LayerContact contact = foundationContact(sensor, moved);
    contact.offset = offset;
    return contact;
  };
  double deep = -lowest - thickness, shallow = thickness - lowest;  // m; a node is at its full depth; nothing touches
  LayerContact contact = at(deep);
  contact.load_reached = contact.total_force >= load;
  constexpr int kHalvings = 30;  // to 4e-12 m of 2 thicknesses
  for (int halving = 0; contact.load_reached && halving < kHalvings; ++halving) {
    contact = at((deep + shallow) / 2);
    (contact.total_force > load ? deep : shallow) = contact.offset;
  }
  return contact;
}

}  // namespace taxelsim::reference
