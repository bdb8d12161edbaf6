// Outputs of the contact pass: per taxel, and per tile the result with force (N) and torque (N m) in S and the window of active taxels.
// Outputs of tiles and taxels without a near object are cleared.
//
// Out: contact_normal, contact_depth, contact_shear, contact_cells, tile_changes, tile_results; the state that friction and relaxation keep
//      of the tile.
// Shared memory: 8 bytes.

#include "depth/tile_sequence.glsl"
#include "skin/cell_fluxes.glsl"
#include "skin/friction.glsl"
#include "skin/load_search.glsl"

// Cosine to z of S. On a patch flatter than this, a surface below Tile::z_floor means that a load search has passed through the body.
const float kLooksUp = 0.7;

shared uint num_deep;    // samples at the skin's full thickness
shared uint any_behind;  // 1: a surface below Tile::z_floor, on a patch that looks along z of S

// Taxels of a tile that can carry force: a rectangle, in taxels of the tile, half-open.
struct ActiveTaxels {
  uvec2 first, count;
};

ActiveTaxels activeTaxels(Box samples) {
  bool is_any = isAny(samples);
  uvec2 first = is_any ? uvec2(samples.first) / SAMPLES : uvec2(0), end = is_any ? uvec2(samples.last) / SAMPLES + 1u : uvec2(0);
  return ActiveTaxels(first, end - first);
}

// Sums over the samples of a taxel.
struct TaxelSums {
  float depth;        // m
  float force;        // Pa
  vec2 moment;        // Pa m
  vec2 shear;         // Pa
  vec3 shear_moment;  // Pa m
  uint deep;          // samples at the skin's full thickness
  float slope;        // slope of the force by the depth, Pa/m; kSumsSlopes
};

// For Newton's method over tiles, load.comp. A search has no shear, so the slope takes the component of its torque.
const bool kSumsSlopes = AREA && SEARCH == kSearchOverTiles;

void writeShear(uint taxel, vec2 shear) {
  contact_shear[2 * taxel] = shear.x;
  contact_shear[2 * taxel + 1] = shear.y;
}

// Writes one taxel and adds to the wrench (normal force, torque about x, y and z of P) and shear of its lane.
void writeTaxel(Tile tile, uint instance, uvec2 in_patch, TaxelSums sums, Cell cell, inout vec4 wrench, inout vec2 lane_shear) {
  const float kPerSample = 1.0 / float(SAMPLES * SAMPLES);
  float force = sums.force * tile.force_area;
  vec2 moment = sums.moment * tile.force_area;
  uint in_sensor = tile.grid.z + in_patch.x * tile.grid.y + in_patch.y;
  uint taxel = instance * NUM_TAXELS + in_sensor;
  float scale = SCALED ? floatOfFours(SpreadScale, in_sensor) : 1.0;
  contact_normal[taxel] = SCALED ? force * scale : force;
  if (OUTPUT_DEPTH) contact_depth[taxel] = sums.depth * kPerSample;
  if (OUTPUT_JACOBIAN) writeCell(tile, taxel, cell);
  // The skin is pressed along -z: torque (x, y, 0) x (0, 0, -f).
  wrench += vec4(force, -moment.y, moment.x, kSumsSlopes ? sums.slope * tile.force_area : 0.0);
  if (!FRICTION) return;
  vec2 shear = sums.shear * tile.force_area;
  if (OUTPUT_SHEAR) writeShear(taxel, SCALED ? shear * scale : shear);
  wrench.yzw += sums.shear_moment * tile.force_area;
  lane_shear += shear;
}

// `state_start`: where the states of the tile's samples begin.
void writeTileResult(Tile tile, uint tile_index, uint state_start, TileSkin tile_skin, ActiveTaxels taxels, Box samples) {
  vec4 total = sumOfPartials();
  if (usesTile() && REPEAT > 1) clearSamples(tile, samples);
  if (RELAXATION > 0 && kUpdatesSkin) updateRestOfSkin(tile, tile_skin, taxels.first, taxels.count);
  vec3 force = -total.x * tile.X_PS.row2.xyz;  // rows of R_PS are the axes of P in S
  vec3 torque = total.y * tile.X_PS.row0.xyz + total.z * tile.X_PS.row1.xyz;
  if (FRICTION) {
    vec2 shear = sumOfPartialShears();
    force += shear.x * tile.X_PS.row0.xyz + shear.y * tile.X_PS.row1.xyz;
    torque += total.w * tile.X_PS.row2.xyz;
  }
  if (!FLAT) {
    vec3 origin = -(tile.X_PS.row0.xyz * tile.X_PS.row0.w + tile.X_PS.row1.xyz * tile.X_PS.row1.w +
                    tile.X_PS.row2.xyz * tile.X_PS.row2.w);  // origin of P in S
    torque += cross(origin, force);
  }
  uvec2 first = tile.first_taxel + taxels.first;
  bool none = taxels.count.x * taxels.count.y == 0;
  uvec4 window = none ? uvec4(0) : uvec4(first.x, first.x + taxels.count.x, first.y, first.y + taxels.count.y);
  if (kStoresTouched) writeRectangle(state_start, kTouchedTaxels, none ? uvec4(0) : uvec4(taxels.first, taxels.first + taxels.count).xzyw);
  if (NUM_ROWS == 0) window = uvec4(any_behind, 0, 0, 0);
  vec4 force_row = vec4(force, float(num_deep));
  vec4 torque_row = vec4(torque, kSumsSlopes ? total.w * tile.X_PS.row2.z * tile.X_PS.row2.z : total.x);
  for (uint k = gl_LocalInvocationIndex; k < 4; k += WORKGROUP) {  // one word per invocation
    tile_results[tile_index].force[k] = force_row[k];
    tile_results[tile_index].torque[k] = torque_row[k];
    tile_results[tile_index].window[k] = window[k];
  }
}

// ---- outputs that nothing reaches ----

// Sensors with many small tiles: objects reach few of them. Relaxation advances the state of every tile.
const bool kManySmallTiles = EARLY_EXIT && NUM_ROWS == 0 && NUM_TILES > 1 && RELAXATION == 0;
// Other tiles that nothing reaches: their workgroups leave early. A load search in the tile has to say that it found nothing.
const bool kLeavesUntouched = EARLY_EXIT && NUM_ROWS > 0 && RELAXATION == 0 && !OUTPUT_JACOBIAN && SEARCH != kSearchInTile;
// Whether all outputs of a tile outside pastWindow() are 0. Not after a search over tiles, which writes windows, but no shear and no
// Jacobian; nor where taxel passes write other windows.
const bool kHasHistory = EARLY_EXIT && IS_LAST && NUM_ROWS > 0 && SEARCH != kSearchEnded;

// Taxels of the patch that the last step may have written: first row, end row, first column, end column. `result`: index of the tile over
// all instances.
uvec4 pastWindow(uint result) { return fourOf(ResultFours, 3u * result + 2u); }

// Clears the outputs of a tile's taxels that are not active; `invocation` of `num_invocations`. The image pass reads no forces outside the
// window of a sensor of one tile with a kernel.
void clearTaxels(Tile tile, uint instance, uint result, ActiveTaxels active_taxels, uint invocation, uint num_invocations) {
  const bool kClearsForces = OUTPUT_JACOBIAN || NUM_TILES > 1 || NUM_ROWS == 0;
  if (!(kClearsForces || OUTPUT_DEPTH)) return;
  uvec2 first = tile.first_taxel, count = tile.size;
  if (kHasHistory) {
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
  if (kHasHistory && all(equal(pastWindow(result), uvec4(0)))) return;
  clearTaxels(tile, instance, result, ActiveTaxels(uvec2(0), uvec2(0)), invocation, num_invocations);
  if (num_invocations > 1) workgroupBarrier();
  if (invocation > 0) return;
  if (kStoresTouched) state[stateStart(result) + kTouchedTaxels] = uvec4(0);
  if (OUTPUT_WRENCH_CHANGE) clearChange(result);
  tile_results[result] = TileResult(vec4(0), vec4(0), uvec4(0));
}

// One invocation per tile first finds the tiles that objects reach; then all invocations process these one after another. This does not pay
// where a large tile would be cleared every time, or where the workgroup has only one tile.
bool findsNear() { return kManySmallTiles || kLeavesUntouched && kHasHistory && REPEAT > 1; }
// One invocation per tile also finds the tiles whose load search has not ended, and the tiles with an object of the dispatch's kinds.
bool listsTiles() { return findsNear() || (SEARCH == kSearchOverTiles || SELECTS_KINDS) && EARLY_EXIT && REPEAT > 1; }

bool anyObjectNear(Tile tile, uint instance, uint num_slots) {
  bool near = false;
  for (uint slot = 0; slot < num_slots; ++slot) {
    int id;
    near = near || nearBodyInSlot(tile, instance * num_slots + slot, id).near;
  }
  return near;
}

// Lists the tiles from `first` to `end` that are to be computed, and writes the outputs of the tiles that no object is near. Returns the
// number of listed tiles.
uint listTiles(uint first, uint end) {
  if (gl_LocalInvocationIndex == 0) num_listed_tiles = 0;
  workgroupBarrier();
  for (uint index = first + gl_LocalInvocationIndex; index < end; index += WORKGROUP) {
    uint number = tileNumbered(index), instance = number / NUM_TILES, tile_number = number - instance * NUM_TILES;
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
