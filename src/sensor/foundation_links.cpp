#include "sensor/foundation_links.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include "base/vector3.h"
#include "sensor/pasternak.h"
#include "sensor/skin.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

using Place = std::array<double, 2>;

constexpr double kLeastPart = 1e-6;  // of the side of a cell: less is rounding

struct LinkedTaxel {
  const GridPatch* patch = nullptr;
  int patch_number = 0, row = 0, col = 0;
  int first_of_patch = 0;  // taxel
  Vector3 position{}, normal{};
};

std::vector<LinkedTaxel> linkedTaxelsOf(const Sensor& sensor) {
  const std::vector<Vector3> positions = taxelPositions(sensor), normals = taxelNormals(sensor);
  std::vector<LinkedTaxel> taxels;
  int number = 0;
  for (const GridPatch& patch : sensor.patches) {
    const int first = static_cast<int>(taxels.size());
    for (int k = 0; k < patch.num_rows * patch.num_cols; ++k) {
      const std::size_t t = taxels.size();
      taxels.push_back({&patch, number, k / patch.num_cols, k % patch.num_cols, first, positions[t], normals[t]});
    }
    ++number;
  }
  return taxels;
}

// The plane of taxel B laid out in that of taxel A: a place x from the middle of B is at offset + rotation x from the middle of A.
struct Chart {
  Place offset{};
  double cosine = 1, sine = 0;
  bool exists = false;

  Place operator()(const Place& x) const { return {offset[0] + cosine * x[0] - sine * x[1], offset[1] + sine * x[0] + cosine * x[1]}; }
  // Turns a direction in the plane of A to that of B.
  Place turnedBack(const Place& x) const { return {cosine * x[0] + sine * x[1], cosine * x[1] - sine * x[0]}; }
};

// Direction in which B lies from A, in S and of any length: along the geodesic of skinDistance().
Vector3 directionTo(const LinkedTaxel& a, const LinkedTaxel& b) {
  constexpr double kParallel = 1e-9;  // sine of the angle between normals
  const Vector3 chord = subtract(b.position, a.position), turn = cross(a.normal, b.normal);
  const double sine = length(turn);
  if (sine < kParallel) return subtract(chord, scale(dot(chord, a.normal), a.normal));
  const Vector3 axis = scale(1 / sine, turn), around = cross(axis, a.normal);
  const double along = dot(chord, axis), half_angle = std::atan2(sine, dot(a.normal, b.normal)) / 2;
  const double across = std::sqrt(std::max(dot(chord, chord) - along * along, 0.0)) * half_angle / std::sin(half_angle);
  return add(scale(along, axis), scale(std::copysign(across, dot(chord, around)), around));
}

Chart chartOf(const LinkedTaxel& a, const LinkedTaxel& b) {
  Chart chart;
  const Vector3 direction = directionTo(a, b);
  const double size = length(direction);
  if (dot(a.normal, b.normal) <= 0 || size == 0) return chart;
  const double distance = skinDistance(a.position, a.normal, b.position, b.normal);
  const Quaternion &R_SA = a.patch->X_SP.rotation, &R_SB = b.patch->X_SP.rotation;
  const Vector3 x = rotate(R_SA, {1, 0, 0}), y = rotate(R_SA, {0, 1, 0});
  chart.offset = {distance / size * dot(direction, x), distance / size * dot(direction, y)};
  const std::array<double, 2> turned = turnAlongSkin(R_SB, R_SA);
  chart.cosine = turned[0];
  chart.sine = turned[1];
  chart.exists = true;
  return chart;
}

double halfDiagonal(const LinkedTaxel& taxel) {
  return std::hypot(taxel.patch->pitch[0], taxel.patch->pitch[1]) / 2;
}

// Place of node (a, b) of a taxel from its middle.
Place placeInTaxel(const LinkedTaxel& taxel, int per_side, int a, int b) {
  const std::array<double, 2>& pitch = taxel.patch->pitch;
  return {((a + 0.5) / per_side - 0.5) * pitch[0], ((b + 0.5) / per_side - 0.5) * pitch[1]};
}

// A node of another patch, from the middle of a side of a cell: outwards and along the side, m.
struct Candidate {
  int node = 0;
  double out = 0, along = 0;
  int own_side = 0, side = 0;  // FoundationLink::side, and of the candidate
  double square() const { return out * out + along * along; }
};

// The part of a side from -half to half that is nearer to candidate `k` than to any other, within `reach` of it, and not farther along the
// side than `aside`.
double nearestPart(const std::vector<Candidate>& candidates, std::size_t k, double half, double reach, double aside) {
  const Candidate& own = candidates[k];
  if (own.out >= reach) return 0;
  const double within = std::min(std::sqrt(reach * reach - own.out * own.out), aside);
  double first = std::max(-half, own.along - within), last = std::min(half, own.along + within);
  for (std::size_t other = 0; other < candidates.size() && first < last; ++other) {
    if (other == k) continue;
    const double slope = 2 * (candidates[other].along - own.along), excess = candidates[other].square() - own.square();
    if (std::abs(slope) < kLeastPart * half) {  // one of them is nearer everywhere; of equal ones the first
      if (excess < 0 || (excess == 0 && other < k)) return 0;
    } else if (slope > 0) {
      last = std::min(last, excess / slope);
    } else {
      first = std::max(first, excess / slope);
    }
  }
  return std::max(last - first, 0.0);
}

class LinkBuilder {
 public:
  explicit LinkBuilder(const Sensor& sensor)
      : law_(std::get<Pasternak>(sensor.skin.law)),
        decay_(decayLength(law_)),
        per_side_(sensor.samples_per_taxel * pasternakRefinement(sensor)),
        taxels_(linkedTaxelsOf(sensor)) {}

  LinkedNodes build() {
    LinkedNodes nodes{.per_side = per_side_, .links = {}, .spring = {}};
    const std::size_t num_nodes = taxels_.size() * static_cast<std::size_t>(per_side_ * per_side_);
    nodes.links.resize(num_nodes);
    for (const LinkedTaxel& taxel : taxels_) {
      const double area = taxel.patch->pitch[0] * taxel.patch->pitch[1] / (per_side_ * per_side_);
      nodes.spring.insert(nodes.spring.end(), static_cast<std::size_t>(per_side_ * per_side_), law_.normal_contact_stiffness * area);
    }
    spring_ = &nodes.spring;
    for (std::size_t t = 0; t < taxels_.size(); ++t) linkTaxel(t);
    for (const auto& [pair, link] : links_) {
      nodes.links[static_cast<std::size_t>(pair.first)].push_back({pair.second, link.stiffness, link.length, link.side, link.other_side});
      nodes.links[static_cast<std::size_t>(pair.second)].push_back({pair.first, link.stiffness, link.length, link.other_side, link.side});
    }
    for (std::vector<FoundationLink>& list : nodes.links) {
      std::sort(list.begin(), list.end(), [](const FoundationLink& a, const FoundationLink& b) { return a.node < b.node; });
      if (list.size() > static_cast<std::size_t>(kMaxFoundationLinks))
        throw Error(ErrorKind::kInput, "patches: a node of the law pasternak with " + std::to_string(list.size()) +
                                           " links is not allowed: at most " + std::to_string(kMaxFoundationLinks));
    }
    return nodes;
  }

 private:
  int nodeAt(std::size_t taxel, int a, int b) const { return (static_cast<int>(taxel) * per_side_ + a) * per_side_ + b; }

  // The node in row u and column v of the patch of a taxel.
  int nodeInPatch(const LinkedTaxel& taxel, int u, int v) const {
    const int number = taxel.first_of_patch + u / per_side_ * taxel.patch->num_cols + v / per_side_;
    return nodeAt(static_cast<std::size_t>(number), u % per_side_, v % per_side_);
  }

  void add(int node, int other, double stiffness, double length, int side, int other_side) {
    const FoundationLink first{.length = length, .side = node < other ? side : other_side, .other_side = node < other ? other_side : side};
    FoundationLink& link = links_.try_emplace({std::min(node, other), std::max(node, other)}, first).first->second;
    link.stiffness += stiffness;
    link.length = std::min(link.length, length);
  }

  void linkTaxel(std::size_t t) {
    const LinkedTaxel& taxel = taxels_[t];
    const int rows = taxel.patch->num_rows * per_side_, cols = taxel.patch->num_cols * per_side_;
    const std::vector<std::pair<std::size_t, Chart>> around = chartsAround(t);
    for (int a = 0; a < per_side_; ++a) {
      for (int b = 0; b < per_side_; ++b) {
        const int u = taxel.row * per_side_ + a, v = taxel.col * per_side_ + b;
        for (const auto& [du, dv] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
          const bool is_inside = u + du >= 0 && v + dv >= 0 && u + du < rows && v + dv < cols;
          if (!is_inside) {
            linkSide(t, a, b, du, dv, around);
          } else if (du + dv > 0) {
            const std::array<double, 2> spacing = spacingOf(taxel);
            const double out = spacing[du != 0 ? 0 : 1], width = spacing[du != 0 ? 1 : 0];
            const int side = du > 0 ? 1 : 3;
            add(nodeInPatch(taxel, u, v), nodeInPatch(taxel, u + du, v + dv), law_.shear_stiffness * width / out, out, side, side - 1);
          }
        }
      }
    }
  }

  // Taxels of other patches that may be near a rim of this one.
  std::vector<std::pair<std::size_t, Chart>> chartsAround(std::size_t t) const {
    std::vector<std::pair<std::size_t, Chart>> around;
    for (std::size_t other = 0; other < taxels_.size(); ++other) {
      if (taxels_[other].patch_number == taxels_[t].patch_number) continue;
      const Chart chart = chartOf(taxels_[t], taxels_[other]);
      const double near = halfDiagonal(taxels_[t]) + halfDiagonal(taxels_[other]) + decay_;
      if (chart.exists && std::hypot(chart.offset[0], chart.offset[1]) <= near) around.emplace_back(other, chart);
    }
    return around;
  }

  std::array<double, 2> spacingOf(const LinkedTaxel& taxel) const {
    return {taxel.patch->pitch[0] / per_side_, taxel.patch->pitch[1] / per_side_};
  }

  // Divides the side of node (a, b) towards (du, dv), which is at the rim of the patch.
  void linkSide(std::size_t t, int a, int b, int du, int dv, const std::vector<std::pair<std::size_t, Chart>>& around) {
    const std::array<double, 2> spacing = spacingOf(taxels_[t]);
    const double out = spacing[du != 0 ? 0 : 1], half = spacing[du != 0 ? 1 : 0] / 2;
    const Place own = placeInTaxel(taxels_[t], per_side_, a, b), middle{own[0] + du * out / 2, own[1] + dv * out / 2};
    std::vector<Candidate> candidates;
    for (const auto& [other, chart] : around) {
      for (int k = 0; k < per_side_ * per_side_; ++k) {
        const Place place = chart(placeInTaxel(taxels_[other], per_side_, k / per_side_, k % per_side_));
        const double x = place[0] - middle[0], y = place[1] - middle[1];
        if (x * du + y * dv <= 0 || x * x + y * y > (decay_ + half) * (decay_ + half)) continue;
        const Place towards{place[0] - own[0], place[1] - own[1]}, back = chart.turnedBack({-towards[0], -towards[1]});
        candidates.push_back({nodeAt(other, k / per_side_, k % per_side_), x * du + y * dv, x * dv + y * du, sideTowards(towards, spacing),
                              sideTowards(back, spacingOf(taxels_[other]))});
      }
    }
    const int node = nodeAt(t, a, b);
    double open = 2 * half;
    for (std::size_t k = 0; k < candidates.size(); ++k) {
      const double across = candidates[k].out + out / 2;
      const double part = nearestPart(candidates, k, half, decay_, std::max({across, out, 2 * half}));
      if (part <= kLeastPart * half) continue;
      open -= part;
      const double distance = std::hypot(across, candidates[k].along);
      // The other node's side adds its half.
      add(node, candidates[k].node, law_.shear_stiffness * part / across / 2, distance, candidates[k].own_side, candidates[k].side);
    }
    if (open > 2 * kLeastPart * half)
      (*spring_)[static_cast<std::size_t>(node)] +=
          stiffnessAtRest({.stiffness = law_.shear_stiffness * open / out, .length = out}, decay_);
  }

  Pasternak law_;
  double decay_;
  int per_side_;
  std::vector<LinkedTaxel> taxels_;
  std::map<std::pair<int, int>, FoundationLink> links_;
  std::vector<double>* spring_ = nullptr;
};

}  // namespace

int sideTowards(const std::array<double, 2>& place, const std::array<double, 2>& spacing) {
  constexpr double kCorner = 1e-6;  // of a spacing; nodes that lie symmetrically meet at corners, to rounding
  const std::size_t axis = std::abs(place[1]) / spacing[1] > std::abs(place[0]) / spacing[0] * (1 + kCorner) ? 1 : 0;
  return static_cast<int>(2 * axis) + (place[axis] > 0 ? 1 : 0);
}

LinkedNodes linkedNodes(const Sensor& sensor) {
  return LinkBuilder(sensor).build();
}

std::vector<std::vector<int>> blocksWithin(const Sensor& sensor, int num_parts, double reach) {
  const int per_side = sensor.samples_per_taxel * pasternakRefinement(sensor), side = per_side / num_parts,
            num_blocks = num_parts * num_parts;
  const std::vector<LinkedTaxel> taxels = linkedTaxelsOf(sensor);
  std::vector<std::vector<int>> near(taxels.size() * static_cast<std::size_t>(num_blocks));
  // Of a place in a taxel, from a block of it.
  const auto distance = [&](const LinkedTaxel& taxel, int block, const Place& place) {
    double square = 0;
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const double size = taxel.patch->pitch[axis] / num_parts, part = axis == 0 ? block / num_parts : block % num_parts;
      const double middle = (part + 0.5 - num_parts / 2.0) * size, beyond = std::max(std::abs(place[axis] - middle) - size / 2, 0.0);
      square += beyond * beyond;
    }
    return std::sqrt(square);
  };
  for (std::size_t a = 0; a < taxels.size(); ++a) {
    for (std::size_t b = 0; b < taxels.size(); ++b) {
      Chart chart = a == b ? Chart{.offset = {}, .cosine = 1, .sine = 0, .exists = true} : chartOf(taxels[a], taxels[b]);
      if (!chart.exists || std::hypot(chart.offset[0], chart.offset[1]) > halfDiagonal(taxels[a]) + halfDiagonal(taxels[b]) + reach)
        continue;
      for (int own = 0; own < num_blocks; ++own) {
        for (int other = 0; other < num_blocks; ++other) {
          const auto isNear = [&](int k) {
            const int x = other / num_parts * side + k / side, y = other % num_parts * side + k % side;
            return distance(taxels[a], own, chart(placeInTaxel(taxels[b], per_side, x, y))) <= reach;
          };
          bool is_near = false;
          for (int k = 0; k < side * side && !is_near; ++k) is_near = isNear(k);
          if (is_near)
            near[a * static_cast<std::size_t>(num_blocks) + static_cast<std::size_t>(own)].push_back(static_cast<int>(b) * num_blocks +
                                                                                                     other);
        }
      }
    }
  }
  return near;
}

double stiffnessAtRest(const FoundationLink& link, double decay) {
  return link.stiffness * (1 - std::exp(-link.length / decay));
}

}  // namespace taxelsim
