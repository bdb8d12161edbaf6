#include "simulation/pack/pack_contact_features.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "sensor/regions.h"
#include "simulation/rows.h"

namespace taxelsim {
namespace {

layout::PlaneRecord plane(const Pose& X_SC, const std::array<double, 2>& pitch, double force_per_pressure,
                          const std::array<double, 3>& blur) {
  const std::array<double, 9> rotation = rotationMatrix(X_SC.rotation);
  const auto number = [](double value) { return static_cast<float>(value); };
  return {row(rotation, X_SC.position, 0),
          row(rotation, X_SC.position, 1),
          row(rotation, X_SC.position, 2),
          {0u, 0u, 0u, 0u},
          {number(pitch[0]), number(pitch[1]), number(std::max(pitch[0], pitch[1])), number(force_per_pressure)},
          {number(blur[0]), number(blur[1]), number(blur[2]), 0.0f}};
}

layout::PlaneRecord planeOfPatch(const Sensor& sensor, const GridPatch& patch, std::uint32_t first_taxel) {
  const auto& [px, py] = patch.pitch;
  const SpreadShape spread = spreadShape(sensor.psf, patch.pitch);
  const auto& [xx, xy, yy] = spread.moments;
  layout::PlaneRecord record = plane(patch.X_SP, patch.pitch, px * py * spread.sum, {xx + px * px / 12, xy, yy + py * py / 12});
  record.grid = {static_cast<std::uint32_t>(patch.num_rows), static_cast<std::uint32_t>(patch.num_cols), first_taxel,
                 static_cast<std::uint32_t>(spread.radius) + 1};
  return record;
}

// A plane that holds taxels of several patches or of a list.
layout::PlaneRecord planeOfMany(const Sensor& sensor, const Pose& X_SC) {
  const double pitch = meanPitch(sensor);
  const SpreadShape spread = spreadShape(sensor.psf, {pitch, pitch});
  const double blur = (spread.moments[0] + spread.moments[2]) / 2 + pitch * pitch / 12;
  return plane(X_SC, {pitch, pitch}, pitch * pitch * spread.sum, {blur, 0, blur});
}

void packNeighbours(const Sensor& sensor, PackedContactFeatures& packed) {
  const std::vector<std::vector<int>> lists = listNeighbours(sensor);
  packed.num_neighbours = 1;
  for (const std::vector<int>& list : lists) {
    packed.num_neighbours = std::max(packed.num_neighbours, static_cast<std::uint32_t>(list.size()));
  }
  for (std::size_t e = 0; e < packed.num_neighbours; ++e) {
    for (std::size_t t = 0; t < lists.size(); ++t) {
      packed.neighbours.push_back(static_cast<std::uint32_t>(e < lists[t].size() ? static_cast<std::size_t>(lists[t][e]) : t));
    }
  }
}

}  // namespace

PackedContactFeatures packContactFeatures(const Sensor& sensor) {
  PackedContactFeatures packed;
  const bool is_list = isTaxelList(sensor);
  std::uint32_t first_taxel = 0;
  for (const GridPatch& patch : sensor.patches) {
    packed.planes.push_back(is_list ? planeOfMany(sensor, patch.X_SP) : planeOfPatch(sensor, patch, first_taxel));
    first_taxel += static_cast<std::uint32_t>(patch.num_rows * patch.num_cols);
  }
  packed.planes.push_back(planeOfMany(sensor, {}));
  if (is_list) {
    packNeighbours(sensor, packed);
  } else {
    packed.neighbours = {0};
  }
  packed.num_patches = static_cast<std::uint32_t>(numFeaturePatches(sensor));
  constexpr std::uint32_t kTaxelsPerLane = 16, kFewest = 8, kMost = 64;
  packed.lanes = std::clamp(std::bit_ceil(first_taxel / kTaxelsPerLane), kFewest, kMost);
  constexpr int kSumBits = 30;
  packed.force_steps = 1u << (kSumBits - std::bit_width(first_taxel));
  const Winkler foundation = foundationOf(sensor.skin);
  packed.exponent = foundation.normal_exponent;
  packed.stiffness = packed.exponent * std::pow(foundation.normal_contact_stiffness, 1 / packed.exponent);
  return packed;
}

std::uint32_t numContactRows(const PackedContactFeatures& packed, int max_regions) {
  return 1 + packed.num_patches + static_cast<std::uint32_t>(max_regions);
}

}  // namespace taxelsim
