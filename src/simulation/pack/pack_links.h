// A two-parameter foundation on several patches -> the tables that linked_foundation.comp reads.
#pragma once

#include <cstdint>
#include <vector>

#include "shared/linked_foundation.h"
#include "simulation/pack/pack_sensor.h"
#include "taxelsim/sensor.h"

namespace taxelsim {

// Nodes are numbered as the shader needs them: by taxel, block and color.
struct PackedLinks {
  std::vector<layout::FoundationNodeRecord> nodes;    // (num_nodes)
  std::vector<layout::FoundationLinkRecord> links;    // (most links of a node, in fours, x num_nodes)
  std::vector<layout::FoundationBlockRecord> blocks;  // (num_taxels x blocks_per_taxel)
  std::vector<std::uint32_t> near;                    // lists of the blocks
  std::uint32_t blocks_per_taxel = 1;
  std::uint32_t num_colors = 0;
  std::uint32_t most_of_color = 0;  // nodes of one color in a block
  std::uint32_t num_fours = 0;      // of links of a node, at most
};

// `nodes`: the sensor of the nodes, packed. The sensor's law must be Pasternak. Throws Error(kInput) for nodes with too many links.
PackedLinks packLinks(const Sensor& sensor, const PackedSensor& nodes);

}  // namespace taxelsim
