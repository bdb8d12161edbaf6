// Area sampling: the depth of a sample is the mean over the sample's cell of clamp(-z, 0, THICKNESS), where z is the height of the lowest
// surface of an object. Sums over the cells of a tile (depth/area/cell_sums.glsl), for one object at a time; then the object that is
// deepest on average has the cell.
// Twin: src/reference/area_depth.cpp.

const float kVolumeUnits = 134217728.0;  // of the cell's area times Tile::deepest; 2^27 leaves room for sixteen surfaces above each other
const float kLeastDepth = 1e-9;          // m
const float kCoveredUnits = 1048576.0;   // of the cell's area

// A list of cells that need more work than the others.
const uint kMostListed = (TILE_SAMPLES + 3u) / 4u;
shared uint listed_cells[AREA ? kMostListed : 1u];

// Integrals over a part of a cell, of the cell's area. Places are in widths of the cell, from its middle.
struct CellSums {
  float volume;   // of the depth, m
  float covered;  // of 1
  float square;   // of the depth's square, m^2; like the moment only with VARIATION
  vec2 moment;    // of depth times place, m
};

void addSums(inout CellSums sums, CellSums more, float factor) {
  sums.volume += factor * more.volume;
  sums.covered += factor * more.covered;
  if (!VARIATION) return;
  sums.square += factor * more.square;
  sums.moment += factor * more.moment;
}

void divideSums(inout CellSums sums, float by) {
  sums.volume /= by;
  sums.covered /= by;
  if (!VARIATION) return;
  sums.square /= by;
  sums.moment /= by;
}

// Adds integrals to the sums of a cell. `alone`: no two invocations add to one cell at a time.
void addToSums(Tile tile, uint address, CellSums sums, bool subtract, bool alone) {
  float units = kVolumeUnits / tile.deepest;
  ivec2 more = ivec2(round(vec2(sums.volume * units, sums.covered * kCoveredUnits)));
  if (VARIATION) {
    float side = subtract ? -units : units;
    atomicAdd(cell_squares[address], uint(int(round(sums.square * side / tile.deepest))));
    addMoment(address, ivec2(round(sums.moment * side)));
  }
  addVolume(address, subtract ? -more : more, alone);
}

// How the depth varies over the covered part of a cell, on which its mean is `mean`: a vector, as two half floats. Its direction is the one
// in which the cell is deeper, or x where there is none; its length is the standard deviation of the depth over the mean.
uint variationOf(Tile tile, CellSums sums, float mean) {
  const float kEven = 0.01;                // of a cell: how far from its middle the pressure acts
  const float kLeast = 1e-3, kMost = 8.0;  // of the mean
  float covered = max(sums.covered, 1.0 / kCoveredUnits), before = sums.volume / covered;
  float deviation = sqrt(max(sums.square / covered - before * before, 0.0));
  vec2 deeper = sums.moment * tile.spacing;
  bool is_even = length(sums.moment) <= kEven * sums.volume;
  return packHalf2x16(clamp(deviation / max(mean, kLeastDepth), kLeast, kMost) *
                      (is_even ? vec2(1, 0) : deeper / max(length(deeper), 1e-30)));
}

// ---- cells of nodes, for a globally coupled law ----
//
// An edge of an object cuts a cell where the depth hardly varies over what is covered; where a smooth surface leaves the skin it varies
// from 0. Only an edge makes a cell smaller: of a smooth surface the height in the middle of the cell says more. Twin:
// src/reference/layer_cells.cpp.

// How far an edge bounds what is covered, 1 to 0, by the variance of the depth over the square of its mean.
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
  ivec2 place = ivec2(round(clamp(2.0 * edge * sums.moment / max(sums.volume, 1e-30), -1.0, 1.0) * kMost));
  uint mask = (1u << kCentroidBits) - 1u;
  return (uint(place.x) & mask) | (uint(place.y) & mask) << kCentroidBits |
         uint(round(edge * float((1u << kEdgeBits) - 1u))) << (2u * kCentroidBits);
}

// Gives a cell of a node to the object in a slot if that is the deepest over what it covers, which is the depth that the word of the tile
// then holds.
void giveNodeCell(Tile tile, uint address, uint slot, CellSums sums) {
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

// Gives a cell to the object in a slot if that is the deepest.
void giveCell(Tile tile, uint address, uint slot, CellSums sums, inout Found found) {
  if (kGlobalSolve) {
    giveNodeCell(tile, address, slot, sums);
    return;
  }
  float share = clamp(sums.covered, 1.0 / kCoveredUnits, 1.0);
  // Surfaces of one object above each other share the cell. A lower level of the skin makes what is covered deeper.
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

// The integrals of a cell; its sums begin anew.
CellSums takeSums(Tile tile, uint address) {
  float unit = tile.deepest / kVolumeUnits;
  ivec2 volume = volumeOf(address);
  CellSums sums = CellSums(float(volume.x) * unit, float(volume.y) * (1.0 / kCoveredUnits), 0.0, vec2(0));
  if (VARIATION) {
    sums.square = float(int(cell_squares[address])) * unit * tile.deepest;
    sums.moment = vec2(momentOf(address)) * unit;
  }
  clearSums(address);
  return sums;
}

// Gives the cells of a box to the object whose sums are complete. All invocations call it.
void takeCells(Tile tile, Box box, uint slot, inout Found found) {
  if (!isAny(box)) return;
  uint num_cols = uint(box.last.y - box.first.y + 1), count = uint(box.last.x - box.first.x + 1) * num_cols;
  uint i = gl_LocalInvocationIndex;
  do {
    if (i < count) {
      uvec2 at = uvec2(box.first) + cellNumbered(i, num_cols);
      uint address = at.x * tile.stride + at.y;
      CellSums sums = takeSums(tile, address);
      if (sums.volume != 0.0 || sums.covered != 0.0) giveCell(tile, address, slot, sums, found);
    }
    i += WORKGROUP;
  } while (i - gl_LocalInvocationIndex < count);
  workgroupBarrier();
}
