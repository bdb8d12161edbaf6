#version 460
#extension GL_GOOGLE_include_directive : require
// Image pass: stages 3 (spread), 4 (frame-rate hold), 5 (readout) and 6 (features) of one frame.
//
// A workgroup owns one instance, an invocation owns taxels.
// In:  contact_normal (num_instances x num_taxels), N; contact_shear; tile_results; the spread's entries (entries x num_taxels).
// Out: image (num_instances x num_taxels), counts; spread_normal, N, and spread_shear alike; features (block after block, layout.h).
// Shared memory: 4 (NUM_SUMS LANES + kNumFeatures + NUM_SUMS) bytes.
// Deterministic: sums run over LANES partial sums in a fixed order, whatever the size of the workgroup.
// Twins: src/reference/psf.cpp, readout.cpp, features.cpp.

#include "shared/layout.h"

layout(local_size_x_id = 0) in;
layout(constant_id = 0) const uint WORKGROUP = 8;
layout(constant_id = 1) const uint LANES = 16;         // partial sums
layout(constant_id = 2) const uint SHEAR = 0;          // spread shear as well
layout(constant_id = 3) const uint MARGIN = 1;         // taxels by which the spread widens a contact; on one patch only
layout(constant_id = 4) const uint ONE_PATCH = 1;      // the sensor is one grid patch, so that only a window of it need be read
layout(constant_id = 5) const uint SAMPLES = 4;        // per taxel and side

layout(std430, set = 0, binding = 0) readonly buffer Instances { InstanceRecord instances[]; };
layout(std430, set = 0, binding = 1) readonly buffer Step { StepRecord step_record; };
layout(std430, set = 0, binding = 2) readonly buffer SensorBlock { SensorRecord sensor; };
layout(std430, set = 0, binding = 3) readonly buffer Patches { PatchRecord patches[]; };
layout(std430, set = 0, binding = 4) readonly buffer Tiles { TileRecord tiles[]; };
layout(std430, set = 0, binding = 5) readonly buffer Taxels { TaxelRecord taxels[]; };
layout(std430, set = 0, binding = 6) readonly buffer SpreadEntries { vec2 spread_entries[]; };  // source taxel (bits), weight
layout(std430, set = 0, binding = 7) readonly buffer ContactNormal { float contact_normal[]; };
layout(std430, set = 0, binding = 8) readonly buffer ContactShear { float contact_shear[]; };
layout(std430, set = 0, binding = 9) readonly buffer TileResults { TileResult tile_results[]; };
layout(std430, set = 0, binding = 10) readonly buffer Loads { LoadRecord loads[]; };
layout(std430, set = 0, binding = 11) buffer Image { uint image[]; };
layout(std430, set = 0, binding = 12) buffer SpreadNormal { float spread_normal[]; };
layout(std430, set = 0, binding = 13) writeonly buffer SpreadShear { float spread_shear[]; };
layout(std430, set = 0, binding = 14) writeonly buffer Features { float features[]; };

// Sums per image: force, first moments (3), second moments (3), peak, area; two images, and the saturated taxels.
const uint kSumsPerImage = 9u;
const uint NUM_SUMS = 19u;

shared float partial[NUM_SUMS * LANES];
shared float sums[NUM_SUMS];
shared float shared_features[kNumFeatures];

#include "lib/workgroup.glsl"
#include "lib/philox.glsl"
#include "lib/readout.glsl"
#include "lib/moments.glsl"

// The part of the sensor that forces can reach: of a grid patch a rectangle, else all taxels.
uvec2 window_first, window_count;

uint taxelInWindow(uint k) {
  if (ONE_PATCH == 0) return k;
  return (window_first.x + k / window_count.y) * patches[0].grid.y + window_first.y + k % window_count.y;
}

void findWindow(uint instance, bool everything) {
  window_first = uvec2(0);
  window_count = ONE_PATCH == 0 ? uvec2(1, sensor.counts.x) : patches[0].grid.xy;
  if (ONE_PATCH == 0 || everything) return;
  uvec2 first = uvec2(0xFFFFFFFFu), end = uvec2(0);
  for (uint t = 0; t < sensor.counts.y; ++t) {
    uvec4 reached = tile_results[instance * sensor.counts.y + t].window;
    if (reached.y <= reached.x) continue;
    first = min(first, reached.xz);
    end = max(end, reached.yw);
  }
  if (end.x == 0) {
    window_count = uvec2(0);
    return;
  }
  first -= min(first, uvec2(MARGIN));
  end = min(end + MARGIN, window_count);
  window_first = first;
  window_count = end - first;
}

// Sum k of the partial sums, in a fixed order.
float foldedSum(uint k) {
  bool is_peak = k == 7u || k == kSumsPerImage + 7u;
  float total = 0.0;
  for (uint v = 0; v < LANES; ++v) total = is_peak ? max(total, partial[v * NUM_SUMS + k]) : total + partial[v * NUM_SUMS + k];
  return total;
}

Moments momentsAt(uint start) {
  return Moments(sums[start], vec3(sums[start + 1], sums[start + 2], sums[start + 3]),
                 vec3(sums[start + 4], sums[start + 5], sums[start + 6]), sums[start + 7], sums[start + 8]);
}

// The wrench on the sensor at S's origin, in S, from those of the tiles about the origins of their patches.
void writeContact(uint instance, bool load_driven) {
  vec3 force = vec3(0), torque = vec3(0);
  float deep = 0.0;
  for (uint t = 0; t < sensor.counts.y; ++t) {
    TileResult result = tile_results[instance * sensor.counts.y + t];
    PatchRecord patch_record = patches[tiles[t].place.x];
    vec3 r0 = patch_record.row0.xyz, r1 = patch_record.row1.xyz, r2 = patch_record.row2.xyz;
    vec3 origin = -(r0 * patch_record.row0.w + r1 * patch_record.row1.w + r2 * patch_record.row2.w);  // of P in S
    vec3 f = r0 * result.force.x + r1 * result.force.y + r2 * result.force.z;
    force += f;
    torque += r0 * result.torque.x + r1 * result.torque.y + r2 * result.torque.z + cross(origin, f);
    deep += result.force.w;
  }
  for (uint k = 0; k < 3; ++k) {
    shared_features[kFeatureContactWrench + k] = force[k];
    shared_features[kFeatureContactWrench + 3 + k] = torque[k];
  }
  shared_features[kFeatureOverPenetration] = deep / float(sensor.counts.x * SAMPLES * SAMPLES);
  shared_features[kFeatureLoadOffset] = load_driven ? loads[instance].bracket.x : 0.0;
  shared_features[kFeatureLoadReached] = !load_driven || loads[instance].bracket.w == 1.0 ? 1.0 : 0.0;
}

// First feature and number of components of the block that feature k belongs to.
uvec2 blockOf(uint k) {
  uint start = k >= kNumImageFeatures && k < kFeatureSaturated ? kNumImageFeatures : 0u;
  uint local = k - start;
  if (k >= kFeatureSaturated) return k >= kFeatureContactWrench && k < kFeatureOverPenetration ? uvec2(kFeatureContactWrench, 6) : uvec2(k, 1);
  if (local >= kFeatureCenterOfPressure && local < kFeatureSecondMoments) return uvec2(start + kFeatureCenterOfPressure, 3);
  if (local >= kFeatureSecondMoments && local < kFeatureEigenvalues) return uvec2(start + kFeatureSecondMoments, 3);
  if (local >= kFeatureEigenvalues && local < kFeatureEdgeAngle) return uvec2(start + kFeatureEigenvalues, 2);
  return uvec2(k, 1);
}

void main() {
  uint lane = gl_LocalInvocationIndex;
  uint instance = workgroupNumber();
  uint num_instances = step_record.batch.x;
  if (instance >= num_instances) return;
  uint num_taxels = sensor.counts.x;
  uint num_entries = sensor.counts.z;
  uint first_taxel = instance * num_taxels;
  vec4 drive = instances[instance].drive;
  uvec4 keys = instances[instance].keys;
  uvec2 seed = step_record.batch.zw;
  bool new_frame = (keys.w & kFlagNewFrame) != 0;
  float noise_level = sqrt(sensor.readout.w * sensor.readout.w + drive.w * drive.w);
  findWindow(instance, noise_level > 0.0);
  uint num_window = window_count.x * window_count.y;
  uvec2 window_end = window_first + window_count;

  // Stages 3 to 5. Outside the window everything is 0.
  for (uint t = lane; t < num_taxels; t += WORKGROUP) {
    if (ONE_PATCH != 0) {
      uvec2 at = uvec2(t / patches[0].grid.y, t % patches[0].grid.y);
      if (all(greaterThanEqual(at, window_first)) && all(lessThan(at, window_end))) continue;
    } else {
      break;
    }
    spread_normal[first_taxel + t] = 0.0;
    if (SHEAR != 0) {
      spread_shear[2 * (first_taxel + t)] = 0.0;
      spread_shear[2 * (first_taxel + t) + 1] = 0.0;
    }
    if (new_frame) image[first_taxel + t] = 0;
  }
  for (uint k = lane; k < num_window; k += WORKGROUP) {
    uint t = taxelInWindow(k);
    float force = 0.0;
    vec2 shear = vec2(0);
    for (uint e = 0; e < num_entries; ++e) {
      vec2 entry = spread_entries[e * num_taxels + t];
      uint source = first_taxel + floatBitsToUint(entry.x);
      force += entry.y * contact_normal[source];
      if (SHEAR != 0) shear += entry.y * vec2(contact_shear[2 * source], contact_shear[2 * source + 1]);
    }
    spread_normal[first_taxel + t] = force;
    if (SHEAR != 0) {
      spread_shear[2 * (first_taxel + t)] = shear.x;
      spread_shear[2 * (first_taxel + t) + 1] = shear.y;
    }
    if (new_frame) {
      float gain = taxels[t].readout.x * drive.y;
      if (drive.z > 0.0) gain *= exp(drive.z * gaussian(seed, keys.xy, 0, t, kPurposeTaxelGain));
      float noise = noise_level > 0.0 ? noise_level * gaussian(seed, keys.xy, keys.z, t, kPurposeReadoutNoise) : 0.0;
      image[first_taxel + t] = countsOf(force, gain, taxels[t].readout.y, noise);
    }
  }
  memoryBarrierBuffer();
  barrier();

  // Stage 6. Moments are summed about a taxel in the middle of the window, so that their variance is no difference of large numbers.
  vec3 origin = vec3(0);
  if (ONE_PATCH != 0 && num_window > 0) {
    uvec2 at = window_first + window_count / 2;
    origin = taxels[at.x * patches[0].grid.y + at.y].chart.xyz;
  }
  for (uint v = lane; v < LANES; v += WORKGROUP) {
    float clean[kSumsPerImage], measured[kSumsPerImage];
    for (uint s = 0; s < kSumsPerImage; ++s) clean[s] = measured[s] = 0.0;
    float num_saturated = 0.0;
    for (uint k = v; k < num_window; k += LANES) {
      uint t = taxelInWindow(k);
      float force = spread_normal[first_taxel + t];
      uint counts = image[first_taxel + t];
      if (force == 0.0 && counts == 0) continue;
      vec4 chart = taxels[t].chart;
      vec3 p = chart.xyz - origin;
      float by_counts = nominalForce(counts);
      clean[0] += force;
      clean[1] += force * p.x;
      clean[2] += force * p.y;
      clean[3] += force * p.z;
      clean[4] += force * p.x * p.x;
      clean[5] += force * p.x * p.y;
      clean[6] += force * p.y * p.y;
      clean[7] = max(clean[7], force);
      clean[8] += force > taxels[t].readout.y ? chart.w : 0.0;
      measured[0] += by_counts;
      measured[1] += by_counts * p.x;
      measured[2] += by_counts * p.y;
      measured[3] += by_counts * p.z;
      measured[4] += by_counts * p.x * p.x;
      measured[5] += by_counts * p.x * p.y;
      measured[6] += by_counts * p.y * p.y;
      measured[7] = max(measured[7], by_counts);
      measured[8] += counts > 0 ? chart.w : 0.0;
      num_saturated += float(counts) >= sensor.readout.z ? 1.0 : 0.0;
    }
    for (uint s = 0; s < kSumsPerImage; ++s) {
      partial[v * NUM_SUMS + s] = clean[s];
      partial[v * NUM_SUMS + kSumsPerImage + s] = measured[s];
    }
    partial[v * NUM_SUMS + 2 * kSumsPerImage] = num_saturated;
  }
  barrier();
  for (uint k = lane; k < NUM_SUMS; k += WORKGROUP) sums[k] = foldedSum(k);
  barrier();
  if (lane == 0) writeMoments(kNumImageFeatures, momentsAt(0), origin);
  if (lane == 1) writeMoments(0, momentsAt(kSumsPerImage), origin);
  if (lane == 2) shared_features[kFeatureSaturated] = sums[2 * kSumsPerImage] / float(num_taxels);
  if (lane == 3) writeContact(instance, (keys.w & kFlagLoadDriven) != 0);
  barrier();
  for (uint k = lane; k < kNumFeatures; k += WORKGROUP) {
    bool is_measured = k < kNumImageFeatures || k == kFeatureSaturated;
    if (is_measured && !new_frame) continue;
    uvec2 block = blockOf(k);
    features[block.x * num_instances + instance * block.y + k - block.x] = shared_features[k];
  }
}
