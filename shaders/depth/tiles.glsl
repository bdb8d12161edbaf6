// Where a workgroup of the contact pass goes, and what it leaves where nothing is near. Included by contact.comp, whose names it uses.

// Of many small tiles objects reach few; a skin that relaxes moves on where nothing is near.
const bool kManySmallTiles = LEAVE_UNTOUCHED && NUM_ROWS == 0 && NUM_TILES > 1 && RELAXATION == 0;
// Of a large grid most tiles are untouched: their workgroups leave early.
const bool kLeavesUntouched = LEAVE_UNTOUCHED && NUM_ROWS > 0 && NUM_TILES > 1 && RELAXATION == 0 && !kLawSolvedApart && !OUTPUT_JACOBIAN;
// Which tiles objects reach is found by one invocation for each, before all of them go to those. Where it would have to clear a large tile every
// time, or there is but one tile for all of them, it is not.
bool findsNear() { return kManySmallTiles || kLeavesUntouched && IS_LAST && REPEAT > 1; }

// Goes to a tile. False when the load search of its instance has ended: the results of the evaluation that ended it
// stay as they are.
bool enterTile(uint instance, uint tile_number) {
  enterWindow(tile_number);
  if (SEARCH == kSearchInTile && (instances[instance].keys.w & kFlagLoadDriven) != 0) z_limit = kMiss;
  if (SEARCH == kSearchOverTiles) {
    vec4 bracket = loads[instance].bracket;
    if (bracket.w == kLoadCarried || bracket.w == kLoadOutOfReach) return false;
    offset_z = bracket.x;
  }
  if (SEARCH == kSearchEnded && (instances[instance].keys.w & kFlagLoadDriven) != 0) offset_z = loads[instance].bracket.x;
  return true;
}

bool anyObjectNear(uint instance, uint num_slots) {
  bool near = false;
  for (uint slot = 0; slot < num_slots; ++slot) {
    int id = objectInSlot(instance * num_slots + slot);
    near = near || (id >= 0 && bodyInSlot(instance * num_slots + slot, max(id, 0)).near);
  }
  return near;
}

// What remains of the tile entered when no object is near: by one invocation alone (first 0, step 1), or by all of a workgroup.
void leaveUntouched(uint instance, uint tile_number, uint first, uint step) {
  uint result = instance * NUM_TILES + tile_number;
  if (IS_LAST && NUM_ROWS > 0) {
    // Outside the window that the step before has left all is 0.
    bool is_clear = all(equal(tile_results[result].window, uvec4(0)));
    if (step > 1) workgroupBarrier();
    if (is_clear) return;
  }
  for (uint row = 0; row < tile_size.x; ++row) {
    uint begin = instance * NUM_TAXELS + grid.z + (row + tile_taxel.x) * grid.y + tile_taxel.y;
    for (uint taxel = begin + first; taxel < begin + tile_size.y; taxel += step) {
      contact_normal[taxel] = 0.0;
      if (OUTPUT_SHEAR) writeShear(taxel, vec2(0));
      if (OUTPUT_DEPTH) contact_depth[taxel] = 0.0;
      if (OUTPUT_JACOBIAN) leaveCell(taxel);
    }
  }
  if (HAS_STATE) {
    for (uint k = first; k < tile_size.x * tile_stride * SAMPLES; k += step) state[result * TILE_SAMPLES + k] = 0.0;
  }
  if (first > 0) return;
  if (kShears) keepWindow(result * (kFrictionHeader + TILE_SAMPLES), uvec4(0));
  if (OUTPUT_JACOBIAN) leaveChange(result);
  tile_results[result] = TileResult(vec4(0), vec4(0), uvec4(0));
}
