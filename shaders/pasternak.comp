#version 460
#extension GL_GOOGLE_include_directive : require
// Two-parameter foundation pass: stage 2 (contact law) of one frame for the law `pasternak`, with its load search.
//
// A workgroup owns an instance; an invocation owns nodes. Every frame starts from the object's surface, so that it depends on nothing but the pose.
// In:  heights (num_instances x num_nodes), m, and windows (num_instances x NUM_HEIGHT_TILES), from the contact pass.
// Out: contact_normal (num_instances x num_taxels), N; contact_depth (num_instances x num_taxels), m; tile_results (num_instances); loads (num_instances).
// Shared memory: 16 LANES + 16 bytes.
// Deterministic: nodes of one colour move independently; sums run over LANES partial sums in a fixed order, whatever the size of the workgroup.
// Mutable globals: any_unfinished_loop (driver/loop_limit.glsl).
// Twin: src/reference/pasternak.cpp.

#include "driver/pairs.glsl"
#include "driver/barrier.glsl"
#include "driver/texels.glsl"
#include "shared/batch.h"
#include "shared/features.h"
#include "shared/sensor.h"
#include "passes/declare.glsl"
#include "passes/pasternak.h"

const float kMiss = kNoHeight;  // height where there is no surface

#include "common/whole.glsl"
#include "common/workgroup.glsl"
#include "common/instances.glsl"
#include "common/partial_sums.glsl"
#include "driver/loop_limit.glsl"
#include "pasternak/nodes.glsl"
#include "pasternak/solver.glsl"
#include "pasternak/outputs.glsl"

// The depth of the lowest node at which all nodes carry a load (N), by the Illinois variant of regula falsi. Returns a status, and leaves the contact at the
// depth in `surface`, `window` and `sums`.
float searchLoad(uint instance, float load, inout Surface surface, out Window window, out vec4 sums) {
  const int kMaxEvaluations = 24;
  const float kTolerance = 2e-6;  // of the load; some ten roundings of a float
  const float kAccepted = 1e-3;   // of the load, where no depth in a float is nearer
  surface.depth = load > 0.0 ? THICKNESS : 0.0;
  sums = solveContact(instance, surface, window);
  float low = 0.0, high = THICKNESS, low_excess = -load, high_excess = sums.x - load;
  if (load <= 0.0) return kLoadCarried;
  if (high_excess < -kTolerance * load) return kLoadOutOfReach;
  int side = 0;
  float excess = high_excess;
  for (int n = 1; n < kMaxEvaluations && abs(excess) > kTolerance * load; ++n) {
    surface.depth = clamp(low - (high - low) * (low_excess / (high_excess - low_excess)), low, high);
    sums = solveContact(instance, surface, window);
    excess = sums.x - load;
    if (excess > 0.0) {
      high = surface.depth;
      high_excess = excess;
      if (side > 0) low_excess *= 0.5;
      side = 1;
    } else {
      low = surface.depth;
      low_excess = excess;
      if (side < 0) high_excess *= 0.5;
      side = -1;
    }
  }
  return abs(excess) <= kAccepted * load ? kLoadCarried : kLoadOutOfReach;
}

void solveInstance(uint instance, uint num_instances) {
  if (isHeld(instance)) return;
  bool by_load = LOADS && (instances[instance].keys.w & kFlagLoadDriven) != 0;
  Surface surface = Surface(instance * kNodes.x * kNodes.y, reachedNodes(instance), 0.0, 0.0);
  Window window = Window(uvec2(0), uvec2(0));
  vec4 sums = vec4(0);
  if (by_load) {
    float lowest = lowestHeight(surface), status = kLoadOutOfReach, offset = 0.0;
    if (lowest < kMiss) {
      surface.origin = lowest;
      status = searchLoad(instance, instances[instance].drive.x, surface, window, sums);
      offset = -lowest - surface.depth;
    }
    if (gl_LocalInvocationIndex == 0) loads[instance] = LoadRecord(vec4(offset, 0, 0, status), vec4(0));
  } else {
    sums = solveContact(instance, surface, window);
  }
  writeResults(instance, num_instances, sums, writeTaxels(instance, surface, window));
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
