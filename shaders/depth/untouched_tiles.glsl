// Tiles that no object is near: how they are found, and their outputs. Outputs of the taxels of other tiles that nothing reaches. The includer defines
// beginTile(), which loads a tile, and is false for one that this dispatch does not compute.

bool beginTile(uint instance, uint tile_number, out Tile tile);

// Sensors with many small tiles: objects reach few of them. Relaxation advances the state of every tile.
const bool kManySmallTiles = EARLY_EXIT && NUM_ROWS == 0 && NUM_TILES > 1 && RELAXATION == 0;
// Other tiles that nothing reaches: their workgroups leave early. A load search in the tile has to say that it found nothing.
const bool kLeavesUntouched = EARLY_EXIT && NUM_ROWS > 0 && RELAXATION == 0 && !kGlobalSolve && !OUTPUT_JACOBIAN && SEARCH != kSearchInTile;
// One invocation per tile first finds the tiles that objects reach; then all invocations process these one after another: a software driver's vectors compute
// all of a tile even where every lane has left. This does not pay where a large tile would be cleared every time, or where the workgroup has only one tile.
bool findsNear() { return kManySmallTiles || kLeavesUntouched && IS_LAST && REPEAT > 1; }
// Likewise the tiles whose load search has not ended, and those whose object is of the dispatch's kinds.
bool listsTiles() { return findsNear() || (SEARCH == kSearchOverTiles || SELECTS_KINDS) && EARLY_EXIT && REPEAT > 1; }

bool anyObjectNear(Tile tile, uint instance, uint num_slots) {
  bool near = false;
  for (uint slot = 0; slot < num_slots; ++slot) {
    int id;
    near = near || nearBodyInSlot(tile, instance * num_slots + slot, id).near;
  }
  return near;
}

// Writes the outputs of a tile that no object is near: by one invocation alone (`first` 0, `step` 1), or by all invocations of a workgroup.
void clearTile(Tile tile, uint instance, uint tile_number, uint first, uint step) {
  uint result = instance * NUM_TILES + tile_number;
  if (IS_LAST && NUM_ROWS > 0) {
    // Outside the window of the step before, all outputs are already 0.
    bool is_clear = all(equal(tile_results[result].window, uvec4(0)));
    if (step > 1) workgroupBarrier();
    if (is_clear) return;
  }
  // Heights are read inside of the windows only.
  for (uint row = 0; row < (kGlobalSolve ? 0u : tile.size.x); ++row) {
    uint begin = instance * NUM_TAXELS + tile.grid.z + (row + tile.first_taxel.x) * tile.grid.y + tile.first_taxel.y;
    for (uint taxel = begin + first; taxel < begin + tile.size.y; taxel += step) {
      contact_normal[taxel] = 0.0;
      if (OUTPUT_SHEAR) writeShear(taxel, vec2(0));
      if (OUTPUT_DEPTH) contact_depth[taxel] = 0.0;
      if (OUTPUT_JACOBIAN) clearCell(taxel);
    }
  }
  if (first > 0) return;
  if (kStoresTouched) state[stateStart(result) + kTouchedTaxels] = uvec4(0);
  if (OUTPUT_WRENCH_CHANGE) clearChange(result);
  tile_results[result] = TileResult(vec4(0), vec4(0), uvec4(0));
}

// Lists the tiles from `first` to `end` that are to be computed, and writes the outputs of those that no object is near. Returns how many are listed.
uint listTiles(uint first, uint end) {
  if (gl_LocalInvocationIndex == 0) num_listed_tiles = 0;
  workgroupBarrier();
  for (uint place = first + gl_LocalInvocationIndex; place < end; place += WORKGROUP) {
    uint number = tileNumbered(place), instance = number / NUM_TILES, tile_number = number - instance * NUM_TILES;
    Tile tile;
    if (!beginTile(instance, tile_number, tile)) continue;
    if (!findsNear() || anyObjectNear(tile, instance, step_record.batch.y)) {
      tile_list[atomicAdd(num_listed_tiles, 1u)] = number;
    } else {
      clearTile(tile, instance, tile_number, 0, 1);
    }
  }
  workgroupBarrier();
  return num_listed_tiles;
}

// Clears the taxels that nothing reaches. The image pass reads nothing outside the window of a sensor of one tile with a kernel.
void clearUntouched(Tile tile, TileStep step, ActiveTaxels taxels) {
  if (!kClearsHeights && !HAS_CELLS) return;
  if (!(OUTPUT_JACOBIAN || NUM_TILES > 1 || NUM_ROWS == 0 || OUTPUT_DEPTH || HAS_CELLS)) return;
  for (uint k = gl_LocalInvocationIndex; k < tile.size.x * tile.size.y; k += WORKGROUP) {
    uvec2 in_tile = cellNumbered(k, tile.size.y);
    if (all(greaterThanEqual(in_tile, taxels.first)) && all(lessThan(in_tile, taxels.first + taxels.count))) continue;
    uvec2 in_patch = in_tile + tile.first_taxel;
    uint taxel = step.first_taxel + in_patch.x * tile.grid.y + in_patch.y;
    if (kWritesCells) {
      node_cells[kNodeCellWords * taxel + 1u] = 0;
      continue;
    }
    contact_normal[taxel] = kGlobalSolve ? kMiss : 0.0;
    if (OUTPUT_SHEAR) writeShear(taxel, vec2(0));
    if (OUTPUT_DEPTH) contact_depth[taxel] = 0.0;
    if (OUTPUT_JACOBIAN) clearCell(taxel);
  }
}
