#version 460
#extension GL_GOOGLE_include_directive : require
// Contact pass: stages 1 (depth) and 2 (contact law) of one frame, and the load search over one tile. Interface: passes/contact.glsl.
//
// A workgroup owns REPEAT tiles in sequence; tile number = instance NUM_TILES + tile of the sensor. An invocation owns boxes, then quads of
// triangles, then taxels.
// In:  poses (num_instances x num_slots), objects, groups, clusters, quads of triangles, faces, the sensor's patches and tiles.
// Out: contact_normal (num_instances x num_taxels), N, divided by the part of the spread's kernel that stays on the sensor; contact_shear
//      (num_instances x num_taxels x 2), N, likewise; contact_depth (num_instances x num_taxels), m; tile_results (num_instances x num_tiles);
//      loads (num_instances); contact_cells (num_instances x num_taxels), tile_changes (num_instances x num_tiles x LANES), skin/cell_fluxes.glsl.
//      A sensor of one tile writes taxels only inside the window of its result. For a globally coupled law contact_normal holds, instead of forces, the
//      surface height (m, in P) at each solver node, with the slot in its lowest bits (depth/slots.glsl); kMiss without a surface.
// State per sample, between steps: depth, strain and overstresses of a skin that relaxes, shear traction or bristle deflection.
// Shared memory: 4 TILE_SAMPLES + 16 LANES + 4 kClustersPerBatch + 4 GROUPS_PER_BATCH + 4 REPEAT + 64 bytes; friction adds 8 LANES + 512, lockstep
//      16 FACES.
// Deterministic: the tile is a minimum; LANES partial sums are added in a fixed order, whatever the size of the workgroup.
// Twins: src/reference/depth.cpp, contact.cpp, relaxation.cpp, friction.cpp, lugre.cpp, load.cpp.

#include "driver/pairs.glsl"
#include "driver/barrier.glsl"
#include "driver/texels.glsl"
#include "passes/declare.glsl"
#include "passes/contact.h"
#include "passes/contact.glsl"

const float kMiss = kNoHeight;  // height where there is no surface
// Cosine to z of S. Under a patch flatter than this, a surface below z_floor means that a load search has passed through the body.
const float kLooksUp = 0.7;
shared vec4 partial[LANES];
shared uint num_deep;
shared uint any_behind;
shared uint tile_list[REPEAT];
shared uint num_listed_tiles;
shared uint lowest_bits;

#include "common/whole.glsl"
#include "common/transform.glsl"
#include "depth/window.glsl"

float z_base;   // m: what the tile's numbers count from
uint raster_slot = 0;  // of the body on its way into the tile

bool met_behind = false;  // this invocation has met a surface below z_floor

bool isSeen(float z) {
  if (NUM_ROWS > 0) return z < z_limit;
  met_behind = met_behind || z < z_floor;
  return z < z_limit && z >= z_floor;
}

// A loop ended before its work was done: lavapipe ends all loops of an invocation after 65,535 iterations together, silently.
bool cut_short = false;

#include "common/workgroup.glsl"
#include "depth/slots.glsl"
#include "depth/depth_tile.glsl"
#include "depth/polyhedron.glsl"
#include "depth/analytic.glsl"
#include "skin/laws/registry.glsl"

const bool kShears = FRICTION && !kLawSolvedApart;  // else the pass that solves has the shear, and needs the slots

#include "depth/bodies.glsl"
#include "depth/subpixels.glsl"
#include "depth/mesh.glsl"
#include "depth/raster.glsl"

void writeShear(uint taxel, vec2 shear) {
  contact_shear[2 * taxel] = shear.x;
  contact_shear[2 * taxel + 1] = shear.y;
}

#include "depth/heights.glsl"
#include "common/partial_sums.glsl"
#include "skin/relaxation.glsl"
#include "skin/load_search.glsl"
#include "skin/friction.glsl"
#include "skin/laws/lugre.glsl"

float per_dt;  // 1 / the step's time, 1/s, for laws that ask

vec2 tractionAfter(inout vec2 held, vec2 u, float share, float pressure) {
  if (BRISTLES) return pressure * bristleShear(held, u, share, per_dt);
  return held = springTraction(held, u, share, pressure);
}

#include "skin/cell_fluxes.glsl"
#include "depth/tiles.glsl"
#include "depth/touched.glsl"
#include "common/work_lists.glsl"
#include "skin/tile_pressures.glsl"
#include "skin/tile_result.glsl"

// One frame of one tile.
void contactOnTile(uint instance, uint tile_number, uint num_slots) {
  if (!enterTile(instance, tile_number)) return;
  bool load_driven = SEARCH != kNoSearch && (instances[instance].keys.w & kFlagLoadDriven) != 0;
  bool search_here = SEARCH == kSearchInTile && load_driven;
  z_base = -THICKNESS;
  met_behind = false;
  if (gl_LocalInvocationIndex == 0) {
    startBoxes();
    num_deep = 0;
    if (NUM_ROWS == 0) any_behind = 0;
    lowest_bits = kEmpty;
  }
  Reach reach = objectsNear(instance, num_slots);
  if (kLeavesUntouched && !isAny(reach.samples)) {
    leaveUntouched(instance, tile_number, gl_LocalInvocationIndex, WORKGROUP);
    return;
  }
  if (search_here) z_base = clamp(reach.lowest_bound, -1.0, 1.0);
  workgroupBarrier();

  Box samples = rasterHeights(instance, num_slots, reach);
  ActiveTaxels taxels = activeTaxels(samples);
  TileStep step = beginPressures(instance, tile_number, num_slots, reach, taxels, load_driven, search_here);
  pressTaxels(step, taxels);
  clearUntouched(step, taxels);
  writeTileResult(step, taxels, samples);
}

void main() {
  uvec4 batch = step_record.batch;
  uint first = workgroupNumber() * REPEAT;
  uint end = min(first + REPEAT, LIST < kNumLists ? work[LIST].w : batch.x * NUM_TILES);
  uint count = max(first, end) - first;  // of two dimensions of workgroups some are left over
  if (findsNear()) {
    if (gl_LocalInvocationIndex == 0) num_listed_tiles = 0;
    workgroupBarrier();
    for (uint number = first + gl_LocalInvocationIndex; number < end; number += WORKGROUP) {
      uint instance = number / NUM_TILES, tile_number = number - instance * NUM_TILES;
      if (!enterTile(instance, tile_number)) continue;
      if (anyObjectNear(instance, batch.y)) {
        tile_list[atomicAdd(num_listed_tiles, 1u)] = number;
      } else {
        leaveUntouched(instance, tile_number, 0, 1);
      }
    }
    workgroupBarrier();
    count = num_listed_tiles;
  }
  if (usesTile() && count > 0) {
    clearTile();
    workgroupBarrier();
  }
  uint k = 0;
  for (; k < count; ++k) {
    uint number = findsNear() ? tile_list[k] : first + k;
    if (LIST < kNumLists) number = work_instances[placeInList(LIST, number)];  // of sensors of one tile
    uint instance = number / NUM_TILES;
    contactOnTile(instance, number - instance * NUM_TILES, batch.y);
    workgroupBarrier();
  }
  if (cut_short || k < count) problems[0] = 1;
}
