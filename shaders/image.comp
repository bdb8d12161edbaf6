#version 460
#extension GL_GOOGLE_include_directive : require
// Image pass: stages 3 (spread), 4 (time), 5 (readout) and 6 (features) of one frame.
//
// A workgroup has WORKGROUP / TEAM teams; each team processes REPEAT instances in sequence. An invocation owns rows of taxels, so that it fetches the sources of
// a row once. On a software driver a team is one invocation, and a vector of the driver computes the features of as many instances as it has lanes.
// In:  contact_normal (num_instances x num_taxels), N; contact_shear (num_instances x num_taxels x 2), N; tile_results (num_instances x num_tiles); the
//      spread's kernel or lists.
// Out: image (num_instances x num_taxels), counts; spread_normal, N, and spread_shear, N, of the same shapes as their inputs; features (block after block,
//      shared/features.h).
// State: taxel_states (num_instances x states x num_taxels), readout/lag.glsl; image_windows (num_instances).
// Shared memory: 4 PARTIALS bytes.
// Deterministic: sums run over at most LANES partial sums in a fixed order, whatever the size of team and workgroup.
// Mutable globals: any_unfinished_loop (driver/loop_limit.glsl).
// Twins: src/reference/psf.cpp, lag.cpp, imperfections.cpp, readout.cpp, features.cpp.

#include "shared/batch.h"
#include "shared/features.h"
#include "shared/random.h"
#include "shared/sensor.h"
#include "common/specialization.glsl"
layout(constant_id = 11) const bool SHEAR = false;        // spread shear as well
layout(constant_id = 12) const uint NUM_ENTRIES = 9;      // of a taxel's list of sources, where the sensor is not one grid patch
layout(constant_id = 13) const bool OUTPUT_NORMAL = true;  // spread_normal is wanted, outside contact too
layout(constant_id = 14) const bool TAXELS_ALIKE = true;  // gain 1 and the sensor's trigger everywhere
layout(constant_id = 15) const int CURVE_DEGREE = 1;
layout(constant_id = 16) const float CURVE_SLOPE = 2400.0;  // at 0, counts/N
layout(constant_id = 17) const float OUTPUT_SCALE = 1.0;
layout(constant_id = 18) const float TRIGGER = 0.02;      // N
layout(constant_id = 19) const float SATURATION = 4095.0;  // counts
layout(constant_id = 20) const float NOISE = 0.0;         // counts
layout(constant_id = 21) const bool RANDOM = false;      // some instance draws noise or gains
layout(constant_id = 22) const uint TEAM = 1;            // invocations of an instance
layout(constant_id = 23) const uint PARTIALS = 1;        // kNumSums LANES for every team of more than one invocation
layout(constant_id = 24) const uint NUM_HYSTERESIS = 0;  // elements
layout(constant_id = 25) const uint NUM_CREEP = 0;       // terms
layout(constant_id = 26) const bool LOW_PASS = false;
layout(constant_id = 27) const bool DELAY = false;
layout(constant_id = 28) const bool RANDOM_WALK = false;
layout(constant_id = 29) const float BIAS = 0.0;         // counts
layout(constant_id = 30) const float DEAD_TAXELS = 0.0;  // probability
layout(constant_id = 31) const bool WHOLE_ARRAY = false;  // taxels that no object reaches may have a force
layout(constant_id = 32) const bool TURNS_SHEAR = false;  // on its way along the skin, readout/spread.glsl
layout(constant_id = 33) const float CURVE_LIMIT = 0.0;   // counts; 0: none
layout(constant_id = 34) const int CURVE_PIECES = 0;      // 0: a polynomial
layout(constant_id = 35) const bool KEEPS_WINDOW = true;  // every step has a frame, so outside of the window of the step before all is 0

layout(std430, set = 0, binding = 0) readonly buffer Instances { InstanceRecord instances[]; };
layout(std430, set = 0, binding = 1) readonly buffer Step { StepRecord step_record; };
layout(std430, set = 0, binding = 2) readonly buffer SensorBlock { SensorRecord sensor; };
layout(std430, set = 0, binding = 3) readonly buffer Taxels { TaxelRecord taxels[]; };
layout(std430, set = 0, binding = 4) readonly buffer SpreadRows { vec4 spread_rows[]; };
layout(std430, set = 0, binding = 5) readonly buffer ContactNormal { float contact_normal[]; };
layout(std430, set = 0, binding = 6) readonly buffer ContactShear { float contact_shear[]; };
layout(std430, set = 0, binding = 7) readonly buffer TileResults { TileResult tile_results[]; };
layout(std430, set = 0, binding = 8) readonly buffer Loads { LoadRecord loads[]; };
layout(std430, set = 0, binding = 9) writeonly buffer Image { uint image[]; };
layout(std430, set = 0, binding = 10) writeonly buffer SpreadNormal { float spread_normal[]; };
layout(std430, set = 0, binding = 11) writeonly buffer SpreadShear { float spread_shear[]; };
layout(std430, set = 0, binding = 12) writeonly buffer Features { float features[]; };
layout(std430, set = 0, binding = 13) writeonly buffer Problems { uint problems[]; };
layout(std430, set = 0, binding = 14) buffer TaxelStates { float taxel_states[]; };
layout(std430, set = 0, binding = 15) buffer ImageWindows { uvec4 image_windows[]; };  // of the step before: first row and column, their numbers

#include "common/workgroup.glsl"
#include "common/whole.glsl"
#include "common/philox.glsl"
#include "driver/loop_limit.glsl"
#include "readout/image_window.glsl"
#include "readout/spread.glsl"
#include "readout/lag.glsl"
#include "readout/imperfections.glsl"
#include "readout/readout.glsl"
#include "features/image_sums.glsl"
#include "readout/taxel.glsl"
#include "features/moments.glsl"
#include "features/image_features.glsl"

// Reads out all rows of the window. Returns the sums over the instance, the same for every invocation of its team. `num_parts`: partial sums of the team.
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

// All teams execute the same barriers; a team without an instance of its own (`is_valid` false) writes nothing.
void processInstance(uint number, bool is_valid, uint num_instances, Kernel kernel, Lag lag, uvec2 seed) {
  uint lane = gl_LocalInvocationIndex % TEAM;
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
  for (; r < REPEAT; ++r, number += kTeams) processInstance(min(number, batch.x - 1), number < batch.x, batch.x, kernel, lag, batch.zw);
  checkLoop(r < REPEAT);
  reportUnfinishedLoops();
}
