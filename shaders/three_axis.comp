#version 460
#extension GL_GOOGLE_include_directive : require
// Readout of three-axis taxels, option: forces after the spread to signed counts along x, y and the normal of each taxel.
// include/taxelsim/three_axis_readout.h.
//
// An invocation owns a taxel of one instance.
// In:  spread_normal (num_instances x num_taxels) and spread_shear (num_instances x num_taxels x 2), N.
// Out: taxel_counts (num_instances x num_taxels x 3), counts.
// State: axis_plays (num_instances x 3 x num_taxels), N: the play operators of the hysteresis.
// Shared memory: none.
// Reference: src/reference/three_axis.cpp.

#include "shared/random.h"
#include "passes/declare.glsl"
#include "passes/three_axis.h"

#include "common/instances.glsl"
#include "common/philox.glsl"

// A play operator follows the force at a distance of at most its width; a sensor starts unloaded.
vec3 hysteresis(uint instance, uint taxel, vec3 force) {
  vec3 width = vec3(WIDTH_X, WIDTH_Y, WIDTH_Z), strength = vec3(STRENGTH_X, STRENGTH_Y, STRENGTH_Z);
  bool is_first = (instanceRecord(instance).keys.w & kFlagFirstStep) != 0;
  vec3 play = vec3(0);
  for (uint a = 0; a < 3; ++a) {
    uint at = (instance * 3 + a) * NUM_TAXELS + taxel;
    play[a] = max(force[a] - width[a], min(force[a] + width[a], is_first ? 0.0 : axis_plays[at]));
    axis_plays[at] = play[a];
  }
  return force + strength * (play - force);
}

float gainOf(uint instance, uint taxel) {
  vec4 drive = instanceRecord(instance).drive;
  float gain = drive.y * taxels[taxel].readout.x;
  if (RANDOM && drive.z > 0.0)
    gain *= exp(drive.z * gaussian(step_record.batch.zw, instanceRecord(instance).keys.xy, 0, taxel, kPurposeTaxelGain));
  return gain;
}

vec3 noiseOf(uint instance, uint taxel) {
  vec3 level = vec3(NOISE_X, NOISE_Y, NOISE_Z);
  uvec4 keys = instanceRecord(instance).keys;
  vec3 noise = vec3(0);
  for (uint a = 0; a < 3; ++a) {
    if (level[a] > 0.0) noise[a] = level[a] * gaussian(step_record.batch.zw, keys.xy, keys.z, taxel, kPurposeAxisNoise + a);
  }
  return noise;
}

void main() {
  uint number = workgroupNumber() * WORKGROUP + gl_LocalInvocationIndex;
  uint instance = number / NUM_TAXELS;
  if (!isProcessed(instance)) return;
  uint taxel = number - instance * NUM_TAXELS;
  vec3 force = hysteresis(instance, taxel, vec3(spread_shear[2 * number], spread_shear[2 * number + 1], spread_normal[number]));
  if (!hasNewValues(instance, false)) return;
  vec3 signal = vec3(dot(vec3(GAIN_XX, GAIN_XY, GAIN_XZ), force), dot(vec3(GAIN_YX, GAIN_YY, GAIN_YZ), force),
                     dot(vec3(GAIN_ZX, GAIN_ZY, GAIN_ZZ), force));
  vec3 counts = gainOf(instance, taxel) * signal + noiseOf(instance, taxel);
  counts = clamp(floor(counts + 0.5), -SATURATION, SATURATION);
  for (uint a = 0; a < 3; ++a) taxel_counts[3 * number + a] = int(counts[a]);
}
