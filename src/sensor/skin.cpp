#include "sensor/skin.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>

#include "base/text.h"
#include "base/vector3.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

// Tolerance: the reach is often a whole number of pitches, and rounding must not exclude the taxels there.
constexpr double kReachRounding = 1e-9;

double reachOf(const Psf& psf) {
  return (psf.reach > 0 ? psf.reach : 3 * psf.sigma) * (1 + kReachRounding);
}

[[noreturn]] void failReach(const Psf& psf, int taxel) {
  throw Error("psf.reach", numberText(psf.reach > 0 ? psf.reach : 3 * psf.sigma) + " is not allowed: m, within which taxel " +
                               std::to_string(taxel) + " finds at most " + std::to_string(kMaxSpreadTaxels) + " taxels");
}

}  // namespace

double skinDistance(const Vector3& p, const Vector3& n, const Vector3& q, const Vector3& m) {
  const Vector3 chord = subtract(p, q);
  const double square = dot(chord, chord);
  const Vector3 turn = cross(n, m);
  const double sine = length(turn);
  const double angle = std::atan2(sine, dot(n, m));
  if (sine == 0) return std::sqrt(square);
  const double along = dot(chord, turn) / sine;
  const double bent = angle / 2 / std::sin(angle / 2);
  return std::sqrt(along * along + std::max(square - along * along, 0.0) * bent * bent);
}

bool isLevel(const Sensor& sensor) {
  return std::all_of(sensor.patches.begin(), sensor.patches.end(), [](const GridPatch& patch) {
    return rotate(patch.X_SP.rotation, {0, 0, 1})[2] == 1;
  });
}

double skinWeight(const Psf& psf, double distance) {
  return distance <= reachOf(psf) ? std::exp(-distance * distance / (2 * psf.sigma * psf.sigma)) : 0;
}

std::vector<std::vector<SkinNeighbour>> skinNeighbours(const Sensor& sensor) {
  const std::vector<Vector3> positions = taxelPositions(sensor), normals = taxelNormals(sensor);
  const double reach = reachOf(sensor.psf);
  std::vector<std::vector<SkinNeighbour>> neighbours(positions.size());
  const auto add = [&](std::size_t i, std::size_t j, double weight) {
    if (neighbours[i].size() == kMaxSpreadTaxels) failReach(sensor.psf, static_cast<int>(i));
    neighbours[i].push_back({static_cast<int>(j), weight});
  };
  // No chord is longer than its arc, so neighbours are near along x.
  std::vector<std::size_t> by_x(positions.size());
  std::iota(by_x.begin(), by_x.end(), std::size_t{0});
  std::stable_sort(by_x.begin(), by_x.end(), [&](std::size_t a, std::size_t b) { return positions[a][0] < positions[b][0]; });
  for (std::size_t a = 0; a < by_x.size(); ++a) {
    const std::size_t i = by_x[a];
    add(i, i, 1);
    for (std::size_t b = a + 1; b < by_x.size() && positions[by_x[b]][0] - positions[i][0] <= reach; ++b) {
      const std::size_t j = by_x[b];
      const Vector3 chord = subtract(positions[i], positions[j]);
      if (dot(chord, chord) > reach * reach) continue;
      const double weight = skinWeight(sensor.psf, skinDistance(positions[i], normals[i], positions[j], normals[j]));
      if (weight == 0) continue;
      add(i, j, weight);
      add(j, i, weight);
    }
  }
  for (std::vector<SkinNeighbour>& list : neighbours) {
    std::sort(list.begin(), list.end(), [](const SkinNeighbour& a, const SkinNeighbour& b) { return a.taxel < b.taxel; });
  }
  return neighbours;
}

std::array<double, 2> turnAlongSkin(const Quaternion& R_SP, const Quaternion& R_SQ) {
  constexpr double kOpposite = 1e-9;  // of 1 + cosine
  const Vector3 n = rotate(R_SP, {0, 0, 1}), m = rotate(R_SQ, {0, 0, 1}), x = rotate(R_SP, {1, 0, 0});
  const double opening = 1 + dot(n, m);
  if (opening < kOpposite) return {1, 0};
  const Vector3 turned = subtract(x, scale(dot(x, m) / opening, add(n, m)));
  return {dot(turned, rotate(R_SQ, {1, 0, 0})), dot(turned, rotate(R_SQ, {0, 1, 0}))};
}

std::vector<double> viewDepths(const Sensor& sensor) {
  struct Part {
    Vector3 normal;
    std::size_t first, end;  // taxels
  };
  const std::vector<Vector3> positions = taxelPositions(sensor);
  std::vector<Part> parts;
  std::size_t first = 0;
  for (const GridPatch& patch : sensor.patches) {
    const std::size_t end = first + static_cast<std::size_t>(patch.num_rows * patch.num_cols);
    parts.push_back({rotate(patch.X_SP.rotation, {0, 0, 1}), first, end});
    first = end;
  }
  std::vector<double> depths;
  for (const Part& near : parts) {
    double depth = std::numeric_limits<double>::infinity();
    for (const Part& far : parts) {
      if (dot(near.normal, far.normal) >= 0) continue;
      for (std::size_t p = near.first; p < near.end; ++p) {
        for (std::size_t q = far.first; q < far.end; ++q) {
          const Vector3 chord = subtract(positions[p], positions[q]);
          const double under = dot(near.normal, chord);
          if (under > 0) depth = std::min(depth, dot(chord, chord) / (2 * under));
        }
      }
    }
    depths.push_back(std::max(depth, sensor.skin.thickness));
  }
  return depths;
}

}  // namespace taxelsim
