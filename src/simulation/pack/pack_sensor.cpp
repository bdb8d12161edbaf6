#include "simulation/pack/pack_sensor.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "sensor/curve.h"
#include "sensor/skin.h"
#include "shared/batch.h"
#include "simulation/pack/pack_spread.h"
#include "simulation/rows.h"

namespace taxelsim {
namespace {

constexpr double kEndless = 1e30;  // m, for a float

// Cuts a patch into near-square tiles of whole taxels, of sizes as equal as possible.
void addTiles(const GridPatch& patch, std::uint32_t patch_number, std::uint32_t max_taxels, std::vector<layout::TileRecord>& tiles) {
  const auto rows = static_cast<std::uint32_t>(patch.num_rows);
  const auto cols = static_cast<std::uint32_t>(patch.num_cols);
  std::uint32_t tile_rows = rows;
  std::uint32_t tile_cols = cols;
  if (rows * cols > max_taxels) {
    const auto side = static_cast<std::uint32_t>(std::sqrt(static_cast<double>(max_taxels)));
    tile_cols = std::min(cols, std::max(side, max_taxels / rows));
    tile_rows = std::min(rows, max_taxels / tile_cols);
  }
  const std::uint32_t down = (rows + tile_rows - 1) / tile_rows;
  const std::uint32_t across = (cols + tile_cols - 1) / tile_cols;
  for (std::uint32_t i = 0; i < down; ++i) {
    for (std::uint32_t j = 0; j < across; ++j) {
      const std::uint32_t row0 = rows * i / down;
      const std::uint32_t col0 = cols * j / across;
      tiles.push_back({{patch_number, row0, col0, 0u}, {rows * (i + 1) / down - row0, cols * (j + 1) / across - col0, 0u, 0u}});
    }
  }
}

void packTaxels(const Sensor& sensor, bool one_patch, std::vector<layout::TaxelRecord>& taxels) {
  const std::vector<Vector3> positions = taxelPositions(sensor);
  const Pose X_CS = one_patch ? inverse(sensor.patches.front().X_SP) : Pose{};
  std::size_t taxel = 0;
  float patch_number = 0;
  for (const GridPatch& patch : sensor.patches) {
    const double area = patch.pitch[0] * patch.pitch[1];
    for (int k = 0; k < patch.num_rows * patch.num_cols; ++k, ++taxel) {
      const Vector3 p = X_CS * positions[taxel];
      const double gain = sensor.readout.taxel_gain.empty() ? 1 : sensor.readout.taxel_gain[taxel];
      const double trigger = sensor.readout.taxel_trigger.empty() ? sensor.readout.trigger : sensor.readout.taxel_trigger[taxel];
      taxels.push_back({{static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2]), static_cast<float>(area)},
                        {static_cast<float>(gain), static_cast<float>(trigger), patch_number, 0.0f},
                        {0.0f, 0.0f, 0.0f, 1.0f}});
    }
    ++patch_number;
  }
}

static_assert(layout::kMaxDelaySteps == kMaxDelaySteps && layout::kMaxCurvePieces == kMaxCurvePoints);

// States per taxel and parameters of stage 4.
void packLag(const Readout& readout, PackedSensor& packed) {
  for (std::size_t e = 0; e < readout.hysteresis_strength.size(); ++e) {
    packed.sensor.hysteresis_strength[static_cast<int>(e)] = static_cast<float>(readout.hysteresis_strength[e]);
    packed.sensor.hysteresis_width[static_cast<int>(e)] = static_cast<float>(readout.hysteresis_width[e]);
  }
  for (std::size_t m = 0; m < readout.creep.size(); ++m) {
    packed.sensor.creep_fraction[static_cast<int>(m)] = static_cast<float>(readout.creep[m].fraction);
  }
  const std::size_t num_states = readout.hysteresis_strength.size() + readout.creep.size() + (readout.low_pass_time > 0 ? 1 : 0) +
                                 (readout.random_walk > 0 ? 1 : 0) + (readout.delay > 0 ? layout::kMaxDelaySteps : 0);
  packed.num_states = static_cast<std::uint32_t>(num_states);
}

// Patches, and how high and low their corners lie in S.
void packPatches(const Sensor& sensor, PackedSensor& packed) {
  const std::vector<double> view_depths = viewDepths(sensor);
  std::uint32_t first_taxel = 0;
  double highest = -std::numeric_limits<double>::infinity();
  double lowest = -highest;
  for (const GridPatch& patch : sensor.patches) {
    const Pose X_PS = inverse(patch.X_SP);
    const std::array<double, 9> rotation = rotationMatrix(X_PS.rotation);
    const double dx = patch.pitch[0] / sensor.samples_per_taxel;
    const double dy = patch.pitch[1] / sensor.samples_per_taxel;
    packed.patches.push_back({row(rotation, X_PS.position, 0),
                              row(rotation, X_PS.position, 1),
                              row(rotation, X_PS.position, 2),
                              {static_cast<std::uint32_t>(patch.num_rows), static_cast<std::uint32_t>(patch.num_cols), first_taxel, 0u},
                              {static_cast<float>(dx), static_cast<float>(dy), static_cast<float>(dx * dy),
                               static_cast<float>(std::min(view_depths[packed.patches.size()], kEndless))}});
    first_taxel += static_cast<std::uint32_t>(patch.num_rows * patch.num_cols);
    for (const double sx : {-0.5, 0.5}) {
      for (const double sy : {-0.5, 0.5}) {
        const double z = (patch.X_SP * Vector3{sx * patch.num_rows * patch.pitch[0], sy * patch.num_cols * patch.pitch[1], 0})[2];
        highest = std::max(highest, z);
        lowest = std::min(lowest, z);
      }
    }
  }
  packed.highest = static_cast<float>(highest);
  packed.lowest = static_cast<float>(lowest);
}

// Tiles of all patches, and the partial sums of passes, which follow from the sensor alone so that no other choice changes a sum.
void packTiles(const Sensor& sensor, std::uint32_t tile_samples, PackedSensor& packed) {
  const auto num_taxels = static_cast<std::uint32_t>(numTaxels(sensor));
  const auto per_side = static_cast<std::uint32_t>(sensor.samples_per_taxel);
  const std::uint32_t per_taxel = per_side * per_side;
  std::uint32_t patch_number = 0;
  for (const GridPatch& patch : sensor.patches) addTiles(patch, patch_number++, std::max(1u, tile_samples / per_taxel), packed.tiles);
  for (const layout::TileRecord& tile : packed.tiles) {
    packed.max_tile_samples = std::max(packed.max_tile_samples, tile.size.x * tile.size.y * per_taxel);
  }
  // A lane sums some sixteen taxels: enough work for a lane, and enough lanes for a large sensor.
  constexpr std::uint32_t kTaxelsPerLane = 16, kMinLanes = 8, kMaxLanes = 64;
  const std::uint32_t max_taxels = packed.one_patch ? num_taxels : packed.max_tile_samples / per_taxel;
  packed.contact_lanes = std::clamp(std::bit_ceil(max_taxels / kTaxelsPerLane), kMinLanes, kMaxLanes);
  const std::uint32_t rows = packed.one_grid ? static_cast<std::uint32_t>(sensor.patches.front().num_rows)
                                             : (num_taxels + layout::kListCols - 1) / layout::kListCols;
  packed.image_lanes = std::min(std::bit_ceil(rows), kMaxLanes);
}

void packCurve(const Readout& readout, layout::SensorRecord& record) {
  for (std::size_t m = 0; m < readout.curve.size(); ++m) {
    (m < 4 ? record.curve0[static_cast<int>(m)] : record.curve1.x) = static_cast<float>(readout.curve[m]);
  }
  const double most = withoutLimit(readout.saturation / readout.output_scale, readout.curve_limit);
  record.curve1.y = static_cast<float>(std::min<double>(curveTop(readout.curve, most), std::numeric_limits<float>::max()));
  CurvePoint begin;
  for (std::size_t k = 0; k < readout.curve_points.size(); ++k) {
    const CurvePoint& end = readout.curve_points[k];
    const double slope = (end.counts - begin.counts) / (end.force - begin.force);
    record.curve_pieces[k] = glm::dvec4(begin.force, begin.counts, slope, 1 / slope);
    begin = end;
  }
}

// The frame of moments.
void packChart(const Pose& X_SC, layout::SensorRecord& record) {
  const std::array<double, 9> rotation = rotationMatrix(X_SC.rotation);
  record.X_SC_row0 = row(rotation, X_SC.position, 0);
  record.X_SC_row1 = row(rotation, X_SC.position, 1);
  record.X_SC_row2 = row(rotation, X_SC.position, 2);
}

}  // namespace

PackedSensor packSensor(const Sensor& sensor, std::uint32_t tile_samples) {
  PackedSensor packed;
  packed.one_patch = sensor.patches.size() == 1;
  packed.one_grid = packed.one_patch && sensor.psf.sigma == 0;
  packed.rotates_shear = sensor.psf.sigma > 0 && hasFriction(sensor.skin);
  packed.flat = packed.one_patch && sensor.patches.front().X_SP == Pose{};
  packPatches(sensor, packed);
  packTiles(sensor, tile_samples, packed);
  packed.searches_in_tile = packed.tiles.size() == 1 && packed.patches.front().row2.z == 1.0f &&
                            (sensor.depth_sampling == DepthSampling::kPoint || std::holds_alternative<ElasticLayer>(sensor.skin.law));
  packTaxels(sensor, packed.one_patch, packed.taxels);
  packSpread(sensor, packed);
  packLag(sensor.readout, packed);
  packCurve(sensor.readout, packed.sensor);
  packChart(packed.one_patch ? sensor.patches.front().X_SP : Pose{}, packed.sensor);
  return packed;
}

}  // namespace taxelsim
