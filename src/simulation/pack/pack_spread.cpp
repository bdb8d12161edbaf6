#include "simulation/pack/pack_spread.h"

#include <algorithm>
#include <bit>
#include <glm/glm.hpp>
#include <vector>

#include "sensor/skin.h"

namespace taxelsim {
namespace {

// Rows of four numbers, the last one padded with zeros.
std::vector<glm::vec4> inRows(const std::vector<float>& numbers) {
  std::vector<glm::vec4> rows((numbers.size() + 3) / 4, glm::vec4(0));
  for (std::size_t i = 0; i < numbers.size(); ++i) rows[i / 4][static_cast<int>(i % 4)] = numbers[i];
  return rows;
}

using Sources = std::vector<std::vector<glm::vec2>>;  // (num_taxels): pairs of source (as bits) and weight

// Lists of one length, padded with the taxel itself at weight 0, then the rotations of shear along the skin where the sensor needs them.
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
  if (packed.rotates_shear) {
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

// Mean place of a taxel's sources, and the sum of what they give per newton: near a border the sources are on one side.
void packReception(const Sensor& sensor, const Sources& sources, PackedSensor& packed) {
  for (std::size_t t = 0; t < sources.size(); ++t) {
    layout::TaxelRecord& taxel = packed.taxels[t];
    glm::dvec3 place{0};
    double sum = 0;
    for (const glm::vec2& entry : sources[t]) {
      const std::uint32_t source = std::bit_cast<std::uint32_t>(entry.x);
      const double share = static_cast<double>(entry.y) * static_cast<double>(packed.spread_scale[source]);
      place += share * glm::dvec3(packed.taxels[source].chart);
      sum += share;
    }
    const double gain = sensor.readout.calibrated_gain.empty() ? 1 : sensor.readout.calibrated_gain[t];
    place = sum > 0 ? place / sum : glm::dvec3(taxel.chart);
    taxel.reception = glm::dvec4(place.x, place.y, taxel.readout.y, sum * gain);
    taxel.readout.w = static_cast<float>(place.z);
  }
}

// The spread by distance along the skin. Neighbourhood and weights are symmetric.
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
  packReception(sensor, sources, packed);
  packSources(sensor, sources, packed);
}

// Paper eq. (1): the scale of each source that conserves its force, and the sources of every taxel. One patch keeps its kernel.
void packKernelSpread(const Sensor& sensor, PackedSensor& packed) {
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
  packReception(sensor, sources, packed);
  if (packed.one_grid) {
    packed.spread_rows = inRows({sensor.psf.kernel.begin(), sensor.psf.kernel.end()});
  } else {
    packSources(sensor, sources, packed);
  }
}

}  // namespace

void packSpread(const Sensor& sensor, PackedSensor& packed) {
  sensor.psf.sigma > 0 ? packSkinSpread(sensor, packed) : packKernelSpread(sensor, packed);
}

}  // namespace taxelsim
