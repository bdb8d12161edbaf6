// Area sampling for the heights pass: depth, covered share and centroid of the part of a node's cell that an object covers. A cell belongs
// to the object that is deepest over the part that it covers.
//
// An edge of an object cuts a cell where the depth hardly varies over the covered part; where a smooth surface leaves the skin it varies
// from 0. Only an edge makes a cell smaller: for a smooth surface the height in the middle of the cell is the better estimate.
// Reference: src/reference/layer_cells.cpp.

#include "shared/elastic_layer.h"
#include "depth/area/cell_sums.glsl"

// How far an edge bounds the covered part, 1 to 0, by the variance of the depth over the square of its mean.
const float kSureEdge = 0.05;     // a plane whose shallow side is half as deep as the deep one has 0.04
const float kNearlyWhole = 20.0;  // times the share that is not covered, below 1, is how far the height in the middle still counts
const float kNoEdge = 0.15;       // a parabola that ends in the skin on both sides has 0.2, a plane that ends there on one side 0.33

float edgeOf(CellSums sums) {
  float mean = sums.volume / max(sums.covered, 1.0 / kCoveredUnits), square = sums.square / max(sums.covered, 1.0 / kCoveredUnits);
  float variance = square / max(mean * mean, kLeastDepth * kLeastDepth) - 1.0;
  return clamp((kNoEdge - variance) / (kNoEdge - kSureEdge), 0.0, 1.0) * clamp(kNearlyWhole * (1.0 - sums.covered), 0.0, 1.0);
}

uint packedCentroid(CellSums sums, float edge) {
  const float kMost = float((1u << (kCentroidBits - 1u)) - 1u);
  ivec2 center = ivec2(round(clamp(2.0 * edge * sums.moment / max(sums.volume, 1e-30), -1.0, 1.0) * kMost));
  uint mask = (1u << kCentroidBits) - 1u;
  return (uint(center.x) & mask) | (uint(center.y) & mask) << kCentroidBits |
         uint(round(edge * float((1u << kEdgeBits) - 1u))) << (2u * kCentroidBits);
}

// Gives a cell to the object in a slot if that is the deepest over the part that it covers; the word of the tile then holds that depth.
void giveCell(Tile tile, uint address, uint slot, CellSums sums, inout Found found) {
  float share = clamp(sums.covered, 1.0 / kCoveredUnits, 1.0), depth = sums.volume / max(sums.covered, 1.0 / kCoveredUnits);
  depth = clamp(depth, 0.0, THICKNESS);
  const float kLeastCovered = 8.0 / kCoveredUnits;  // less is rounding
  uint word = depth > 0.0 && sums.covered > kLeastCovered ? wordOfDepth(depth, slot) : kEmpty;
  if (MANY_SLOTS) {
    if (word >= atomicMin(tile_heights[address], word)) return;
  } else {
    tile_heights[address] = word;
  }
  float edge = edgeOf(sums);
  cell_shares[address] = floatBitsToUint(share);
  cell_variations[address] = packedCentroid(sums, edge);
}
