#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
// Two-parameter foundation pass for sensors of several patches: stage 2 (contact law) of one frame for the law `pasternak`. Loads are searched by load.comp.
//
// A workgroup owns an instance; an invocation owns nodes, then blocks, taxels and patches. Every frame starts from the object's surface.
// In:  heights (num_instances x num_nodes), m, over the skin, and windows (num_instances x NUM_HEIGHT_TILES), from the contact pass, with area sampling node_cells
//      (num_instances x num_nodes x kNodeCellWords); tables of nodes, links and blocks (shared/linked_foundation.h).
// Out: contact_normal (num_instances x num_taxels), N; contact_depth (num_instances x num_taxels), m; tile_results (num_instances x num_tiles), a tile is a
//      patch.
// Shared memory: 8 NUM_TAXELS BLOCKS_PER_TAXEL + 12 bytes.
// Deterministic: nodes of one color do not read each other; sums run over the nodes of a block, the blocks of a taxel and of a patch in order.
// Mutable globals: any_unfinished_loop (driver/loop_limit.glsl).
// Twins: src/reference/linked_foundation.cpp, foundation_cells.cpp.

#include "driver/pairs.glsl"
#include "driver/barrier.glsl"
#include "shared/batch.h"
#include "shared/features.h"
#include "shared/sensor.h"
#include "shared/elastic_layer.h"
#include "shared/linked_foundation.h"
#include "passes/declare.glsl"
#include "passes/linked_foundation.h"

const float kMiss = kNoHeight;  // height where there is no surface

#include "common/whole.glsl"
#include "common/workgroup.glsl"
#include "common/instances.glsl"
#include "driver/loop_limit.glsl"
#include "common/node_cells.glsl"
#include "common/cut_links.glsl"
#include "linked_foundation/arrays.glsl"
#include "linked_foundation/nodes.glsl"
#include "linked_foundation/active_blocks.glsl"
#include "linked_foundation/links.glsl"
#include "linked_foundation/solver.glsl"
#include "linked_foundation/outputs.glsl"

// Whether the load search of an instance has ended: its results stay.
bool hasEnded(uint instance) {
  if (!LOADS) return false;
  float status = loads[instance].bracket.w;
  return status == kLoadCarried || status == kLoadOutOfReach;
}

// Whether a load search continues above the offset that it tries, whatever the force there is.
bool isAboveThis(uint instance) {
  if (!LOADS || is_too_deep == 0 || (instanceRecord(instance).keys.w & kFlagLoadDriven) == 0) return false;
  float status = loads[instance].bracket.w;
  return status == kLoadSearching || status == kLoadRefining;
}

void solveInstance(uint instance, uint num_instances) {
  if (isHeld(instance) || hasEnded(instance)) return;
  startBlocks(instance);
  if (isAboveThis(instance)) {
    writeTooDeep(instance);
    return;
  }
  if (AREA) cutLinks(instance);
  solveContact(instance);
  sumBlocks(instance);
  writeTaxels(instance);
  writeResults(instance, num_instances);
}

void main() {
  uvec4 batch = step_record.batch;
  uint first = workgroupNumber() * REPEAT;
  uint end = min(first + REPEAT, batch.x);
  uint instance = first;
  for (; instance < end; ++instance) {
    solveInstance(instance, batch.x);
    workgroupBarrierWithBuffers();
  }
  checkLoop(instance < end);
  reportUnfinishedLoops();
}
