#include "simulation/pack/pack_contact_features.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "sensor/regions.h"
#include "simulation/rows.h"

namespace taxelsim {
namespace {

// Second moments of a grid under even pressure, m^2.
std::array<double, 3> evenMoments(const GridPatch& patch) {
  const auto along = [](int count, double pitch) { return (count * count - 1) * pitch * pitch / 12; };
  return {along(patch.num_rows, patch.pitch[0]), 0, along(patch.num_cols, patch.pitch[1])};
}

// The same of all taxels of a sensor, in the xy plane of C.
std::array<double, 3> evenMoments(const Sensor& sensor, const Pose& X_SC) {
  const Pose X_CS = inverse(X_SC);
  double area = 0;
  std::array<double, 2> first{0, 0};
  std::array<double, 3> second{0, 0, 0};
  for (const GridPatch& patch : sensor.patches) {
    const Pose X_CP = X_CS * patch.X_SP;
    const double patch_area = patch.pitch[0] * patch.pitch[1] * patch.num_rows * patch.num_cols;
    const auto& [x, y, z] = X_CP.position;
    const std::array<double, 9> R_CP = rotationMatrix(X_CP.rotation);
    const std::array<double, 3> own = evenMoments(patch);
    area += patch_area;
    first = {first[0] + patch_area * x, first[1] + patch_area * y};
    const auto rotated = [&](std::size_t a, std::size_t b) {
      return R_CP[3 * a] * R_CP[3 * b] * own[0] + R_CP[3 * a + 1] * R_CP[3 * b + 1] * own[2];
    };
    second[0] += patch_area * (rotated(0, 0) + x * x);
    second[1] += patch_area * (rotated(0, 1) + x * y);
    second[2] += patch_area * (rotated(1, 1) + y * y);
  }
  const double x = first[0] / area, y = first[1] / area;
  return {second[0] / area - x * x, second[1] / area - x * y, second[2] / area - y * y};
}

layout::PlaneRecord plane(const Pose& X_SC, const std::array<double, 2>& pitch, double force_per_pressure,
                          const std::array<double, 3>& blur, const std::array<double, 3>& even) {
  const std::array<double, 9> rotation = rotationMatrix(X_SC.rotation);
  const auto number = [](double value) { return static_cast<float>(value); };
  return {row(rotation, X_SC.position, 0),
          row(rotation, X_SC.position, 1),
          row(rotation, X_SC.position, 2),
          {0u, 0u, 0u, 0u},
          {number(pitch[0]), number(pitch[1]), number(std::max(pitch[0], pitch[1])), number(force_per_pressure)},
          {number(blur[0]), number(blur[1]), number(blur[2]), 0.0f},
          {number(even[0]), number(even[1]), number(even[2]), 0.0f}};
}

layout::PlaneRecord planeOfPatch(const Sensor& sensor, const GridPatch& patch, std::uint32_t first_taxel) {
  const auto& [px, py] = patch.pitch;
  const SpreadShape spread = spreadShape(sensor.psf, patch.pitch);
  const auto& [xx, xy, yy] = spread.moments;
  layout::PlaneRecord record =
      plane(patch.X_SP, patch.pitch, px * py * spread.sum, {xx + px * px / 12, xy, yy + py * py / 12}, evenMoments(patch));
  record.grid = {static_cast<std::uint32_t>(patch.num_rows), static_cast<std::uint32_t>(patch.num_cols), first_taxel,
                 static_cast<std::uint32_t>(spread.radius) + 1};
  return record;
}

// A plane that holds taxels of several patches or of a list.
layout::PlaneRecord planeOfMany(const Sensor& sensor, const Pose& X_SC) {
  const double pitch = meanPitch(sensor);
  const SpreadShape spread = spreadShape(sensor.psf, {pitch, pitch});
  const double blur = (spread.moments[0] + spread.moments[2]) / 2 + pitch * pitch / 12;
  return plane(X_SC, {pitch, pitch}, pitch * pitch * spread.sum, {blur, 0, blur}, evenMoments(sensor, X_SC));
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
