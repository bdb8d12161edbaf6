#include "simulation/pack/pack_sensor.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "sensor/skin.h"
#include "shared/batch.h"
#include "simulation/rows.h"

namespace taxelsim {
namespace {

constexpr double kEndless = 1e30;  // m, for a float

// Cuts a patch into near-square tiles of whole taxels, as even as they come.
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

// Rows of four numbers, the last one filled up with zeros.
std::vector<glm::vec4> inRows(const std::vector<float>& numbers) {
  std::vector<glm::vec4> rows((numbers.size() + 3) / 4, glm::vec4(0));
  for (std::size_t i = 0; i < numbers.size(); ++i) rows[i / 4][static_cast<int>(i % 4)] = numbers[i];
  return rows;
}

using Sources = std::vector<std::vector<glm::vec2>>;  // (num_taxels): pairs of source (as bits) and weight

// Lists of one length, filled up with the taxel itself at weight 0; after them, of a sensor whose shear turns along the skin, the turns.
void packSources(const Sensor& sensor, const Sources& sources, PackedSensor& packed) {
  for (const std::vector<glm::vec2>& list : sources)
    packed.num_entries = std::max(packed.num_entries, static_cast<std::uint32_t>(list.size()));
  std::vector<float> pairs;
  for (std::size_t e = 0; e < packed.num_entries; ++e) {
    for (std::size_t t = 0; t < sources.size(); ++t) {
      const glm::vec2 entry = e < sources[t].size() ? sources[t][e] : glm::vec2(std::bit_cast<float>(static_cast<std::uint32_t>(t)), 0);
      pairs.push_back(entry.x);
      pairs.push_back(entry.y);
    }
  }
  if (packed.turns_shear) {
    std::vector<const Quaternion*> R_SP;
    for (const GridPatch& patch : sensor.patches) {
      R_SP.insert(R_SP.end(), static_cast<std::size_t>(patch.num_rows * patch.num_cols), &patch.X_SP.rotation);
    }
    for (std::size_t e = 0; e < packed.num_entries; ++e) {
      for (std::size_t t = 0; t < sources.size(); ++t) {
        const std::size_t source = e < sources[t].size() ? std::bit_cast<std::uint32_t>(sources[t][e].x) : t;
        for (const double part : turnAlongSkin(*R_SP[source], *R_SP[t])) pairs.push_back(static_cast<float>(part));
      }
    }
  }
  packed.spread_rows = inRows(pairs);
}

// The spread by distance along the skin; neighbours are so mutually, and weigh as much either way.
void packSkinSpread(const Sensor& sensor, PackedSensor& packed) {
  Sources sources;
  for (const std::vector<SkinNeighbour>& neighbours : skinNeighbours(sensor)) {
    std::vector<glm::vec2>& list = sources.emplace_back();
    double arriving = 0;
    for (const SkinNeighbour& neighbour : neighbours) {
      arriving += neighbour.weight;
      list.emplace_back(std::bit_cast<float>(neighbour.taxel), static_cast<float>(neighbour.weight));
    }
    const bool per_source = sensor.psf.normalization == Psf::Normalization::kPerSource;
    packed.spread_scale.push_back(per_source ? static_cast<float>(1 / arriving) : 1.0f);
  }
  packSources(sensor, sources, packed);
}

// Paper eq. (1): what each source gives, per newton, so that it arrives whole; and for every taxel its sources. One patch keeps its kernel
// as it is.
void packSpread(const Sensor& sensor, PackedSensor& packed) {
  const int radius = sensor.psf.size / 2;
  const auto kernel = [&](int a, int b) {
    return sensor.psf.kernel[static_cast<std::size_t>((a + radius) * sensor.psf.size + b + radius)];
  };
  const auto num_taxels = static_cast<std::size_t>(numTaxels(sensor));
  Sources sources(num_taxels);
  packed.spread_scale.assign(num_taxels, 1.0f);
  int first = 0;
  for (const GridPatch& patch : sensor.patches) {
    for (int i = 0; i < patch.num_rows; ++i) {
      for (int j = 0; j < patch.num_cols; ++j) {
        const int source = first + i * patch.num_cols + j;
        double arriving = 0;
        for (int a = std::max(-radius, -i); a <= std::min(radius, patch.num_rows - 1 - i); ++a) {
          for (int b = std::max(-radius, -j); b <= std::min(radius, patch.num_cols - 1 - j); ++b) {
            if (kernel(a, b) == 0) continue;
            arriving += kernel(a, b);
            sources[static_cast<std::size_t>(source + a * patch.num_cols + b)].emplace_back(std::bit_cast<float>(source),
                                                                                            static_cast<float>(kernel(a, b)));
          }
        }
        if (sensor.psf.normalization == Psf::Normalization::kPerSource) {
          packed.spread_scale[static_cast<std::size_t>(source)] = arriving > 0 ? static_cast<float>(1 / arriving) : 0.0f;
        }
      }
    }
    first += patch.num_rows * patch.num_cols;
  }
  if (packed.one_grid) {
    packed.spread_rows = inRows({sensor.psf.kernel.begin(), sensor.psf.kernel.end()});
  } else {
    packSources(sensor, sources, packed);
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
                        {static_cast<float>(gain), static_cast<float>(trigger), patch_number, 0.0f}});
    }
    ++patch_number;
  }
}

static_assert(layout::kMaxDelaySteps == kMaxDelaySteps && layout::kMaxCurvePieces == kMaxCurvePoints);

// What stage 4 keeps per taxel, and its parameters.
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

}  // namespace

PackedSensor packSensor(const Sensor& sensor, std::uint32_t tile_samples) {
  PackedSensor packed;
  const auto samples = static_cast<std::uint32_t>(sensor.samples_per_taxel);
  const auto num_taxels = static_cast<std::uint32_t>(numTaxels(sensor));
  packed.one_patch = sensor.patches.size() == 1;
  packed.one_grid = packed.one_patch && sensor.psf.sigma == 0;
  packed.turns_shear = sensor.psf.sigma > 0 && hasFriction(sensor.skin);
  const std::vector<double> view_depths = viewDepths(sensor);
  std::uint32_t first_taxel = 0;
  double highest = -std::numeric_limits<double>::infinity();
  double lowest = -highest;
  for (const GridPatch& patch : sensor.patches) {
    const Pose X_PS = inverse(patch.X_SP);
    const std::array<double, 9> rotation = rotationMatrix(X_PS.rotation);
    const double dx = patch.pitch[0] / samples;
    const double dy = patch.pitch[1] / samples;
    packed.patches.push_back({row(rotation, X_PS.position, 0),
                              row(rotation, X_PS.position, 1),
                              row(rotation, X_PS.position, 2),
                              {static_cast<std::uint32_t>(patch.num_rows), static_cast<std::uint32_t>(patch.num_cols), first_taxel, 0u},
                              {static_cast<float>(dx), static_cast<float>(dy), static_cast<float>(dx * dy),
                               static_cast<float>(std::min(view_depths[packed.patches.size()], kEndless))}});
    addTiles(patch, static_cast<std::uint32_t>(packed.patches.size()) - 1, std::max(1u, tile_samples / (samples * samples)), packed.tiles);
    first_taxel += static_cast<std::uint32_t>(patch.num_rows * patch.num_cols);
    for (const double sx : {-0.5, 0.5}) {
      for (const double sy : {-0.5, 0.5}) {
        const double z = (patch.X_SP * Vector3{sx * patch.num_rows * patch.pitch[0], sy * patch.num_cols * patch.pitch[1], 0})[2];
        highest = std::max(highest, z);
        lowest = std::min(lowest, z);
      }
    }
  }
  for (const layout::TileRecord& tile : packed.tiles) {
    packed.max_tile_samples = std::max(packed.max_tile_samples, tile.size.x * tile.size.y * samples * samples);
  }
  // Some sixteen taxels a lane, so that a lane has work and a large sensor's lanes are many.
  constexpr std::uint32_t kTaxelsPerLane = 16;
  constexpr std::uint32_t kMaxLanes = 64;
  const std::uint32_t most_taxels = packed.one_patch ? num_taxels : packed.max_tile_samples / (samples * samples);
  packed.contact_lanes = std::clamp(std::bit_ceil(most_taxels / kTaxelsPerLane), 8u, kMaxLanes);
  const std::uint32_t rows = packed.one_grid ? static_cast<std::uint32_t>(sensor.patches.front().num_rows)
                                             : (num_taxels + layout::kListCols - 1) / layout::kListCols;
  packed.image_lanes = std::min(std::bit_ceil(rows), kMaxLanes);
  packed.flat = packed.one_patch && sensor.patches.front().X_SP == Pose{};
  packed.searches_in_tile = packed.tiles.size() == 1 && packed.patches.front().row2.z == 1.0f;
  packTaxels(sensor, packed.one_patch, packed.taxels);

  sensor.psf.sigma > 0 ? packSkinSpread(sensor, packed) : packSpread(sensor, packed);
  packLag(sensor.readout, packed);

  layout::SensorRecord& record = packed.sensor;
  const Readout& readout = sensor.readout;
  for (std::size_t m = 0; m < readout.curve.size(); ++m) {
    (m < 4 ? record.curve0[static_cast<int>(m)] : record.curve1.x) = static_cast<float>(readout.curve[m]);
  }
  CurvePoint begin;
  for (std::size_t k = 0; k < readout.curve_points.size(); ++k) {
    const CurvePoint& end = readout.curve_points[k];
    const double slope = (end.counts - begin.counts) / (end.force - begin.force);
    record.curve_pieces[k] = glm::dvec4(begin.force, begin.counts, slope, 1 / slope);
    begin = end;
  }
  const Pose X_SC = packed.one_patch ? sensor.patches.front().X_SP : Pose{};
  const std::array<double, 9> rotation = rotationMatrix(X_SC.rotation);
  record.X_SC_row0 = row(rotation, X_SC.position, 0);
  record.X_SC_row1 = row(rotation, X_SC.position, 1);
  record.X_SC_row2 = row(rotation, X_SC.position, 2);
  packed.highest = static_cast<float>(highest);
  packed.lowest = static_cast<float>(lowest);
  return packed;
}

}  // namespace taxelsim
