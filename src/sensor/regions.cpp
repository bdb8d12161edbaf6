#include "sensor/regions.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sensor/skin.h"

namespace taxelsim {
namespace {

constexpr double kNeighbourDistance = 1.5;  // sizes: more than the diagonal of a square grid, less than two pitches
constexpr double kSpreadRadius = 2;         // standard deviations

double sizeOf(const GridPatch& patch) {
  return std::sqrt(patch.pitch[0] * patch.pitch[1]);
}

}  // namespace

std::vector<std::vector<int>> listNeighbours(const Sensor& sensor) {
  const std::vector<Vector3> positions = taxelPositions(sensor), normals = taxelNormals(sensor);
  double largest = 0;
  for (const GridPatch& patch : sensor.patches) largest = std::max(largest, sizeOf(patch));
  // No chord is longer than its arc, so neighbours are near along x.
  std::vector<std::size_t> by_x(positions.size());
  std::iota(by_x.begin(), by_x.end(), std::size_t{0});
  std::stable_sort(by_x.begin(), by_x.end(), [&](std::size_t a, std::size_t b) { return positions[a][0] < positions[b][0]; });
  std::vector<std::vector<int>> neighbours(positions.size());
  for (std::size_t a = 0; a < by_x.size(); ++a) {
    const std::size_t i = by_x[a];
    for (std::size_t b = a + 1; b < by_x.size() && positions[by_x[b]][0] - positions[i][0] <= kNeighbourDistance * largest; ++b) {
      const std::size_t j = by_x[b];
      const double near = kNeighbourDistance * (sizeOf(sensor.patches[i]) + sizeOf(sensor.patches[j])) / 2;
      if (skinDistance(positions[i], normals[i], positions[j], normals[j]) > near) continue;
      neighbours[std::max(i, j)].push_back(static_cast<int>(std::min(i, j)));
    }
  }
  for (std::vector<int>& list : neighbours) std::sort(list.begin(), list.end());
  return neighbours;
}

SpreadShape spreadShape(const Psf& psf, const std::array<double, 2>& pitch) {
  const bool by_distance = psf.sigma > 0;
  const double reach = psf.reach > 0 ? psf.reach : 3 * psf.sigma;
  const std::array<int, 2> most = by_distance ? std::array{static_cast<int>(reach / pitch[0]), static_cast<int>(reach / pitch[1])}
                                              : std::array{psf.size / 2, psf.size / 2};
  const auto weight = [&](int a, int b) {
    if (by_distance) return skinWeight(psf, std::hypot(a * pitch[0], b * pitch[1]));
    return psf.kernel[static_cast<std::size_t>((a + most[0]) * psf.size + b + most[1])];
  };
  double sum = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;
  for (int a = -most[0]; a <= most[0]; ++a) {
    for (int b = -most[1]; b <= most[1]; ++b) {
      const double w = weight(a, b);
      sum += w, x += w * a, y += w * b, xx += w * a * a, xy += w * a * b, yy += w * b * b;
    }
  }
  x /= sum, y /= sum;
  const double variance_x = xx / sum - x * x, variance_y = yy / sum - y * y;
  SpreadShape shape;
  shape.sum = psf.normalization == Psf::Normalization::kPerSource ? 1 : sum;
  shape.moments = {variance_x * pitch[0] * pitch[0], (xy / sum - x * y) * pitch[0] * pitch[1], variance_y * pitch[1] * pitch[1]};
  const double deviation = std::sqrt(std::max({variance_x, variance_y, 0.0}));
  shape.radius = std::min(std::max(most[0], most[1]), static_cast<int>(std::ceil(kSpreadRadius * deviation)));
  return shape;
}

double meanPitch(const Sensor& sensor) {
  double area = 0;
  for (const GridPatch& patch : sensor.patches) area += patch.num_rows * patch.num_cols * patch.pitch[0] * patch.pitch[1];
  return std::sqrt(area / numTaxels(sensor));
}

int numFeaturePatches(const Sensor& sensor) {
  return isTaxelList(sensor) ? 0 : static_cast<int>(sensor.patches.size());
}

}  // namespace taxelsim
