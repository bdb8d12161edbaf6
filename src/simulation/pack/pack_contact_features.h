// A sensor -> what the passes of contact features read.
#pragma once

#include <cstdint>
#include <vector>

#include "shared/model.h"
#include "taxelsim/sensor.h"

namespace taxelsim {

struct PackedContactFeatures {
  std::vector<layout::PlaneRecord> planes;  // of every patch, then the xy plane of S
  std::vector<std::uint32_t> neighbours;    // (num_neighbours x num_taxels), with lower numbers; padded with the taxel itself
  std::uint32_t num_neighbours = 0;         // at least 1 for a list of taxels, else 0
  std::uint32_t num_patches = 0;            // that have rows of features
  std::uint32_t lanes = 0;                  // partial sums; depends on the sensor alone
  std::uint32_t force_steps = 0;            // steps of the largest force, in sums of regions
  double stiffness = 0, exponent = 1;       // d pressure / d depth = stiffness pressure^(1 - 1 / exponent)
};

PackedContactFeatures packContactFeatures(const Sensor& sensor);

// Rows of contact features of an instance.
std::uint32_t numContactRows(const PackedContactFeatures& packed, int max_regions);

}  // namespace taxelsim
