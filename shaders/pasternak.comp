#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
// Two-parameter foundation pass: stage 2 (contact law) of one frame for the law `pasternak`, with its load search.
//
// A workgroup owns instances, one after another; an invocation owns blocks of nodes. Every frame starts from the object's surface, so that it depends on nothing
// but the pose.
// In:  heights (num_instances x num_nodes), m, and windows (num_instances x NUM_HEIGHT_TILES), from the contact pass, with area sampling node_cells
//      (num_instances x num_nodes x kNodeCellWords).
// Out: contact_normal (num_instances x num_taxels), N; contact_depth (num_instances x num_taxels), m; tile_results (num_instances); loads (num_instances).
// Shared memory: 16 LANES + 12 kNumBlocks + 56 bytes.
// Deterministic: a sweep of a block writes another array than it reads; blocks that a sweep skips would not change; sums run over LANES partial sums in a fixed
// order, whatever the size of the workgroup.
// Mutable globals: any_unfinished_loop (driver/loop_limit.glsl).
// Twins: src/reference/pasternak.cpp, foundation_cells.cpp.

#include "driver/pairs.glsl"
#include "driver/barrier.glsl"
#include "driver/vector_sums.glsl"
#include "shared/batch.h"
#include "shared/features.h"
#include "shared/sensor.h"
#include "shared/elastic_layer.h"
#include "passes/declare.glsl"
#include "passes/pasternak.h"

const float kMiss = kNoHeight;  // height where there is no surface

#include "common/whole.glsl"
#include "common/workgroup.glsl"
#include "common/instances.glsl"
#include "common/partial_sums.glsl"
#include "driver/loop_limit.glsl"
#include "common/node_cells.glsl"
#include "common/cut_links.glsl"
#include "pasternak/nodes.glsl"
#include "pasternak/arrays.glsl"
#include "pasternak/cells.glsl"
#include "pasternak/blocks.glsl"
#include "pasternak/solver.glsl"
#include "pasternak/outputs.glsl"

// Load search: the depth of the lowest node at which all nodes carry a load, by the Illinois variant of regula falsi from full depth.
struct Search {
  float load;                     // N; 0 without a load
  float low, high;                // bracket of the depth, m
  float low_excess, high_excess;  // force less load at its ends, N; one is halved where it stays
  float excess;                   // at the last depth
  float side;                     // of the last depth: 1 carries too much, -1 too little
};

const int kMaxEvaluations = 24;
const float kTolerance = 2e-6;  // of the load; some ten roundings of a float
const float kAccepted = 1e-3;   // of the load, where no depth in a float is nearer

// Takes the force at the last depth. Returns false at the end.
bool takeForce(inout Search search, int evaluation, float depth, float force) {
  float excess = force - search.load;
  search.excess = excess;
  if (search.load <= 0.0 || abs(excess) <= kTolerance * search.load) return false;
  if (evaluation == 0) {
    search.high_excess = excess;
    return excess > 0.0;
  }
  float side = excess > 0.0 ? 1.0 : -1.0;
  bool again = side == search.side;
  if (excess > 0.0) {
    search.high = depth;
    search.high_excess = excess;
    if (again) search.low_excess *= 0.5;
  } else {
    search.low = depth;
    search.low_excess = excess;
    if (again) search.high_excess *= 0.5;
  }
  search.side = side;
  return true;
}

float nextDepth(Search search) {
  float share = search.low_excess / (search.high_excess - search.low_excess);
  return clamp(search.low - (search.high - search.low) * share, search.low, search.high);
}

void solveInstance(uint instance, uint num_instances) {
  if (isHeld(instance)) return;
  bool by_load = LOADS && (instanceRecord(instance).keys.w & kFlagLoadDriven) != 0;
  Surface surface = Surface(instance * kNodes.x * kNodes.y, instance * NUM_HEIGHT_TILES, 0.0, 0.0);
  Search search = Search(0.0, 0.0, THICKNESS, 0.0, 0.0, 0.0, 0.0);
  bool no_surface = false;
  if (by_load) {
    float lowest = lowestHeight(surface);
    no_surface = lowest >= kMiss;
    if (!no_surface) surface.origin = lowest;
    search.load = no_surface ? 0.0 : instanceRecord(instance).drive.x;
    search.low_excess = -search.load;
    if (search.load > 0.0) surface.depth = THICKNESS;
  }
  vec4 sums;
  for (int n = 0; n < (LOADS ? kMaxEvaluations : 1); ++n) {
    if (n > 0) surface.depth = nextDepth(search);
    sums = solveContact(surface);
    if (!takeForce(search, n, surface.depth, sums.x)) break;
  }
  if (by_load && gl_LocalInvocationIndex == 0) {
    bool carried = !no_surface && (search.load <= 0.0 || abs(search.excess) <= kAccepted * search.load);
    float offset = no_surface ? 0.0 : -surface.origin - surface.depth;
    loads[instance] = LoadRecord(vec4(offset, 0, 0, carried ? kLoadCarried : kLoadOutOfReach), vec4(0));
  }
  writeResults(instance, num_instances, sums, writeTaxels(instance, surface));
}

void main() {
  uvec4 batch = step_record.batch;
  uint instance = workgroupNumber();
  for (; instance < batch.x; instance += gl_NumWorkGroups.x * gl_NumWorkGroups.y) {
    solveInstance(instance, batch.x);
    workgroupBarrierWithBuffers();
  }
  checkLoop(instance < batch.x);
  reportUnfinishedLoops();
}
