#include "reference/elastic_layer.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "base/vector3.h"

namespace taxelsim::reference {
namespace {

// Restriction of the layer to a subset of its nodes, with a target displacement d (m) at each.
struct NodeSubset {
  const Layer& layer;
  std::vector<std::array<int, 2>> node;  // (row, column)
  std::vector<double> d;
  std::vector<double> compliance{};  // on the diagonal of A besides influence, m/Pa; empty: none

  // A x, restricted to the subset.
  std::vector<double> displacements(const std::vector<double>& x) const {
    const auto cols = static_cast<std::size_t>(layer.nodes.num_cols);
    std::vector<double> w(node.size(), 0);
    for (std::size_t n = 0; n < node.size(); ++n) {
      if (x[n] == 0) continue;
      const auto [row, col] = node[n];
      for (std::size_t m = 0; m < node.size(); ++m) {
        const auto u = static_cast<std::size_t>(std::abs(node[m][0] - row)), v = static_cast<std::size_t>(std::abs(node[m][1] - col));
        w[m] += layer.influence[u * cols + v] * x[n];
      }
      if (!compliance.empty()) w[n] += compliance[n] * x[n];
    }
    return w;
  }
};

// LayerSolution::residual for p with r = A p - d.
double relativeResidual(const std::vector<double>& p, const std::vector<double>& r, double deepest) {
  double worst = 0;
  for (std::size_t n = 0; n < p.size(); ++n) worst = std::max(worst, p[n] > 0 ? std::abs(r[n]) : -r[n]);
  return p.empty() ? 0 : worst / deepest;
}

struct NonNegativeSolution {
  std::vector<double> p;
  double residual;
  int iterations;
};

// Non-negative conjugate gradients; see the header. `deepest` (m): scale of the residual.
NonNegativeSolution solveNonNegative(const NodeSubset& problem, double deepest, double tolerance) {
  constexpr int kMaxIterations = 20000;
  const std::size_t size = problem.node.size();
  std::vector<double> p(size, 0), t(size, 0);
  double previous = 0;  // |r|^2 on the active set in the preceding iteration; 0 restarts the search directions
  for (int iteration = 0;; ++iteration) {
    std::vector<double> r = problem.displacements(p);
    for (std::size_t n = 0; n < size; ++n) r[n] -= problem.d[n];
    const double residual = relativeResidual(p, r, deepest);
    if (residual <= tolerance || iteration == kMaxIterations) return {p, residual, iteration};
    double squares = 0;
    for (std::size_t n = 0; n < size; ++n) squares += p[n] > 0 ? r[n] * r[n] : 0;
    for (std::size_t n = 0; n < size; ++n) t[n] = p[n] > 0 ? r[n] + (previous > 0 ? squares / previous * t[n] : 0) : 0;
    previous = squares;
    const std::vector<double> q = problem.displacements(t);
    double slope = 0, curvature = 0;
    for (std::size_t n = 0; n < size; ++n) {
      slope += r[n] * t[n];
      curvature += q[n] * t[n];
    }
    // The active set is empty in the first iteration: step by the compliance of a single node.
    const double step = curvature > 0 ? slope / curvature : 1 / problem.layer.influence.front();
    for (std::size_t n = 0; n < size; ++n) {
      p[n] = std::max(0.0, p[n] - step * t[n]);
      if (p[n] == 0 && r[n] < 0) {
        p[n] = -step * r[n];
        previous = 0;
      }
    }
  }
}

// Taxel of node (u, v); kNoTaxel in the margin.
int taxelAt(const Sensor& sensor, const LayerNodes& nodes, int u, int v) {
  const GridPatch& patch = sensor.patches.front();
  const int s = sensor.samples_per_taxel, a = u - nodes.margin_rows, b = v - nodes.margin_cols;
  if (a < 0 || b < 0 || a >= patch.num_rows * s || b >= patch.num_cols * s) return kNoTaxel;
  return a / s * patch.num_cols + b / s;
}

// Residual deformation of a relaxing skin at the end of a step without contact.
struct ResidualDent {
  double gain = 1;                 // SkinStep::gain
  std::vector<double> strain;      // (nodes), Pa: recovered strain
  std::vector<double> depth;       // (nodes), m: displacement A strain, of whole cells
  std::vector<double> compliance;  // (nodes), m/Pa: SkinStep::compliance; empty without strain
};

// Compliance of a dent at node n to what is covered now.
double dentCompliance(const ResidualDent& dent, const LayerCells& cells, std::size_t n) {
  if (dent.compliance.empty()) return 0;
  return std::clamp(dent.compliance[n], std::min(cells.compliance[n], 0.0), std::max(cells.compliance[n], 0.0));
}

ResidualDent residualDent(const Layer& layer, const SkinStep& skin) {
  const auto size = static_cast<std::size_t>(layer.nodes.num_rows * layer.nodes.num_cols);
  ResidualDent dent{skin.gain, {}, std::vector<double>(size, 0), skin.compliance};
  NodeSubset all_nodes{layer, {}, {}};
  for (std::size_t n = 0; n < size; ++n) {
    dent.strain.push_back(skin.recoveredStrain(n));
    all_nodes.node.push_back({static_cast<int>(n) / layer.nodes.num_cols, static_cast<int>(n) % layer.nodes.num_cols});
  }
  if (!skin.strain.empty()) dent.depth = all_nodes.displacements(dent.strain);
  return dent;
}

LayerContact solveContact(const Sensor& sensor, const Layer& layer, std::span<const double> heights, const ResidualDent& dent,
                          const LayerCells& cells) {
  const LayerNodes& nodes = layer.nodes;
  const double thickness = sensor.skin.thickness;
  LayerContact contact;
  contact.gain = dent.gain;
  std::vector<double> elastic_overlap;  // m: overlap with the dented surface
  for (std::size_t n = 0; n < heights.size(); ++n) {
    contact.overlap.push_back(std::min(-heights[n], thickness));
    elastic_overlap.push_back(contact.overlap[n] - dent.depth[n] - dentCompliance(dent, cells, n) * dent.strain[n]);
  }
  contact.cells = cells;
  contact.solution = solveLayer(layer, elastic_overlap, 1e-10, cells.compliance);
  for (std::size_t n = 0; n < heights.size(); ++n) {
    double& pressure = contact.solution.pressure[n];
    contact.strain.push_back(dent.strain[n] + pressure);
    if (!cells.compliance.empty()) {
      const double then = dent.compliance.empty() ? 0 : dent.compliance[n], now = cells.compliance[n];
      contact.dent_compliance.push_back(pressure > 0 ? (dent.strain[n] * then + pressure * now) / contact.strain[n] : then);
    }
    pressure *= dent.gain;
  }
  sumForces(sensor, nodes, contact);
  return contact;
}

}  // namespace

void sumForces(const Sensor& sensor, const LayerNodes& nodes, LayerContact& contact) {
  const double thickness = sensor.skin.thickness;
  contact.taxel_force.assign(static_cast<std::size_t>(numTaxels(sensor)), 0);
  contact.mean_penetration = contact.taxel_force;
  const double per_taxel = sensor.samples_per_taxel * sensor.samples_per_taxel;
  const Pose& X_SP = sensor.patches.front().X_SP;
  Vector3 force{0, 0, 0}, torque{0, 0, 0};
  const std::vector<Sample> samples = layerSamples(sensor, nodes);
  for (std::size_t n = 0; n < samples.size(); ++n) {
    const double node_force = contact.solution.pressure[n] * nodes.area(), d = contact.overlap[n];
    const Vector3 force_S = rotate(X_SP.rotation, {0, 0, -node_force});
    force = add(force, force_S);
    Vector3 place_P = samples[n].position_P;
    for (std::size_t axis = 0; !contact.cells.place.empty() && axis < 2; ++axis) place_P[axis] += contact.cells.place[n][axis];
    torque = add(torque, cross(X_SP * place_P, force_S));
    if (samples[n].taxel == kNoTaxel) {
      contact.off_array_load += node_force;
      continue;
    }
    const auto taxel = static_cast<std::size_t>(samples[n].taxel);
    contact.total_force += node_force;
    contact.taxel_force[taxel] += node_force;
    const double share = contact.cells.share.empty() ? 1 : contact.cells.share[n];
    contact.mean_penetration[taxel] += share * std::max(d, 0.0) / per_taxel;
    const bool is_deep = contact.cells.share.empty() ? d >= thickness : share >= kLeastShareOfFull && d >= kFullDepth * thickness;
    contact.over_penetration += is_deep ? 1 / (per_taxel * numTaxels(sensor)) : 0;
  }
  contact.wrench = {force[0], force[1], force[2], torque[0], torque[1], torque[2]};
}

std::vector<Sample> layerSamples(const Sensor& sensor, const LayerNodes& nodes) {
  std::vector<Sample> samples;
  for (int u = 0; u < nodes.num_rows; ++u) {
    for (int v = 0; v < nodes.num_cols; ++v) {
      const double x = (u - (nodes.num_rows - 1) / 2.0) * nodes.spacing[0], y = (v - (nodes.num_cols - 1) / 2.0) * nodes.spacing[1];
      samples.push_back({0, taxelAt(sensor, nodes, u, v), {x, y, 0}, nodes.area()});
    }
  }
  return samples;
}

Layer makeLayer(const Sensor& sensor) {
  Layer layer{layerNodes(sensor), {}};
  layer.influence = layerInfluence(std::get<ElasticLayer>(sensor.skin.law), sensor.skin.thickness, layer.nodes.spacing,
                                   layer.nodes.num_rows, layer.nodes.num_cols);
  return layer;
}

LayerSolution solveLayer(const Layer& layer, std::span<const double> overlap, double tolerance, std::span<const double> compliance) {
  LayerSolution solution;
  solution.pressure.assign(overlap.size(), 0);
  const double deepest = *std::max_element(overlap.begin(), overlap.end());
  if (deepest <= 0) return solution;
  NodeSubset problem{layer, {}, {}};
  for (std::size_t n = 0; n < overlap.size(); ++n) {
    if (!std::isfinite(overlap[n])) continue;
    problem.node.push_back({static_cast<int>(n) / layer.nodes.num_cols, static_cast<int>(n) % layer.nodes.num_cols});
    problem.d.push_back(overlap[n]);
    if (!compliance.empty()) problem.compliance.push_back(compliance[n]);
  }
  const NonNegativeSolution found = solveNonNegative(problem, deepest, tolerance);
  if (!(found.residual <= tolerance)) throw std::runtime_error("elastic layer: no convergence, residual " + std::to_string(found.residual));
  for (std::size_t n = 0; n < problem.node.size(); ++n) {
    const auto [row, col] = problem.node[n];
    solution.pressure[static_cast<std::size_t>(row * layer.nodes.num_cols + col)] = found.p[n];
  }
  solution.residual = found.residual;
  solution.iterations = found.iterations;
  return solution;
}

std::vector<double> pressureRates(const Layer& layer, const LayerContact& contact, std::span<const double> overlap_rates) {
  constexpr double kTolerance = 1e-24;  // of |residual|^2, relative to the initial one
  const std::vector<double>& pressure = contact.solution.pressure;
  NodeSubset problem{layer, {}, {}};
  std::vector<std::size_t> index;
  for (std::size_t n = 0; n < pressure.size(); ++n) {
    if (pressure[n] <= 0) continue;
    problem.node.push_back({static_cast<int>(n) / layer.nodes.num_cols, static_cast<int>(n) % layer.nodes.num_cols});
    problem.d.push_back(overlap_rates[n]);
    if (!contact.cells.compliance.empty()) problem.compliance.push_back(contact.cells.compliance[n]);
    index.push_back(n);
  }
  // Conjugate gradients for A x = d, from x = 0.
  std::vector<double> x(index.size(), 0), r = problem.d, t = problem.d;
  const auto squaredNorm = [](const std::vector<double>& v) { return std::inner_product(v.begin(), v.end(), v.begin(), 0.0); };
  const double initial = squaredNorm(r);
  double squares = initial;
  for (std::size_t iteration = 0; iteration < 4 * index.size() && squares > kTolerance * initial; ++iteration) {
    const std::vector<double> q = problem.displacements(t);
    const double step = squares / std::inner_product(q.begin(), q.end(), t.begin(), 0.0), previous = squares;
    for (std::size_t n = 0; n < x.size(); ++n) {
      x[n] += step * t[n];
      r[n] -= step * q[n];
    }
    squares = squaredNorm(r);
    for (std::size_t n = 0; n < x.size(); ++n) t[n] = r[n] + squares / previous * t[n];
  }
  std::vector<double> rates(pressure.size(), 0);
  for (std::size_t n = 0; n < x.size(); ++n) rates[index[n]] = contact.gain * x[n];
  return rates;
}

double totalForce(const Layer& layer, std::span<const double> pressure) {
  double sum = 0;
  for (const double p : pressure) sum += p * layer.nodes.area();
  return sum;
}

std::vector<double> layerHeights(const Sensor& sensor, const LayerNodes& nodes, std::span<const PlacedObject> objects) {
  // A grid of one sample per taxel at the nodes.
  const GridPatch grid{
      .name = "", .num_rows = nodes.num_rows, .num_cols = nodes.num_cols, .pitch = nodes.spacing, .X_SP = sensor.patches.front().X_SP};
  std::vector<double> heights;
  appendHeights(grid, 1, objects, {}, heights);
  return heights;
}

PressedSkin pressedNodes(const Sensor& sensor, std::span<const PlacedObject> objects, const LayerContact& contact) {
  const LayerNodes nodes = layerNodes(sensor);
  const std::vector<double>& pressure = contact.solution.pressure;
  PressedSkin skin{layerSamples(sensor, nodes), std::vector<int>(pressure.size(), kNoContact), contact.overlap, pressure};
  const LayerCells& cells = contact.cells;
  for (std::size_t n = 0; n < cells.share.size(); ++n) {
    skin.share.push_back(cells.share[n] > 0 ? cells.share[n] : 1);  // skin that bulges meets a surface above it
    for (std::size_t axis = 0; axis < 2; ++axis) skin.points[n].position_P[axis] += cells.place[n][axis];
  }
  if (!hasFriction(sensor.skin) || objects.empty()) return skin;
  const auto heightsUnder = [&](std::span<const PlacedObject> object) { return layerHeights(sensor, nodes, object); };
  const std::vector<int> lowest = lowestObjects(objects, sensor.skin.thickness, heightsUnder);
  for (std::size_t n = 0; n < pressure.size(); ++n) {
    const int touching = !cells.edge.empty() && cells.edge[n] > 0 ? cells.touching[n] : lowest[n];
    skin.touching[n] = pressure[n] > 0 ? touching : kNoContact;
  }
  return skin;
}

LayerContact layerContact(const Sensor& sensor, std::span<const PlacedObject> objects, const SkinStep& skin) {
  const Layer layer = makeLayer(sensor);
  const LayerCells cells = layerCells(sensor, layer.nodes, objects);
  const std::vector<double> heights = heightsOfCells(cells, layerHeights(sensor, layer.nodes, objects));
  return solveContact(sensor, layer, heights, residualDent(layer, skin), cells);
}

namespace {

// Contact with the objects translated along z so that all nodes carry `load` (N). `heights`: (nodes), m. `first_touch` (m): depth of the
// lowest node at which force begins. `contactAt` solves the contact for heights.
template <typename ContactAt>
LayerContact searchDepth(std::span<const double> heights, double first_touch, double thickness, double load, ContactAt contactAt) {
  const double lowest = *std::min_element(heights.begin(), heights.end());
  LayerContact contact;
  if (!std::isfinite(lowest)) {
    contact = contactAt(heights);
    contact.load_reached = false;
    return contact;
  }
  const auto contactAtDepth = [&](double depth) {
    std::vector<double> moved(heights.begin(), heights.end());
    for (double& height : moved) height -= lowest + depth;
    LayerContact result = contactAt(moved);
    result.offset = -lowest - depth;
    return result;
  };
  const auto excess = [&](const LayerContact& c) { return c.total_force + c.off_array_load - load; };
  double shallow = std::min(first_touch, thickness), deep = thickness;
  contact = contactAtDepth(deep);
  contact.load_reached = excess(contact) >= 0;
  if (!contact.load_reached) return contact;
  if (load == 0) return contactAtDepth(shallow);
  // Force is monotone in depth: four bisections, then the Illinois variant of regula falsi.
  constexpr int kMaxEvaluations = 100;
  constexpr double kLoadTolerance = 1e-8;  // relative
  double shallow_excess = -load, deep_excess = excess(contact);
  int last_side = 0;
  for (int n = 0; n < kMaxEvaluations; ++n) {
    const double depth = n < 4 ? (shallow + deep) / 2 : shallow + (deep - shallow) * shallow_excess / (shallow_excess - deep_excess);
    contact = contactAtDepth(depth);
    contact.load_reached = true;
    const double error = excess(contact);
    if (std::abs(error) <= kLoadTolerance * load) return contact;
    const int side = error > 0 ? 1 : -1;
    if (side > 0) {
      deep = depth;
      deep_excess = error;
      if (last_side == side) shallow_excess /= 2;
    } else {
      shallow = depth;
      shallow_excess = error;
      if (last_side == side) deep_excess /= 2;
    }
    last_side = side;
  }
  throw std::runtime_error("load search of an elastic layer did not converge");
}

}  // namespace

LayerContact loadedLayerContact(const Sensor& sensor, std::span<const PlacedObject> objects, double load, const SkinStep& skin) {
  const Layer layer = makeLayer(sensor);
  const ResidualDent dent = residualDent(layer, skin);
  const LayerCells cells = layerCellsAtFullDepth(sensor, layer.nodes, objects);
  const std::vector<double> heights = heightsOfCells(cells, layerHeights(sensor, layer.nodes, objects));
  double bottom = std::numeric_limits<double>::infinity();
  const double lowest = *std::min_element(heights.begin(), heights.end());
  for (std::size_t n = 0; n < heights.size(); ++n) {
    bottom = std::min(bottom, heights[n] - lowest + dent.depth[n] + dentCompliance(dent, cells, n) * dent.strain[n]);
  }
  return searchDepth(heights, bottom, sensor.skin.thickness, load,
                     [&](std::span<const double> moved) { return solveContact(sensor, layer, moved, dent, cells); });
}

}  // namespace taxelsim::reference
