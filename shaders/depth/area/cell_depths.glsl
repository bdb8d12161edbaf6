// Area sampling for the contact pass: the depth of a sample is the mean over the sample's cell of clamp(-z, 0, THICKNESS), where z is the
// height of the lowest surface of an object. The object that is deepest on average has the cell.
// Reference: src/reference/area_depth.cpp.

#include "depth/area/cell_sums.glsl"

// How the depth varies over the covered part of a cell, on which its mean is `mean`: a vector, as two half floats. Its direction is the one
// in which the cell is deeper, or x where there is none; its length is the standard deviation of the depth over the mean.
uint variationOf(Tile tile, CellSums sums, float mean) {
  const float kEven = 0.01;                // widths of a cell: how far from its middle the pressure acts
  const float kLeast = 1e-3, kMost = 8.0;  // standard deviations over the mean
  float covered = max(sums.covered, 1.0 / kCoveredUnits), before = sums.volume / covered;
  float deviation = sqrt(max(sums.square / covered - before * before, 0.0));
  vec2 deeper = sums.moment * tile.spacing;
  bool is_even = length(sums.moment) <= kEven * sums.volume;
  return packHalf2x16(clamp(deviation / max(mean, kLeastDepth), kLeast, kMost) *
                      (is_even ? vec2(1, 0) : deeper / max(length(deeper), 1e-30)));
}

// Gives a cell to the object in a slot if that is the deepest.
void giveCell(Tile tile, uint address, uint slot, CellSums sums, inout Found found) {
  float share = clamp(sums.covered, 1.0 / kCoveredUnits, 1.0);
  // Surfaces of one object above each other share the cell. A lower level of the skin makes the covered part deeper.
  float depth = clamp(sums.volume / max(sums.covered, 1.0) + tile.level * share, 0.0, THICKNESS);
  uint word = depth > 0.0 ? wordOfDepth(depth, slot) : kEmpty;
  if (MANY_SLOTS) {
    if (word >= atomicMin(tile_heights[address], word)) return;
  } else {
    tile_heights[address] = word;
  }
  bool is_full = share > kLeastShareOfFull && depth >= kFullDepth * THICKNESS * share;
  if (keepsShares()) {
    cell_shares[address] = floatBitsToUint(is_full ? -share : share);
  } else {
    found.full_cells += is_full && depthOfWord(word) < THICKNESS ? 1u : 0u;
  }
  if (VARIATION) cell_variations[address] = variationOf(tile, sums, depth / share);
}
