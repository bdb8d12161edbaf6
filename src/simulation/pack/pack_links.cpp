#include "simulation/pack/pack_links.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <string>

#include "sensor/foundation_links.h"
#include "sensor/pasternak.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

constexpr double kMarginDecays = 1;  // around blocks with an overlap that move, at least: errors of 7e-4 of the force

std::uint32_t wordOf(double number) {
  return std::bit_cast<std::uint32_t>(static_cast<float>(number));
}

// A color per node, different from those of its links: along the links from node to node, so that a grid has two.
std::vector<std::uint32_t> colorsOf(const LinkedNodes& nodes) {
  constexpr std::uint32_t kNone = ~0u;
  std::vector<std::uint32_t> colors(nodes.links.size(), kNone);
  std::vector<bool> is_listed(nodes.links.size(), false);
  std::vector<std::size_t> list;
  for (std::size_t start = 0; start < nodes.links.size(); ++start) {
    if (is_listed[start]) continue;
    is_listed[start] = true;
    list.push_back(start);
    for (std::size_t next = list.size() - 1; next < list.size(); ++next) {
      std::uint32_t taken = 0;
      for (const FoundationLink& link : nodes.links[list[next]]) {
        const auto other = static_cast<std::size_t>(link.node);
        if (colors[other] != kNone) taken |= 1u << colors[other];
        if (!is_listed[other]) list.push_back(other);
        is_listed[other] = true;
      }
      colors[list[next]] = static_cast<std::uint32_t>(std::countr_one(taken));
      if (colors[list[next]] >= layout::kMaxNodeColors)
        throw Error(ErrorKind::kInput, "patches: overlap so much that nodes of the law pasternak need more than " +
                                           std::to_string(layout::kMaxNodeColors) + " colors, which is not allowed");
    }
  }
  return colors;
}

// Where the nodes of the foundation lie in the heights of the contact pass.
class NodePlaces {
 public:
  NodePlaces(const Sensor& sensor, const PackedSensor& nodes, std::uint32_t per_side) {
    std::vector<std::uint32_t> first_tile(nodes.patches.size() + 1, 0);
    for (const layout::TileRecord& tile : nodes.tiles) ++first_tile[tile.place.x + 1];
    for (std::size_t p = 0; p < nodes.patches.size(); ++p) first_tile[p + 1] += first_tile[p];
    std::uint32_t number = 0;
    for (const GridPatch& patch : sensor.patches) {
      for (int k = 0; k < patch.num_rows * patch.num_cols; ++k) {
        const auto row = static_cast<std::uint32_t>(k / patch.num_cols), col = static_cast<std::uint32_t>(k % patch.num_cols);
        taxels_.push_back({number, row * per_side, col * per_side, first_tile[number], first_tile[number + 1]});
      }
      ++number;
    }
    nodes_ = &nodes;
  }

  std::uint32_t tileAt(std::size_t taxel, std::uint32_t a, std::uint32_t b) const {
    const Taxel& in = taxels_[taxel];
    for (std::uint32_t t = in.first_tile; t < in.end_tile; ++t) {
      const layout::TileRecord& tile = nodes_->tiles[t];
      if (in.row + a - tile.place.y < tile.size.x && in.col + b - tile.place.z < tile.size.y) return t;
    }
    return in.first_tile;
  }

  layout::FoundationNodeRecord recordOf(std::size_t taxel, std::uint32_t a, std::uint32_t b, double spring, std::uint32_t fours) const {
    const Taxel& in = taxels_[taxel];
    const glm::uvec4 grid = nodes_->patches[in.patch].grid;
    const std::uint32_t row = in.row + a, col = in.col + b;
    return {{grid.z + row * grid.y + col, row << 16 | col, wordOf(spring), tileAt(taxel, a, b) | fours << layout::kNodeLinksShift}};
  }

  // Of the nodes of a taxel from (a, b) on, `side` along each side.
  layout::FoundationBlockRecord blockOf(std::size_t taxel, std::uint32_t a, std::uint32_t b, std::uint32_t side) const {
    const Taxel& in = taxels_[taxel];
    const std::uint32_t c = a + side - 1, d = b + side - 1;
    return {.tiles = {tileAt(taxel, a, b), tileAt(taxel, a, d), tileAt(taxel, c, b), tileAt(taxel, c, d)},
            .nodes = {in.row + a, in.row + c + 1, in.col + b, in.col + d + 1},
            .color_ends = {0, 0, 0, 0},
            .near = {0, 0, in.patch, 0}};
  }

 private:
  struct Taxel {
    std::uint32_t patch, row, col, first_tile, end_tile;
  };

  std::vector<Taxel> taxels_;
  const PackedSensor* nodes_;
};

// Blocks along a side of a taxel, of at least 4 nodes each: small blocks leave few nodes to be solved that need not be, and make long
// lists.
std::uint32_t partsOf(std::uint32_t per_side, std::size_t num_taxels) {
  constexpr std::uint32_t kLeastSide = 4;
  constexpr std::size_t kMostBlocks = 2000;  // of 8 bytes in shared memory, of which every device has 16 KiB
  std::uint32_t parts = std::max(per_side / kLeastSide, 1u);
  while (per_side % parts != 0 || (parts > 1 && num_taxels * parts * parts > kMostBlocks)) --parts;
  return parts;
}

// Numbers the nodes by block, then by color; sets where the colors end. Returns the new number of every node.
std::vector<std::uint32_t> numberNodes(const std::vector<std::uint32_t>& colors, std::uint32_t per_side, std::uint32_t parts,
                                       PackedLinks& packed) {
  const std::uint32_t side = per_side / parts;
  std::vector<std::uint32_t> numbers(colors.size());
  packed.num_colors = *std::max_element(colors.begin(), colors.end()) + 1;
  std::uint32_t next = 0;
  for (std::size_t block = 0; block < packed.blocks.size(); ++block) {
    const std::size_t taxel = block / (parts * parts), first_a = block / parts % parts * side, first_b = block % parts * side;
    const std::uint32_t first = next;
    for (std::uint32_t color = 0; color < packed.num_colors; ++color) {
      const std::uint32_t before = next;
      for (std::size_t k = 0; k < std::size_t{side} * side; ++k) {
        const std::size_t n = (taxel * per_side + first_a + k / side) * per_side + first_b + k % side;
        if (colors[n] == color) numbers[n] = next++;
      }
      packed.blocks[block].color_ends[static_cast<int>(color / 2)] |= (next - first) << 16 * (color % 2);
      packed.most_of_color = std::max(packed.most_of_color, next - before);
    }
  }
  return numbers;
}

}  // namespace

PackedLinks packLinks(const Sensor& sensor, const PackedSensor& node_sensor) {
  const LinkedNodes nodes = linkedNodes(sensor);
  const double decay = decayLength(std::get<Pasternak>(sensor.skin.law));
  const auto per_side = static_cast<std::uint32_t>(nodes.per_side);
  const std::size_t per_taxel = std::size_t{per_side} * per_side, num_nodes = nodes.links.size();
  const NodePlaces places(sensor, node_sensor, per_side);
  PackedLinks packed;
  const std::uint32_t parts = partsOf(per_side, num_nodes / per_taxel), side = per_side / parts;
  packed.blocks_per_taxel = parts * parts;
  for (std::size_t t = 0; t < num_nodes / per_taxel; ++t) {
    for (std::uint32_t k = 0; k < parts * parts; ++k) packed.blocks.push_back(places.blockOf(t, k / parts * side, k % parts * side, side));
  }
  const std::vector<std::uint32_t> numbers = numberNodes(colorsOf(nodes), per_side, parts, packed);
  std::size_t most = 1;
  for (const std::vector<FoundationLink>& list : nodes.links) most = std::max(most, list.size());
  packed.num_fours = static_cast<std::uint32_t>((most + 3) / 4);
  packed.nodes.resize(num_nodes);
  packed.links.resize(4 * packed.num_fours * num_nodes);
  for (std::size_t n = 0; n < num_nodes; ++n) {
    const auto in_taxel = static_cast<std::uint32_t>(n % per_taxel), own = numbers[n];
    const std::vector<FoundationLink>& list = nodes.links[n];
    packed.nodes[own] = places.recordOf(n / per_taxel, in_taxel / per_side, in_taxel % per_side, nodes.spring[n],
                                        static_cast<std::uint32_t>((list.size() + 3) / 4));
    for (std::size_t k = 0; k < 4 * packed.num_fours; ++k) {
      const FoundationLink link = k < list.size() ? list[k] : FoundationLink{.node = static_cast<int>(n), .length = 1};
      const auto other = static_cast<std::size_t>(link.node);
      const std::uint32_t block = numbers[other] / (side * side);
      const auto sides = static_cast<std::uint32_t>(link.side | link.other_side << layout::kSideBits);
      packed.links[k * num_nodes + own] = {{numbers[other] | block << layout::kLinkBlockShift | sides << layout::kLinkSidesShift,
                                            wordOf(link.stiffness), wordOf(1 / link.length), wordOf(stiffnessAtRest(link, decay))}};
    }
  }
  const std::vector<std::vector<int>> near = blocksWithin(sensor, static_cast<int>(parts), kMarginDecays * decay);
  for (std::size_t b = 0; b < near.size(); ++b) {
    packed.blocks[b].near.x = static_cast<std::uint32_t>(packed.near.size());
    packed.near.insert(packed.near.end(), near[b].begin(), near[b].end());
    packed.blocks[b].near.y = static_cast<std::uint32_t>(packed.near.size());
  }
  return packed;
}

}  // namespace taxelsim
