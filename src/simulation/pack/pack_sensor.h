// A sensor -> the records that the passes read, and the tiles of its taxels.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "shared/model.h"
#include "taxelsim/sensor.h"

namespace taxelsim {

struct PackedSensor {
  layout::SensorRecord sensor{};
  std::vector<layout::PatchRecord> patches;
  std::vector<layout::TileRecord> tiles;
  std::vector<layout::TaxelRecord> taxels;
  // The kernel of one patch, or pairs (num_entries x num_taxels) of source (as bits) and weight; where shear turns, then as many pairs of
  // cosine and sine (turnAlongSkin()).
  std::vector<glm::vec4> spread_rows;
  std::uint32_t num_entries = 0;       // per taxel
  std::vector<float> spread_scale;     // (num_taxels): what a source gives to the spread per newton
  std::uint32_t max_tile_samples = 0;  // of any tile
  std::uint32_t contact_lanes = 0;     // partial sums of the contact pass; a function of the sensor alone
  std::uint32_t image_lanes = 0;       // and of the image pass
  std::uint32_t num_states = 0;        // of stage 4 per taxel, shaders/readout/lag.glsl
  bool one_patch = false;
  bool one_grid = false;          // one patch whose spread is a kernel
  bool rotates_shear = false;     // spread by distance, of a skin with friction
  bool flat = false;              // the one patch's frame is the sensor's
  float highest = 0, lowest = 0;  // z in S of the corners of patches, m
  // One tile that faces along z of S, with point sampling: a load search moves its heights instead of its objects.
  bool searches_in_tile = false;

  // Whether some source near a border gives more to the taxels inside.
  bool scalesSpread() const {
    return std::any_of(spread_scale.begin(), spread_scale.end(), [](float scale) { return scale != 1; });
  }
};

// `tile_samples`: most samples that a tile may have.
PackedSensor packSensor(const Sensor& sensor, std::uint32_t tile_samples);

}  // namespace taxelsim
