#include "simulation/raster.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

#include "shared/model.h"

namespace taxelsim {
namespace {

// Triangles whose root mean area is this many sample spacings are rastered row by row, smaller ones sample by sample.
constexpr double kLargeTriangle = 6;
// Small triangles need at least this many bits.
constexpr int kMinSubpixelBits = 10;
// Bits of the rounded coordinates of an object that reaches into a tile: those of a float, less those that a transform loses.
constexpr int kExtentBits = 22;

struct TriangleSizes {
  double root_mean_area, longest_edge, extent;  // m; the last along the diagonal of all
};

TriangleSizes triangleSizes(const Mesh& mesh) {
  Eigen::AlignedBox3f box;
  double twice_area = 0;
  float longest = 0;
  for (const std::array<std::uint32_t, 3>& t : mesh.triangles) {
    const Eigen::Map<const Eigen::Vector3f> a(mesh.vertices[t[0]].data()), b(mesh.vertices[t[1]].data()), c(mesh.vertices[t[2]].data());
    twice_area += static_cast<double>((b - a).cross(c - a).norm());
    longest = std::max({longest, (b - a).norm(), (c - b).norm(), (a - c).norm()});
    box.extend(a).extend(b).extend(c);
  }
  return {std::sqrt(twice_area / 2 / static_cast<double>(mesh.triangles.size())), longest, box.diagonal().norm()};
}

// Integer bits of a number of samples.
int bitsOf(double samples) {
  return std::max(0, static_cast<int>(std::ceil(std::log2(samples * (1 + 1e-3)))));
}

}  // namespace

Raster chooseRaster(const Mesh& mesh, const SampleGrid& grid) {
  const TriangleSizes sizes = triangleSizes(mesh);
  const int extent_bits = std::max(0, kExtentBits - bitsOf(sizes.extent / grid.spacing + grid.tile_side));
  const int small_bits = std::min(extent_bits, static_cast<int>(layout::kSmallEdgeBits) - bitsOf(sizes.longest_edge / grid.spacing));
  if (sizes.root_mean_area <= kLargeTriangle * grid.spacing && small_bits >= kMinSubpixelBits) return {small_bits, false};
  return {extent_bits, true};
}

}  // namespace taxelsim
