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

// The nodes over which there is a surface, and what is asked of them.
struct Problem {
  const Layer& layer;
  std::vector<std::array<int, 2>> node;  // row, column
  std::vector<double> d;

  // A x over these nodes.
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
    }
    return w;
  }
};

// How far p is from the solution: see LayerSolution.
double residualOf(const Problem& problem, const std::vector<double>& p, const std::vector<double>& excess, double deepest) {
  double worst = 0;
  for (std::size_t n = 0; n < p.size(); ++n) worst = std::max(worst, p[n] > 0 ? std::abs(excess[n]) : -excess[n]);
  return problem.node.empty() ? 0 : worst / deepest;
}

struct Minimum {
  std::vector<double> p;
  double residual;
  int iterations;
};

Minimum minimise(const Problem& problem, double deepest, double tolerance) {
  constexpr int kMaxIterations = 20000;
  const std::size_t size = problem.node.size();
  std::vector<double> p(size, 0), t(size, 0);
  double previous = 0;  // sum of squared residuals of the iteration before; 0 starts the directions anew
  for (int iteration = 0;; ++iteration) {
    std::vector<double> r = problem.displacements(p);
    for (std::size_t n = 0; n < size; ++n) r[n] -= problem.d[n];
    const double residual = residualOf(problem, p, r, deepest);
    if (residual <= tolerance || iteration == kMaxIterations) return {p, residual, iteration};
    double squares = 0;
    for (std::size_t n = 0; n < size; ++n) squares += p[n] > 0 ? r[n] * r[n] : 0;
    for (std::size_t n = 0; n < size; ++n) t[n] = p[n] > 0 ? r[n] + (previous > 0 ? squares / previous * t[n] : 0) : 0;
    previous = squares;
    const std::vector<double> q = problem.displacements(t);
    double along = 0, curvature = 0;
    for (std::size_t n = 0; n < size; ++n) {
      along += r[n] * t[n];
      curvature += q[n] * t[n];
    }
    // The first step has no node in contact yet: a node's own compliance is the scale.
    const double step = curvature > 0 ? along / curvature : 1 / problem.layer.influence.front();
    for (std::size_t n = 0; n < size; ++n) {
      p[n] = std::max(0.0, p[n] - step * t[n]);
      if (p[n] == 0 && r[n] < 0) {
        p[n] = -step * r[n];
        previous = 0;
      }
    }
  }
}

// The taxel of node (u, v), or kNoTaxel.
int taxelAt(const Sensor& sensor, const LayerNodes& nodes, int u, int v) {
  const GridPatch& patch = sensor.patches.front();
  const int s = sensor.samples_per_taxel, a = u - nodes.margin_rows, b = v - nodes.margin_cols;
  if (a < 0 || b < 0 || a >= patch.num_rows * s || b >= patch.num_cols * s) return kNoTaxel;
  return a / s * patch.num_cols + b / s;
}

// What a skin that relaxes brings into a step.
struct Dents {
  double gain = 1;
  std::vector<double> strain;  // (nodes), Pa: to which they recover by themselves
  std::vector<double> depth;   // (nodes), m: by which that lowers the surface
};

Dents dentsOf(const Layer& layer, const SkinStep& skin) {
  const auto size = static_cast<std::size_t>(layer.nodes.num_rows * layer.nodes.num_cols);
  Dents dents{skin.gain, {}, std::vector<double>(size, 0)};
  Problem everywhere{layer, {}, {}};
  for (std::size_t n = 0; n < size; ++n) {
    dents.strain.push_back(skin.recovered(n));
    everywhere.node.push_back({static_cast<int>(n) / layer.nodes.num_cols, static_cast<int>(n) % layer.nodes.num_cols});
  }
  if (!skin.strain.empty()) dents.depth = everywhere.displacements(dents.strain);
  return dents;
}

LayerContact contactAt(const Sensor& sensor, const Layer& layer, std::span<const double> heights, const Dents& dents) {
  const LayerNodes& nodes = layer.nodes;
  const double thickness = sensor.skin.thickness;
  LayerContact contact;
  contact.gain = dents.gain;
  contact.taxel_force.assign(static_cast<std::size_t>(numTaxels(sensor)), 0);
  contact.mean_penetration = contact.taxel_force;
  std::vector<double> below;  // the surface as it is without pressure
  for (std::size_t n = 0; n < heights.size(); ++n) {
    contact.overlap.push_back(std::min(-heights[n], thickness));
    below.push_back(contact.overlap[n] - dents.depth[n]);
  }
  contact.solution = pressLayer(layer, below);
  for (std::size_t n = 0; n < heights.size(); ++n) {
    double& pressure = contact.solution.pressure[n];
    contact.strain.push_back(dents.strain[n] + pressure);
    pressure *= dents.gain;
  }
  const double per_taxel = sensor.samples_per_taxel * sensor.samples_per_taxel;
  const Pose& X_SP = sensor.patches.front().X_SP;
  Vector3 force{0, 0, 0}, torque{0, 0, 0};
  const std::vector<Sample> samples = layerSamples(sensor, nodes);
  for (std::size_t n = 0; n < samples.size(); ++n) {
    const double node_force = contact.solution.pressure[n] * nodes.area(), d = contact.overlap[n];
    const Vector3 force_S = rotate(X_SP.rotation, {0, 0, -node_force});
    force = add(force, force_S);
    torque = add(torque, cross(X_SP * samples[n].position_P, force_S));
    if (samples[n].taxel == kNoTaxel) {
      contact.off_array_load += node_force;
      continue;
    }
    const auto taxel = static_cast<std::size_t>(samples[n].taxel);
    contact.total_force += node_force;
    contact.taxel_force[taxel] += node_force;
    contact.mean_penetration[taxel] += std::max(d, 0.0) / per_taxel;
    contact.over_penetration += d >= thickness ? 1 / (per_taxel * numTaxels(sensor)) : 0;
  }
  contact.wrench = {force[0], force[1], force[2], torque[0], torque[1], torque[2]};
  return contact;
}

}  // namespace

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

LayerSolution pressLayer(const Layer& layer, std::span<const double> overlap, double tolerance) {
  LayerSolution solution;
  solution.pressure.assign(overlap.size(), 0);
  const double deepest = *std::max_element(overlap.begin(), overlap.end());
  if (deepest <= 0) return solution;
  Problem problem{layer, {}, {}};
  for (std::size_t n = 0; n < overlap.size(); ++n) {
    if (!std::isfinite(overlap[n])) continue;
    problem.node.push_back({static_cast<int>(n) / layer.nodes.num_cols, static_cast<int>(n) % layer.nodes.num_cols});
    problem.d.push_back(overlap[n]);
  }
  const Minimum found = minimise(problem, deepest, tolerance);
  if (!(found.residual <= tolerance)) throw std::runtime_error("elastic layer: residual " + std::to_string(found.residual));
  for (std::size_t n = 0; n < problem.node.size(); ++n) {
    const auto [row, col] = problem.node[n];
    solution.pressure[static_cast<std::size_t>(row * layer.nodes.num_cols + col)] = found.p[n];
  }
  solution.residual = found.residual;
  solution.iterations = found.iterations;
  return solution;
}

std::vector<double> pressureRates(const Layer& layer, const LayerContact& contact, std::span<const double> overlap_rates) {
  constexpr double kLeft = 1e-24;  // squares, of those at the beginning
  const std::vector<double>& pressure = contact.solution.pressure;
  Problem problem{layer, {}, {}};
  std::vector<std::size_t> index;
  for (std::size_t n = 0; n < pressure.size(); ++n) {
    if (pressure[n] <= 0) continue;
    problem.node.push_back({static_cast<int>(n) / layer.nodes.num_cols, static_cast<int>(n) % layer.nodes.num_cols});
    problem.d.push_back(overlap_rates[n]);
    index.push_back(n);
  }
  // Conjugate gradients from 0.
  std::vector<double> x(index.size(), 0), missed = problem.d, t = problem.d;
  const auto squaresOf = [](const std::vector<double>& v) { return std::inner_product(v.begin(), v.end(), v.begin(), 0.0); };
  const double first = squaresOf(missed);
  double squares = first;
  for (std::size_t round = 0; round < 4 * index.size() && squares > kLeft * first; ++round) {
    const std::vector<double> q = problem.displacements(t);
    const double step = squares / std::inner_product(q.begin(), q.end(), t.begin(), 0.0), before = squares;
    for (std::size_t n = 0; n < x.size(); ++n) {
      x[n] += step * t[n];
      missed[n] -= step * q[n];
    }
    squares = squaresOf(missed);
    for (std::size_t n = 0; n < x.size(); ++n) t[n] = missed[n] + squares / before * t[n];
  }
  std::vector<double> rates(pressure.size(), 0);
  for (std::size_t n = 0; n < x.size(); ++n) rates[index[n]] = contact.gain * x[n];
  return rates;
}

double forceOn(const Layer& layer, std::span<const double> pressure) {
  double sum = 0;
  for (const double p : pressure) sum += p * layer.nodes.area();
  return sum;
}

std::vector<double> layerHeights(const Sensor& sensor, const LayerNodes& nodes, std::span<const PlacedObject> objects) {
  // The nodes as taxels of one sample.
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
  if (!hasFriction(sensor.skin) || objects.empty()) return skin;
  const auto heightsUnder = [&](std::span<const PlacedObject> one) { return layerHeights(sensor, nodes, one); };
  const std::vector<int> lowest = lowestObjects(objects, sensor.skin.thickness, heightsUnder);
  for (std::size_t n = 0; n < pressure.size(); ++n) skin.touching[n] = pressure[n] > 0 ? lowest[n] : kNoContact;
  return skin;
}

LayerContact layerContact(const Sensor& sensor, std::span<const PlacedObject> objects, const SkinStep& skin) {
  const Layer layer = makeLayer(sensor);
  return contactAt(sensor, layer, layerHeights(sensor, layer.nodes, objects), dentsOf(layer, skin));
}

LayerContact loadedLayerContact(const Sensor& sensor, std::span<const PlacedObject> objects, double load, const SkinStep& skin) {
  const Layer layer = makeLayer(sensor);
  const Dents dents = dentsOf(layer, skin);
  const std::vector<double> heights = layerHeights(sensor, layer.nodes, objects);
  const double lowest = *std::min_element(heights.begin(), heights.end());
  LayerContact contact;
  if (!std::isfinite(lowest)) {
    contact = contactAt(sensor, layer, heights, dents);
    contact.load_reached = false;
    return contact;
  }
  const auto pressed = [&](double depth) {
    std::vector<double> moved = heights;
    for (double& height : moved) height -= lowest + depth;
    LayerContact at = contactAt(sensor, layer, moved, dents);
    at.offset = -lowest - depth;
    return at;
  };
  const auto excess = [&](const LayerContact& at) { return at.total_force + at.off_array_load - load; };
  // From first touch: of the lowest point, or of the skin raised or lowered by dents.
  double shallow = std::numeric_limits<double>::infinity(), deep = sensor.skin.thickness;
  for (std::size_t n = 0; n < heights.size(); ++n) shallow = std::min(shallow, heights[n] - lowest + dents.depth[n]);
  shallow = std::min(shallow, deep);
  contact = pressed(deep);
  contact.load_reached = excess(contact) >= 0;
  if (!contact.load_reached) return contact;
  if (load == 0) return pressed(shallow);
  // Force grows with depth: bisection, then secants between the two ends (Illinois), until the load is met to eight digits.
  constexpr int kMaxEvaluations = 100;
  constexpr double kCarried = 1e-8;
  double too_little = -load, too_much = excess(contact);
  int last = 0;
  for (int n = 0; n < kMaxEvaluations; ++n) {
    const double depth = n < 4 ? (shallow + deep) / 2 : shallow + (deep - shallow) * too_little / (too_little - too_much);
    contact = pressed(depth);
    contact.load_reached = true;
    const double error = excess(contact);
    if (std::abs(error) <= kCarried * load) return contact;
    const int side = error > 0 ? 1 : -1;
    if (side > 0) {
      deep = depth;
      too_much = error;
      if (last == side) too_little /= 2;
    } else {
      shallow = depth;
      too_little = error;
      if (last == side) too_much /= 2;
    }
    last = side;
  }
  throw std::runtime_error("elastic layer: the load is not met");
}

}  // namespace taxelsim::reference
