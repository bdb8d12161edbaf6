#include "reference/pasternak.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

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

std::vector<NodeEquation> nodeEquations(const Foundation& foundation, std::span<const double> overlap) {
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
        equation.neighbour[number] = at(row, col);
        equation.link[number] = plain * linkFactor(overlap[at(u, v)], overlap[at(row, col)], length);
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

LayerContact solveContact(const Sensor& sensor, const Foundation& foundation, std::span<const double> heights) {
  LayerContact contact;
  for (const double height : heights) contact.overlap.push_back(std::min(-height, sensor.skin.thickness));
  contact.solution.pressure = solveFoundation(foundation, contact.overlap).pressure;
  sumForces(sensor, foundation.nodes, contact);
  return contact;
}

// The sensor with its nodes as samples.
Sensor refined(const Sensor& sensor) {
  Sensor result = sensor;
  result.samples_per_taxel *= pasternakRefinement(sensor);
  return result;
}

}  // namespace

Foundation makeFoundation(const Sensor& sensor) {
  return {std::get<Pasternak>(sensor.skin.law), pasternakNodes(sensor)};
}

FoundationSolution solveFoundation(const Foundation& foundation, std::span<const double> overlap) {
  constexpr int kMaxSweeps = 20000;
  constexpr double kTolerance = 1e-13;  // of the deepest overlap, by which no node moves any more
  FoundationSolution solution{std::vector<double>(overlap.size(), 0), std::vector<double>(overlap.size(), 0)};
  const double deepest = *std::max_element(overlap.begin(), overlap.end());
  if (deepest <= 0) return solution;
  std::vector<double>& w = solution.displacement;
  const std::vector<NodeEquation> equations = nodeEquations(foundation, overlap);
  const double relaxation = sweepRelaxation(foundation.law, foundation.nodes);
  double change = std::numeric_limits<double>::infinity();
  for (int sweep = 0; change > kTolerance * deepest; ++sweep) {
    if (sweep == kMaxSweeps) throw std::runtime_error("two-parameter foundation: no convergence");
    change = 0;
    for (std::size_t n = 0; n < w.size(); ++n) {
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
  const Foundation foundation = makeFoundation(sensor);
  const Sensor nodes = refined(sensor);
  return solveContact(nodes, foundation, layerHeights(nodes, foundation.nodes, objects));
}

LayerContact loadedFoundationContact(const Sensor& sensor, std::span<const PlacedObject> objects, double load) {
  const Foundation foundation = makeFoundation(sensor);
  const Sensor nodes = refined(sensor);
  const std::vector<double> heights = layerHeights(nodes, foundation.nodes, objects);
  return searchDepth(heights, 0, sensor.skin.thickness, load,
                     [&](std::span<const double> moved) { return solveContact(nodes, foundation, moved); });
}

}  // namespace taxelsim::reference
