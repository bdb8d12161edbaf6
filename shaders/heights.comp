#version 460
#extension GL_GOOGLE_include_directive : require
// Heights pass: stage 1 of one frame for the law `elastic_layer`, whose pass elastic_layer.comp solves for the pressures of all nodes at
// once. A taxel of this pass is a node of the layer, with one sample. With AREA the pass runs a second time and writes node_cells, which
// describe the part of a node's cell that an object covers.
//
// A workgroup owns REPEAT tiles in sequence; tile number = instance NUM_TILES + tile of the layer. An invocation owns boxes, then quads,
// then nodes.
// In:  poses (num_instances x poses of the step), objects, groups, clusters, quads of triangles, faces, the layer's patch and tiles.
// Out: heights (num_instances x num_nodes), m, in P, with the slot in the lowest bits (depth/slots.glsl), kNoHeight without a surface; with
//      AREA node_cells (num_instances x num_nodes x kNodeCellWords) instead. windows (num_instances x NUM_TILES): the nodes under objects,
//      of both runs with AREA. Heights outside a window may be undefined on a layer of one tile.
// Shared memory: 4 TILE_SAMPLES (17 with AREA, 25 with ONE_VECTOR or MANY_SLOTS, too) + 4 kClustersPerBatch + 4 GROUPS_PER_BATCH
//      + 4 REPEAT + 56 bytes; ONE_VECTOR 16 NUM_FACES, AREA with meshes 4 kMostFacets.
// Deterministic: the tile is a minimum of integers, which sum cells.
// Mutable globals: any_unfinished_loop, num_iterations (driver/loops.glsl); the planes of a polyhedron (depth/solids.glsl).
// References: src/reference/depth.cpp, layer_cells.cpp.

#include "passes/declare.glsl"
#include "passes/depth.h"
#include "passes/heights.h"

const bool OUTPUT_JACOBIAN = false;  // elastic_layer/jacobian.glsl computes it
const bool kAllHeights = true;       // the Jacobian reads heights over the reach, too
const uint MOST_ITERATIONS = 0u;     // no second dispatch

#include "common/instances.glsl"
#include "depth/area/node_cells.glsl"
#include "depth/heights.glsl"
#include "depth/tile_sequence.glsl"

// Nodes of a patch: first row, end row, first column, end column.
uvec4 windowOf(Tile tile, Box samples) {
  if (!isAny(samples)) return uvec4(0);
  return uvec4(uvec2(samples.first) + tile.first_taxel, uvec2(samples.last) + 1u + tile.first_taxel).xzyw;
}

void writeNode(Tile tile, OnlyObject only, uint node, uvec2 in_patch, inout Found found) {
  uvec2 in_tile = in_patch - tile.first_taxel;
  uint address = in_tile.x * tile.stride + in_tile.y, word;
  vec2 position = samplePosition(tile, vec2(in_patch));
  if (!usesTile() && kOnlyPolyhedra) startRow(position.x);
  float height = sampleHeight(tile, only, address, position, found, word);
  if (AREA) {
    node_cells[kNodeCellWords * node] = withSlot(-tile.offset_z - depthOfWord(word), slotOf(word));
    node_cells[kNodeCellWords * node + 1u] = word >= kNoDepth ? 0u : cell_shares[address];
    node_cells[kNodeCellWords * node + 2u] = cell_variations[address];
  } else {
    heights[node] = height >= kNoHeight ? floatBitsToUint(kNoHeight) : withSlot(tile.z_base + height, slotOf(word));
  }
}

// Writes the nodes inside the window of a tile; clears the others where elastic_layer.comp may read them.
void writeNodes(Tile tile, OnlyObject only, uint first_node, uvec4 window, inout Found found) {
  uvec2 first = window.xz, count = window.yw - window.xz;
  uint k = gl_LocalInvocationIndex, num_nodes = count.x * count.y;
  if (num_nodes > 0) do {
      if (k < num_nodes) {
        uvec2 at = first + cellNumbered(k, count.y);
        writeNode(tile, only, first_node + at.x * tile.grid.y + at.y, at, found);
      }
      k += WORKGROUP;
    } while (k - gl_LocalInvocationIndex < num_nodes);
  checkLoop(k < num_nodes);
  if (NUM_TILES == 1 && !HAS_CELLS) return;
  for (uint n = gl_LocalInvocationIndex; n < tile.size.x * tile.size.y; n += WORKGROUP) {
    uvec2 at = tile.first_taxel + cellNumbered(n, tile.size.y);
    uint node = first_node + at.x * tile.grid.y + at.y;
    if (isInside(at, window)) continue;
    if (AREA) node_cells[kNodeCellWords * node + 1u] = 0;
    if (!AREA) heights[node] = floatBitsToUint(kNoHeight);
  }
}

void writeWindow(uint number, uvec4 window) {
  if (gl_LocalInvocationIndex != 0) return;
  if (AREA) {
    uvec4 before = windows[number];
    if (window.x == window.y) window = before;
    if (before.x < before.y) window = uvec4(min(window.xz, before.xz), max(window.yw, before.yw)).xzyw;
  }
  windows[number] = window;
}

// One frame of one tile.
void computeTile(uint number, uint num_slots) {
  uint instance = number / NUM_TILES;
  if (isHeld(instance)) return;
  Tile tile = loadTile(number - instance * NUM_TILES);
  tile.z_base = -THICKNESS;
  bool by_load = SEARCH == kSearchInTile && (instanceRecord(instance).keys.w & kFlagLoadDriven) != 0;
  if (by_load) tile.z_limit = kNoHeight;
  if (gl_LocalInvocationIndex == 0) startBoxes();
  Reach reach = objectsNear(tile, instance, num_slots);
  if (AREA && by_load) lowerObjects(tile, instance, num_slots, reach);
  if (by_load) tile.z_base = clamp(reach.lowest_bound, -1.0, 1.0);
  workgroupBarrier();

  Found found = Found(noSamples(), false, 0u);
  Box samples = rasterHeights(tile, instance, num_slots, reach, found);
  uvec4 window = windowOf(tile, samples);
  writeNodes(tile, onlyObject(reach, instance * num_slots, false), instance * NUM_TAXELS, window, found);
  workgroupBarrier();
  if (usesTile() && REPEAT > 1) clearSamples(tile, samples);
  writeWindow(number, window);
}

void main() {
  uvec2 range = tileRange();
  if (usesTile() && range.x < range.y) {
    clearHeights();
    workgroupBarrier();
  }
  uint k = range.x;
  if (k < range.y) do {
      computeTile(tileNumbered(k), step_record.batch.y);
      workgroupBarrier();
    } while (++k < range.y);
  checkLoop(k < range.y);
  reportUnfinishedLoops();
}
