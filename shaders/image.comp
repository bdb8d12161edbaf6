#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
// Image pass: stages 3 (spread), 4 (time), 5 (readout) and 6 (features) of one frame.
//
// A workgroup has WORKGROUP / TEAM teams; each team processes REPEAT instances in sequence. An invocation owns rows of taxels, so that it
// fetches the sources of a row once. A team may be one invocation (driver/README.md).
// In:  contact_normal (num_instances x num_taxels), N; contact_shear (num_instances x num_taxels x 2), N; tile_results (num_instances x
//      num_tiles); the spread's kernel or lists.
// Out: image (num_instances x num_taxels), counts; spread_normal, N, and spread_shear, N, of the same shapes as their inputs; features
//      (block after block, shared/features.h).
// State: taxel_states (num_instances x states x num_taxels), readout/lag.glsl; image_windows (num_instances).
// Shared memory: 4 PARTIALS bytes.
// Deterministic: sums run over at most LANES partial sums in a fixed order, whatever the size of team and workgroup.
// Mutable globals: any_unfinished_loop (driver/loops.glsl).
// References: src/reference/psf.cpp, lag.cpp, imperfections.cpp, readout.cpp, features.cpp.

#include "shared/features.h"
#include "shared/random.h"
#include "passes/declare.glsl"
#include "passes/image.h"

#include "common/instances.glsl"
#include "driver/arithmetic.glsl"
#include "common/philox.glsl"
#include "driver/loops.glsl"

const uint kContactMargin = MARGIN, kSpreadRadius = KERNEL / 2;
#include "readout/image_window.glsl"
#include "readout/spread.glsl"
#include "readout/clear_outside.glsl"
#include "readout/lag.glsl"
#include "readout/imperfections.glsl"
#include "readout/readout.glsl"
#include "features/image_sums.glsl"
#include "readout/taxel.glsl"
#include "features/moments.glsl"
#include "features/image_features.glsl"

// Reads out all rows of the window. Returns the sums over the instance, the same for every invocation of its team. `num_parts`: partial
// sums of the team.
ImageSums readImage(Instance instance, Kernel kernel, Lag lag, uint lane, uint num_parts, uvec2 seed) {
  ImageSums total = noSums();
  uint first_partial = gl_LocalInvocationIndex / TEAM * kNumSums * LANES;
  for (uint v = lane * kRowsAtOnce; v < num_parts; v += TEAM * kRowsAtOnce) {
    ImageSums part = noSums(), next_part = noSums();
    uint i = v;
    for (; i < instance.window.count.x; i += LANES) readRows(instance, kernel, lag, i, seed, part, next_part);
    checkLoop(i < instance.window.count.x);
    if (TEAM == 1) {
      addSums(total, part);
      addSums(total, next_part);
    } else {
      storePartial(first_partial, v, part);
    }
  }
  if (TEAM > 1) {
    barrier();
    for (uint v = 0; v < num_parts; ++v) addPartial(first_partial, v, total);
    barrier();
  }
  return total;
}

// All teams execute the same barriers; a team without an instance (`is_valid` false), or with a held one, writes nothing.
void processInstance(uint number, bool is_valid, uint num_instances, Kernel kernel, Lag lag, uvec2 seed) {
  uint lane = gl_LocalInvocationIndex % TEAM;
  is_valid = is_valid && !isHeld(number);
  Instance instance = loadInstance(number);
  if (is_valid) clearOutside(number, lane, instance.window, instance.new_frame);
  ImageSums total = readImage(instance, kernel, lag, lane, is_valid ? min(LANES, instance.window.count.x) : 0, seed);
  if (!is_valid || lane > 0) return;
  if (kOnePatch && KEEPS_WINDOW) image_windows[number] = uvec4(instance.window.first, instance.window.count);
  if (instance.new_frame) {
    writeImageFeatures(0, instance, num_instances, total.measured);
    features[kFeatureSaturated * num_instances + number] = total.num_saturated / float(NUM_TAXELS);
  }
  writeImageFeatures(kNumImageFeatures, instance, num_instances, total.clean);
  writeContactResults(instance, num_instances);
}

void main() {
  uvec4 batch = step_record.batch;
  Kernel kernel = loadKernel();
  Lag lag = loadLag();
  const uint kTeams = WORKGROUP / TEAM;
  uint number = workgroupNumber() * REPEAT * kTeams + gl_LocalInvocationIndex / TEAM;
  uint r = 0;
  do {
    processInstance(min(number, batch.x - 1), number < batch.x, batch.x, kernel, lag, batch.zw);
    number += kTeams;
  } while (++r < REPEAT);
  checkLoop(r < REPEAT);
  reportUnfinishedLoops();
}
