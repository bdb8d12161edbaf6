// Tiles that no object is near: how they are found, and their outputs. Outputs of the taxels of other tiles that nothing reaches. The
// includer defines beginTile(), which loads a tile, and is false for one that this dispatch does not compute.

bool beginTile(uint instance, uint tile_number, out Tile tile);

// Sensors with many small tiles: objects reach few of them. Relaxation advances the state of every tile.
const bool kManySmallTiles = EARLY_EXIT && NUM_ROWS == 0 && NUM_TILES > 1 && RELAXATION == 0;
// Other tiles that nothing reaches: their workgroups leave early. A load search in the tile has to say that it found nothing.
const bool kLeavesUntouched = EARLY_EXIT && NUM_ROWS > 0 && RELAXATION == 0 && !OUTPUT_JACOBIAN && SEARCH != kSearchInTile;
// Whether all outputs of a tile outside pastWindow() are 0. Not after a search over tiles, which writes windows, but no shear and no
// Jacobian; nor where taxel passes write other windows.
const bool kKnowsPast = EARLY_EXIT && IS_LAST && NUM_ROWS > 0 && SEARCH != kSearchEnded;
// One invocation per tile first finds the tiles that objects reach; then all invocations process these one after another. This does not pay
// where a large tile would be cleared every time, or where the workgroup has only one tile.
bool findsNear() { return kManySmallTiles || kLeavesUntouched && kKnowsPast && REPEAT > 1; }
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

// Taxels of the patch that the last step may have written: first row, end row, first column, end column. `result`: of the tile.
uvec4 pastWindow(uint result) { return fourOf(ResultFours, 3u * result + 2u); }

// Clears the outputs of a tile's taxels that are not active; `invocation` of `num_invocations`. The image pass reads no forces outside the
// window of a sensor of one tile with a kernel.
void clearTaxels(Tile tile, uint instance, uint result, ActiveTaxels active_taxels, uint invocation, uint num_invocations) {
  const bool kClearsForces = OUTPUT_JACOBIAN || NUM_TILES > 1 || NUM_ROWS == 0;
  if (!(kClearsForces || OUTPUT_DEPTH)) return;
  uvec2 first = tile.first_taxel, count = tile.size;
  if (kKnowsPast) {
    uvec4 past = pastWindow(result);
    first = past.xz;
    count = past.yw - past.xz;
  }
  for (uint k = invocation; k < count.x * count.y; k += num_invocations) {
    uvec2 in_patch = first + cellNumbered(k, count.y), from_active = in_patch - tile.first_taxel - active_taxels.first;
    if (all(lessThan(from_active, active_taxels.count))) continue;
    uint taxel = instance * NUM_TAXELS + tile.grid.z + in_patch.x * tile.grid.y + in_patch.y;
    if (kClearsForces) contact_normal[taxel] = 0.0;
    if (OUTPUT_SHEAR) writeShear(taxel, vec2(0));
    if (OUTPUT_DEPTH) contact_depth[taxel] = 0.0;
    if (OUTPUT_JACOBIAN) clearCell(taxel);
  }
}

// Writes the outputs of a tile that no object is near; all invocations of a workgroup share it, or one takes it alone.
void clearTile(Tile tile, uint instance, uint tile_number, uint invocation, uint num_invocations) {
  uint result = instance * NUM_TILES + tile_number;
  if (kKnowsPast && all(equal(pastWindow(result), uvec4(0)))) return;
  clearTaxels(tile, instance, result, ActiveTaxels(uvec2(0), uvec2(0)), invocation, num_invocations);
  if (num_invocations > 1) workgroupBarrier();
  if (invocation > 0) return;
  if (kStoresTouched) state[stateStart(result) + kTouchedTaxels] = uvec4(0);
  if (OUTPUT_WRENCH_CHANGE) clearChange(result);
  tile_results[result] = TileResult(vec4(0), vec4(0), uvec4(0));
}

// Lists the tiles from `first` to `end` that are to be computed, and writes the outputs of those that no object is near. Returns how many
// are listed.
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
