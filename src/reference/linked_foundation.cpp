#include "reference/linked_foundation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <stdexcept>

#include "base/vector3.h"
#include "reference/area_depth.h"
#include "reference/load.h"
#include "sensor/pasternak.h"

namespace taxelsim::reference {
namespace {

// The sensor with its nodes as samples.
Sensor refined(const Sensor& sensor) {
  Sensor result = sensor;
  result.samples_per_taxel *= pasternakRefinement(sensor);
  return result;
}

// v turned by the shortest rotation from the unit vector n to m (O. Rodrigues).
Vector3 turned(const Vector3& v, const Vector3& n, const Vector3& m) {
  const Vector3 axis = cross(n, m);
  return add(add(scale(dot(n, m), v), cross(axis, v)), scale(dot(axis, v) / (1 + dot(n, m)), axis));
}

// Where taxels lie as seen from one of them, in its tangent plane, with the skin between laid out flat.
class LaidOut {
 public:
  LaidOut(const Vector3& position, const Vector3& normal) : position_(position), normal_(normal) {}

  // The place of a point at `offset` from the middle `q` of a taxel with the normal m, in its plane; relative to the middle of the first.
  Vector3 placeOf(const Vector3& q, const Vector3& m, const Vector3& offset) const {
    // On a surface of constant curvature the chord is normal to the middle of both normals.
    const Vector3 middle = unit(add(normal_, m));
    const Vector3 chord = subtract(q, position_), flat = turned(subtract(chord, scale(dot(chord, middle), middle)), middle, normal_);
    const Vector3 turn = cross(normal_, m);
    const double sine = length(turn), half_angle = std::atan2(sine, dot(normal_, m)) / 2;
    Vector3 place = scale(length(chord) / std::max(length(flat), std::numeric_limits<double>::min()), flat);
    if (sine > 1e-9) {
      const Vector3 axis = scale(1 / sine, turn), along = scale(dot(place, axis), axis);
      place = add(along, scale(half_angle / std::sin(half_angle), subtract(place, along)));
    }
    return add(place, turned(offset, m, normal_));
  }

 private:
  Vector3 position_, normal_;
};

struct Node {
  int patch = 0, taxel = 0;
  int row = 0, col = 0;  // in the patch
  Vector3 offset{};      // from the middle of the taxel, in S
};

std::vector<Node> nodesOf(const Sensor& sensor) {
  const Sensor nodes = refined(sensor);
  const std::vector<Vector3> middles = taxelPositions(sensor);
  std::vector<Node> result;
  for (const Sample& sample : samplesOf(nodes)) {
    const GridPatch& patch = sensor.patches[static_cast<std::size_t>(sample.patch)];
    const auto index = [&](std::size_t axis, int taxels) {
      const double spacing = patch.pitch[axis] / nodes.samples_per_taxel;
      return static_cast<int>(std::lround(sample.position_P[axis] / spacing + (taxels * nodes.samples_per_taxel - 1) / 2.0));
    };
    result.push_back({sample.patch, sample.taxel, index(0, patch.num_rows), index(1, patch.num_cols),
                      subtract(patch.X_SP * sample.position_P, middles[static_cast<std::size_t>(sample.taxel)])});
  }
  return result;
}

class Linker {
 public:
  Linker(const Sensor& sensor, LinkedFoundation& foundation)
      : sensor_(sensor),
        law_(std::get<Pasternak>(sensor.skin.law)),
        decay_(decayLength(law_)),
        per_side_(sensor.samples_per_taxel * pasternakRefinement(sensor)),
        nodes_(nodesOf(sensor)),
        positions_(taxelPositions(sensor)),
        normals_(taxelNormals(sensor)),
        foundation_(foundation) {}

  void link() {
    for (std::size_t n = 0; n < nodes_.size(); ++n) by_place_[{nodes_[n].patch, nodes_[n].row, nodes_[n].col}] = n;
    for (std::size_t n = 0; n < nodes_.size(); ++n) {
      for (const auto& [u, v] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
        const auto next = by_place_.find({nodes_[n].patch, nodes_[n].row + u, nodes_[n].col + v});
        if (next == by_place_.end()) {
          linkSide(n, u, v);
        } else {
          const auto [out, width] = sizes(n, u);
          const std::size_t side = (u != 0 ? 0 : 2) + (u + v > 0 ? 1 : 0);
          addHalf({n, next->second, law_.shear_stiffness * width / out / 2, out, side, side ^ 1u});
        }
      }
    }
    for (const auto& [pair, link] : links_) foundation_.links.push_back(link);
  }

 private:
  // Spacing across and along a side.
  std::pair<double, double> sizes(std::size_t n, int u) const {
    const std::array<double, 2>& pitch = patchOf(n).pitch;
    return {pitch[u != 0 ? 0 : 1] / per_side_, pitch[u != 0 ? 1 : 0] / per_side_};
  }

  const GridPatch& patchOf(std::size_t n) const { return sensor_.patches[static_cast<std::size_t>(nodes_[n].patch)]; }

  void addHalf(const LinkedFoundation::Link& half) {
    const auto [found, is_new] = links_.try_emplace({std::min(half.first, half.second), std::max(half.first, half.second)}, half);
    if (is_new) return;
    found->second.stiffness += half.stiffness;
    found->second.length = std::min(found->second.length, half.length);
  }

  // The side of the cell of node n through which the line to another node leaves.
  std::size_t sideTowards(std::size_t n, std::size_t other) const {
    constexpr double kCorner = 1e-6;
    const auto own = static_cast<std::size_t>(nodes_[n].taxel), taxel = static_cast<std::size_t>(nodes_[other].taxel);
    const LaidOut plane(positions_[own], normals_[own]);
    const Vector3 place = subtract(plane.placeOf(positions_[taxel], normals_[taxel], nodes_[other].offset), nodes_[n].offset);
    const Quaternion& R_SP = patchOf(n).X_SP.rotation;
    const double x = dot(place, rotate(R_SP, {1, 0, 0})), y = dot(place, rotate(R_SP, {0, 1, 0}));
    const auto [size, width] = sizes(n, 1);
    const bool leaves_along_y = std::abs(y) * size > (1 + kCorner) * std::abs(x) * width;
    return leaves_along_y ? (y > 0 ? 3 : 2) : (x > 0 ? 1 : 0);
  }

  void linkSide(std::size_t n, int u, int v) {
    constexpr int kPlaces = 240;  // on a side
    const auto [out, width] = sizes(n, u);
    const auto own = static_cast<std::size_t>(nodes_[n].taxel);
    const Quaternion& R_SP = patchOf(n).X_SP.rotation;
    const Vector3 outwards = rotate(R_SP, {static_cast<double>(u), static_cast<double>(v), 0});
    const Vector3 along = rotate(R_SP, {static_cast<double>(v), static_cast<double>(u), 0});
    const Vector3 side = add(nodes_[n].offset, scale(out / 2, outwards));
    const LaidOut plane(positions_[own], normals_[own]);
    std::vector<std::pair<std::size_t, Vector3>> near;  // nodes, and their places from the middle of the side
    for (std::size_t k = 0; k < nodes_.size(); ++k) {
      const auto taxel = static_cast<std::size_t>(nodes_[k].taxel);
      if (nodes_[k].patch == nodes_[n].patch || dot(normals_[own], normals_[taxel]) <= 0) continue;
      const Vector3 chord = subtract(positions_[taxel], positions_[own]);
      if (length(chord) >
          2 * decay_ + std::hypot(patchOf(n).pitch[0], patchOf(n).pitch[1]) + std::hypot(patchOf(k).pitch[0], patchOf(k).pitch[1]))
        continue;
      const Vector3 place = subtract(plane.placeOf(positions_[taxel], normals_[taxel], nodes_[k].offset), side);
      if (length(place) < decay_ + width && dot(place, outwards) > 0) near.emplace_back(k, place);
    }
    std::map<std::size_t, std::pair<int, Vector3>> counts;
    int open = 0;
    for (int i = 0; i < kPlaces; ++i) {
      const Vector3 place = scale(((i + 0.5) / kPlaces - 0.5) * width, along);
      const auto distance = [&](const auto& node) { return length(subtract(node.second, place)); };
      const auto nearest =
          std::min_element(near.begin(), near.end(), [&](const auto& a, const auto& b) { return distance(a) < distance(b); });
      const bool is_aside = nearest != near.end() && std::abs(dot(subtract(nearest->second, place), along)) >
                                                         std::max({dot(nearest->second, outwards) + out / 2, out, width});
      if (nearest == near.end() || distance(*nearest) > decay_ || is_aside) {
        ++open;
      } else {
        auto& [count, where] = counts[nearest->first];
        ++count;
        where = nearest->second;
      }
    }
    for (const auto& [other, found] : counts) {
      const double across = dot(found.second, outwards) + out / 2, distance = length(add(found.second, scale(out / 2, outwards)));
      addHalf({n, other, law_.shear_stiffness * width * found.first / kPlaces / across / 2, distance, sideTowards(n, other),
               sideTowards(other, n)});
    }
    foundation_.spring[n] += law_.shear_stiffness * width * open / kPlaces / out * (1 - std::exp(-out / decay_));
  }

  const Sensor& sensor_;
  Pasternak law_;
  double decay_;
  int per_side_;
  std::vector<Node> nodes_;
  std::vector<Vector3> positions_, normals_;
  LinkedFoundation& foundation_;
  std::map<std::array<int, 3>, std::size_t> by_place_;
  std::map<std::pair<std::size_t, std::size_t>, LinkedFoundation::Link> links_;
};

// Stiffness of all springs and links under one overlap, as a product with displacements.
class StiffnessMatrix {
 public:
  StiffnessMatrix(const LinkedFoundation& foundation, std::span<const double> overlap, std::span<const Arms> arms)
      : foundation_(foundation), diagonal_(foundation.spring) {
    for (const LinkedFoundation::Link& link : foundation.links) {
      const double a = overlap[link.first], b = overlap[link.second];
      const double steep = std::max(a, b) > 0 ? std::clamp(std::abs(a - b) / link.length - 1, 0.0, 1.0) : 0;
      const double covered = arms.empty() ? 0 : arms[link.first][link.first_side] + arms[link.second][link.second_side];
      stiffness_.push_back(link.stiffness * (arms.empty() ? 1 + steep : cutLinkFactor(a, b, covered, link.length)));
      diagonal_[link.first] += stiffness_.back();
      diagonal_[link.second] += stiffness_.back();
    }
  }

  std::vector<double> operator*(const std::vector<double>& w) const {
    std::vector<double> force(w.size());
    for (std::size_t n = 0; n < w.size(); ++n) force[n] = diagonal_[n] * w[n];
    for (std::size_t k = 0; k < stiffness_.size(); ++k) {
      const LinkedFoundation::Link& link = foundation_.links[k];
      force[link.first] -= stiffness_[k] * w[link.second];
      force[link.second] -= stiffness_[k] * w[link.first];
    }
    return force;
  }

  // Sets the displacements of the nodes that are not held so that no force acts on them, by conjugate gradients.
  void relax(std::vector<double>& w, const std::vector<bool>& is_held) const {
    constexpr double kTolerance = 1e-26;  // of the squared residual
    const std::size_t size = w.size();
    const auto residual = [&](const std::vector<double>& force) {
      std::vector<double> r(size, 0);
      for (std::size_t n = 0; n < size; ++n) r[n] = is_held[n] ? 0 : -force[n];
      return r;
    };
    std::vector<double> r = residual(*this * w), direction(size, 0);
    double before = 0, first = 0;
    for (std::size_t iteration = 0; iteration < size; ++iteration) {
      double square = 0;
      for (std::size_t n = 0; n < size; ++n) square += r[n] * r[n] / diagonal_[n];
      if (iteration == 0) first = square;
      if (square <= kTolerance * first) return;
      for (std::size_t n = 0; n < size; ++n) direction[n] = r[n] / diagonal_[n] + (before > 0 ? square / before : 0) * direction[n];
      before = square;
      const std::vector<double> product = residual(*this * direction);  // of opposite sign
      const double step = -square / std::inner_product(direction.begin(), direction.end(), product.begin(), 0.0);
      for (std::size_t n = 0; n < size; ++n) {
        w[n] += step * direction[n];
        r[n] += step * product[n];
      }
    }
    throw std::runtime_error("linked foundation: conjugate gradients did not converge");
  }

 private:
  const LinkedFoundation& foundation_;
  std::vector<double> diagonal_, stiffness_;
};

// What nodes meet, all of shape (nodes).
struct MetSurface {
  std::vector<double> heights;       // m, +infinity where a node is free
  std::vector<Arms> arms;            // empty with points
  std::vector<double> mean_heights;  // m: over what is covered of the cell
  std::vector<double> covered;       // share of the cell
  double full_depth = 1;             // thicknesses
};

// `nodes`: the sensor with its nodes as samples.
MetSurface metSurface(const Sensor& nodes, std::span<const PlacedObject> objects) {
  MetSurface met;
  met.heights = surfaceHeights(nodes, objects);
  const LayerCells cells = sampleCells(nodes, objects);
  if (cells.covered.empty()) {
    met.mean_heights = met.heights;
    met.covered.assign(met.heights.size(), 1);
    return met;
  }
  std::vector<std::array<double, 2>> sizes;
  for (const Sample& sample : samplesOf(nodes)) {
    const std::array<double, 2>& pitch = nodes.patches[static_cast<std::size_t>(sample.patch)].pitch;
    sizes.push_back({pitch[0] / nodes.samples_per_taxel, pitch[1] / nodes.samples_per_taxel});
  }
  const FoundationCells cut = foundationCells(cells, sizes, met.heights);
  return {
      .heights = cut.height, .arms = armsAtDepth(cut, 0), .mean_heights = cells.height, .covered = cells.covered, .full_depth = kFullDepth};
}

LayerContact contactOf(const Sensor& sensor, const LinkedFoundation& foundation, std::span<const PlacedObject> objects) {
  const Sensor nodes = refined(sensor);
  const std::vector<Sample> samples = samplesOf(nodes);
  const double thickness = sensor.skin.thickness;
  const MetSurface met = metSurface(nodes, objects);
  LayerContact contact;
  for (const double height : met.heights) contact.overlap.push_back(std::min(-height, thickness));
  contact.solution.pressure = solveLinked(foundation, contact.overlap, met.arms).pressure;
  contact.taxel_force.assign(static_cast<std::size_t>(numTaxels(sensor)), 0);
  contact.mean_penetration = contact.taxel_force;
  const auto per_taxel = static_cast<double>(samplesPerTaxel(nodes));
  Vector3 force{0, 0, 0}, torque{0, 0, 0};
  for (std::size_t n = 0; n < samples.size(); ++n) {
    const Pose& X_SP = sensor.patches[static_cast<std::size_t>(samples[n].patch)].X_SP;
    const double node_force = contact.solution.pressure[n] * foundation.area[n];
    const Vector3 force_S = rotate(X_SP.rotation, {0, 0, -node_force});
    force = add(force, force_S);
    torque = add(torque, cross(X_SP * samples[n].position_P, force_S));
    const auto taxel = static_cast<std::size_t>(samples[n].taxel);
    contact.taxel_force[taxel] += node_force;
    contact.mean_penetration[taxel] += met.covered[n] * std::clamp(-met.mean_heights[n], 0.0, thickness) / per_taxel;
    contact.total_force += node_force;
    contact.over_penetration += contact.overlap[n] >= met.full_depth * thickness ? 1 / static_cast<double>(samples.size()) : 0;
  }
  contact.wrench = {force[0], force[1], force[2], torque[0], torque[1], torque[2]};
  return contact;
}

}  // namespace

LinkedFoundation linkedFoundation(const Sensor& sensor) {
  LinkedFoundation foundation;
  for (const Sample& sample : samplesOf(refined(sensor))) {
    foundation.area.push_back(sample.area);
    foundation.spring.push_back(std::get<Pasternak>(sensor.skin.law).normal_contact_stiffness * sample.area);
  }
  Linker(sensor, foundation).link();
  return foundation;
}

LinkedSolution solveLinked(const LinkedFoundation& foundation, std::span<const double> overlap, std::span<const Arms> arms) {
  constexpr int kMaxSets = 200;
  const std::size_t size = overlap.size();
  LinkedSolution solution{std::vector<double>(size, 0), std::vector<double>(size, 0)};
  const double deepest = *std::max_element(overlap.begin(), overlap.end());
  if (deepest <= 0) return solution;
  const double rounding = 1e-12 * deepest;
  const StiffnessMatrix matrix(foundation, overlap, arms);
  std::vector<bool> is_held(size);
  for (std::size_t n = 0; n < size; ++n) is_held[n] = overlap[n] > 0;
  for (int set = 0; set < kMaxSets; ++set) {
    std::vector<double>& w = solution.displacement;
    for (std::size_t n = 0; n < size; ++n) w[n] = is_held[n] ? overlap[n] : w[n];
    matrix.relax(w, is_held);
    const std::vector<double> force = matrix * w;
    bool changes = false;
    for (std::size_t n = 0; n < size; ++n) {
      const bool holds = is_held[n] ? force[n] >= 0 : w[n] < overlap[n] - rounding;
      changes = changes || holds != is_held[n];
      solution.pressure[n] = is_held[n] ? std::max(force[n], 0.0) / foundation.area[n] : 0;
      is_held[n] = holds;
    }
    if (!changes) return solution;
  }
  throw std::runtime_error("linked foundation: the contact did not converge");
}

LayerContact linkedContact(const Sensor& sensor, std::span<const PlacedObject> objects) {
  return contactOf(sensor, linkedFoundation(sensor), objects);
}

LayerContact loadedLinkedContact(const Sensor& sensor, std::span<const PlacedObject> objects, double load) {
  constexpr double kLoadTolerance = 1e-9;  // of the load
  constexpr int kMaxHalvings = 60;
  // First touch and full depth are those of independent springs.
  Sensor springs = refined(sensor);
  springs.skin.law = Winkler{.normal_contact_stiffness = std::get<Pasternak>(sensor.skin.law).normal_contact_stiffness};
  const LoadResult range = findLoad(springs, objects, 0);
  const LinkedFoundation foundation = linkedFoundation(sensor);
  const auto contactAt = [&](double offset) {
    LayerContact contact = contactOf(sensor, foundation, movedAlongZ(objects, offset));
    contact.offset = offset;
    return contact;
  };
  if (!range.reached) {
    LayerContact contact = contactAt(range.offset);
    contact.load_reached = false;
    return contact;
  }
  double low = range.full_depth, high = range.first_touch;
  LayerContact contact = contactAt(low);
  contact.load_reached = -contact.wrench[2] >= load;
  if (!contact.load_reached) return contact;
  if (load <= 0) return contactAt(high);
  for (int n = 0; n < kMaxHalvings; ++n) {
    const double middle = (low + high) / 2;
    contact = contactAt(middle);
    if (std::abs(-contact.wrench[2] - load) <= kLoadTolerance * load) break;
    (-contact.wrench[2] > load ? low : high) = middle;
  }
  return contact;
}

}  // namespace taxelsim::reference
