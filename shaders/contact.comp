#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
// Contact pass: stages 1 (depth) and 2 (contact law) of one frame, and the load search over one tile. Interface: passes/contact.h.
//
// A workgroup owns REPEAT tiles in sequence; tile number = instance NUM_TILES + tile of the sensor. An invocation owns boxes, then quads,
// then taxels.
// In:  poses (num_instances x poses of the step), objects, groups, clusters, quads of triangles, faces, the sensor's patches and tiles.
// Out: contact_normal (num_instances x num_taxels), N, divided by the part of the spread's kernel that stays on the sensor; contact_shear
//      (num_instances x num_taxels x 2), N, divided as well; contact_depth (num_instances x num_taxels), m; tile_results (num_instances x
//      num_tiles); loads (num_instances); contact_cells (num_instances x num_taxels), tile_changes (num_instances x num_tiles x LANES),
//      skin/cell_fluxes.glsl. A sensor of one tile writes taxels only inside the window of its result.
// State per sample, between steps: skin/sample_states.glsl.
// Shared memory: 4 TILE_SAMPLES (9 with AREA, 17 with MANY_SLOTS or ONE_VECTOR, too) + 16 LANES + 4 kClustersPerBatch + 4 GROUPS_PER_BATCH
//      + 4 REPEAT + 88 bytes; friction adds 8 LANES + 512, ONE_VECTOR 16 NUM_FACES, AREA with meshes 4 kMostFacets, VARIATION 16
//      TILE_SAMPLES.
// Deterministic: the tile is a minimum of integers, which sum cells; LANES partial sums are added in a fixed order, whatever the size of
// the workgroup.
// Mutable globals: own_partial (driver/workgroup.glsl), own_shear (skin/friction.glsl); any_unfinished_loop, num_iterations
// (driver/loops.glsl); the planes of a polyhedron (depth/solids.glsl).
// References: src/reference/depth.cpp, contact.cpp, relaxation.cpp, friction.cpp, lugre.cpp, load.cpp.

#include "passes/declare.glsl"
#include "passes/depth.h"
#include "passes/contact.h"

const float REACH = 0.0;  // surfaces over the skin do not press
const bool kAllHeights = false;

#include "common/instances.glsl"
#include "depth/area/cell_depths.glsl"
#include "skin/tile_pressures.glsl"

// One frame of one tile.
void computeTile(uint instance, uint tile_number, uint num_slots) {
  Tile tile;
  if (!beginTile(instance, tile_number, tile)) return;
  bool load_driven = SEARCH != kNoSearch && (instanceRecord(instance).keys.w & kFlagLoadDriven) != 0;
  bool search_here = SEARCH == kSearchInTile && load_driven;
  if (gl_LocalInvocationIndex == 0) {
    startBoxes();
    num_deep = 0;
    most_touched = 0;
    if (NUM_ROWS == 0) any_behind = 0;
    lowest_bits = kEmpty;
  }
  Reach reach = objectsNear(tile, instance, num_slots);
  if (kLeavesUntouched && !isAny(reach.samples)) {
    clearTile(tile, instance, tile_number, gl_LocalInvocationIndex, WORKGROUP);
    return;
  }
  if (search_here) tile.z_base = clamp(reach.lowest_bound, -1.0, 1.0);
  workgroupBarrier();

  Found found;
  Box samples;
  ActiveTaxels taxels;
  TileStep step;
  float lowest_bound = reach.lowest_bound;
  uint band = firstBand(reach.body.kind_groups.x);
  bool again;
  do {
    if (search_here) {
      band = setBand(tile, lowest_bound, band);
      reach = objectsNear(tile, instance, num_slots);
    }
    found = Found(noSamples(), false, 0u);
    samples = rasterHeights(tile, instance, num_slots, reach, found);
    countIterations(kIterationsOfSample * areaOf(samples));
    taxels = activeTaxels(samples);
    step = beginPressures(tile, instance, tile_number, num_slots, reach, taxels, load_driven, search_here);
    again = SEARCH == kSearchInTile && step.found.status == kLoadSearching;
    if (again) clearForNextBand(tile, samples);
  } while (again && band < kNumBands);
  pressTaxels(tile, step, taxels, found);
  clearTaxels(tile, instance, step.result, taxels, gl_LocalInvocationIndex, WORKGROUP);
  writeTileResult(tile, step.result, step.state, step.skin, taxels, samples);
}

void main() {
  uvec2 range = tileRange();
  uint count = range.y - range.x;
  if (listsTiles()) count = listTiles(range.x, range.y);
  if (usesTile() && count > 0) {
    clearHeights();
    workgroupBarrier();
  }
  uint k = 0;
  if (count > 0) do {
      uint number = listsTiles() ? tile_list[k] : tileNumbered(range.x + k);
      uint instance = number / NUM_TILES;
      computeTile(instance, number - instance * NUM_TILES, step_record.batch.y);
      workgroupBarrier();
    } while (++k < count && !exceedsBudget());
  checkLoop(k < count && !exceedsBudget());
  if (kLeavesTiles && gl_LocalInvocationIndex == 0) {
    for (; k < count; ++k) leaveTile(listsTiles() ? tile_list[k] : tileNumbered(range.x + k));
    checkLoop(k < count);
  }
  reportUnfinishedLoops();
}
