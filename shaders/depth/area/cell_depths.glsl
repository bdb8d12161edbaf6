// Area sampling: the depth of a sample is the mean over the sample's cell of clamp(-z, 0, THICKNESS), where z is the height of the lowest surface of an
// object. Sums over the cells of a tile, for one object at a time; then the object that is deepest on average has the cell. Twin: src/reference/area_depth.cpp.
//
// Sums are integers, so that the order of triangles does not matter.

const float kVolumeUnits = 134217728.0;   // of the cell's area times Tile::deepest; 2^27 leaves room for sixteen surfaces above each other
const float kLeastDepth = 1e-9;           // m
const float kCoveredUnits = 1048576.0;    // of the cell's area
const float kSliver = 0.25;               // of a cell: what covers less does not count as deep
const float kFull = 0.999;                // of THICKNESS: mean depth of the covered part that counts as the skin's full thickness

// Adds the integral (of the cell's area, m) over the covered part (of the cell's area).
void addToCell(Tile tile, uint address, float volume, float covered, bool subtract) {
  int amount = int(round(volume * (kVolumeUnits / tile.deepest))), part = int(round(covered * kCoveredUnits));
  atomicAdd(cell_volumes[address], subtract ? -amount : amount);
  atomicAdd(cell_covered[address], subtract ? -part : part);
}

// Gives a cell to the object in a slot if that is the deepest: `depth`, the integral (of the cell's area, m), and `covered`, the covered part.
void giveCell(uint address, uint slot, float depth, float covered) {
  // Surfaces of one object above each other share the cell.
  depth = min(depth / max(covered, 1.0), THICKNESS);
  float share = clamp(covered, 1.0 / kCoveredUnits, 1.0);
  uint word = wordOfDepth(depth, slot);
  if (depth <= 0.0) return;
  if (MANY_SLOTS) {
    if (word >= atomicMin(tile_heights[address], word)) return;
  } else {
    tile_heights[address] = word;
  }
  cell_shares[address] = share > kSliver && depth >= kFull * THICKNESS * share ? -share : share;
}

// Gives the cells of a box to the object whose sums are complete, and clears its sums. All invocations call it.
void takeCells(Tile tile, Box box, uint slot, inout Found found) {
  workgroupBarrier();
  if (!isAny(box)) return;
  uint num_cols = uint(box.last.y - box.first.y + 1), count = uint(box.last.x - box.first.x + 1) * num_cols;
  for (uint i = gl_LocalInvocationIndex; i < count; i += WORKGROUP) {
    uvec2 at = uvec2(box.first) + cellNumbered(i, num_cols);
    uint address = at.x * tile.stride + at.y;
    giveCell(address, slot, float(cell_volumes[address]) * (tile.deepest / kVolumeUnits), float(cell_covered[address]) * (1.0 / kCoveredUnits));
    cell_volumes[address] = cell_covered[address] = 0;
  }
  grow(found.samples, box);
  workgroupBarrier();
}
