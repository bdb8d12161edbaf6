// Area sampling: the depth of a sample is the mean over the sample's cell of clamp(-z, 0, THICKNESS), where z is the height of the lowest surface of an
// object. Sums over the cells of a tile, for one object at a time; then the object that is deepest on average has the cell. Twin: src/reference/area_depth.cpp.
//
// Sums are integers, so that the order of facets does not matter. Where an instance has one slot, they begin at the words of an empty tile.

const float kVolumeUnits = 134217728.0;   // of the cell's area times Tile::deepest; 2^27 leaves room for sixteen surfaces above each other
const float kLeastDepth = 1e-9;           // m
const float kCoveredUnits = 1048576.0;    // of the cell's area
const float kSliver = 0.25;               // of a cell: what covers less does not count as deep
const float kFull = 0.999;                // of THICKNESS: mean depth of the covered part that counts as the skin's full thickness

// A list of cells that need more work than the others.
const uint kMostListed = (TILE_SAMPLES + 3u) / 4u;
shared uint listed_cells[AREA ? kMostListed : 1u];

// Adds the integral (of the cell's area, m) over the covered part (of the cell's area). `alone`: no two invocations add to one cell at a time.
void addToSums(Tile tile, uint address, float volume, float covered, bool subtract, bool alone) {
  int amount = int(round(volume * (kVolumeUnits / tile.deepest))), part = int(round(covered * kCoveredUnits));
  uint more = uint(subtract ? -amount : amount), more_covered = uint(subtract ? -part : part);
#ifdef LOCKSTEP
  if (alone && MANY_SLOTS) {
    cell_volumes[address] += more;
    cell_covered[address] += more_covered;
    return;
  }
  if (alone) {
    tile_heights[address] += more;
    cell_shares[address] += more_covered;
    return;
  }
#endif
  if (MANY_SLOTS) {
    atomicAdd(cell_volumes[address], more);
    atomicAdd(cell_covered[address], more_covered);
  } else {
    atomicAdd(tile_heights[address], more);
    atomicAdd(cell_shares[address], more_covered);
  }
}

// Gives a cell to the object in a slot if that is the deepest: `depth`, the integral (of the cell's area, m), and `covered`, the covered part.
void giveCell(Tile tile, uint address, uint slot, float depth, float covered) {
  float share = clamp(covered, 1.0 / kCoveredUnits, 1.0);
  // Surfaces of one object above each other share the cell. A lower level of the skin makes what is covered deeper.
  depth = clamp(depth / max(covered, 1.0) + tile.level * share, 0.0, THICKNESS);
  uint word = depth > 0.0 ? wordOfDepth(depth, slot) : kEmpty;
  if (MANY_SLOTS) {
    if (word >= atomicMin(tile_heights[address], word)) return;
  } else {
    tile_heights[address] = word;
  }
  cell_shares[address] = floatBitsToUint(share > kSliver && depth >= kFull * THICKNESS * share ? -share : share);
}

// Gives the cells of a box to the object whose sums are complete, and clears its sums. All invocations call it.
void takeCells(Tile tile, Box box, uint slot) {
  if (!isAny(box)) return;
  uint num_cols = uint(box.last.y - box.first.y + 1), count = uint(box.last.x - box.first.x + 1) * num_cols;
  for (uint i = gl_LocalInvocationIndex; i < count; i += WORKGROUP) {
    uvec2 at = uvec2(box.first) + cellNumbered(i, num_cols);
    uint address = at.x * tile.stride + at.y;
    int volume = int(MANY_SLOTS ? cell_volumes[address] : tile_heights[address] - kEmpty);
    int covered = int(MANY_SLOTS ? cell_covered[address] : cell_shares[address] - kWhole);
    if (volume == 0 && covered == 0) continue;
    giveCell(tile, address, slot, float(volume) * (tile.deepest / kVolumeUnits), float(covered) * (1.0 / kCoveredUnits));
    if (MANY_SLOTS) cell_volumes[address] = cell_covered[address] = 0;
  }
  workgroupBarrier();
}
