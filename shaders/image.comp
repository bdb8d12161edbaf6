#version 460
#extension GL_GOOGLE_include_directive : require
// Image pass: stages 3 (spread), 4 (frame-rate hold), 5 (readout) and 6 (features) of one frame.
//
// A workgroup owns REPEAT instances, one after another; an invocation owns taxels.
// In:  contact_normal (num_instances x num_taxels), N; contact_shear; tile_results; the spread's kernel or lists.
// Out: image (num_instances x num_taxels), counts; spread_normal, N, and spread_shear alike; features (block after block, layout.h).
// Shared memory: 4 kNumSums (LANES + 1) bytes.
// Deterministic: sums run over LANES partial sums in a fixed order, whatever the size of the workgroup.
// Twins: src/reference/psf.cpp, readout.cpp, features.cpp.

#include "shared/layout.h"
#include "lib/specialization.glsl"
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

layout(std430, set = 0, binding = 0) readonly buffer Instances { InstanceRecord instances[]; };
layout(std430, set = 0, binding = 1) readonly buffer Step { StepRecord step_record; };
layout(std430, set = 0, binding = 2) readonly buffer SensorBlock { SensorRecord sensor; };
layout(std430, set = 0, binding = 3) readonly buffer Taxels { TaxelRecord taxels[]; };
layout(std430, set = 0, binding = 4) readonly buffer SpreadRows { vec4 spread_rows[]; };
layout(std430, set = 0, binding = 5) readonly buffer ContactNormal { float contact_normal[]; };
layout(std430, set = 0, binding = 6) readonly buffer ContactShear { float contact_shear[]; };
layout(std430, set = 0, binding = 7) readonly buffer TileResults { TileResult tile_results[]; };
layout(std430, set = 0, binding = 8) readonly buffer Loads { LoadRecord loads[]; };
layout(std430, set = 0, binding = 9) coherent buffer Image { uint image[]; };
layout(std430, set = 0, binding = 10) coherent buffer SpreadNormal { float spread_normal[]; };
layout(std430, set = 0, binding = 11) writeonly buffer SpreadShear { float spread_shear[]; };
layout(std430, set = 0, binding = 12) writeonly buffer Features { float features[]; };
layout(std430, set = 0, binding = 13) writeonly buffer Problems { uint problems[]; };

// Sums per image: force, first moments (3), second moments (3), area, peak; first the measured image's, then the clean one's, then the number of
// saturated taxels.
const uint kSumsPerImage = 9u;
const uint kNumSums = 19u;
const uint kPeak = 8u;

shared float partial[kNumSums * LANES];
shared float sums[kNumSums];

// The part of the sensor that contact reaches, and that forces reach after the spread: of one grid patch rectangles, else all taxels as one row.
uvec2 contact_first, contact_count;
uvec2 window_first, window_count;

// A loop ended before its work was done; see contact.comp.
bool cut_short = false;

#include "lib/workgroup.glsl"
#include "lib/philox.glsl"
#include "lib/spread.glsl"
#include "lib/readout.glsl"
#include "lib/moments.glsl"

const bool kOnePatch = NUM_ROWS > 0;
// Scalars: Mesa 22.3 picks the wrong components where a specialization constant chooses between two vectors.
const uint kRows = kOnePatch ? NUM_ROWS : 1u;
const uint kCols = kOnePatch ? NUM_COLS : NUM_TAXELS;

uvec2 placeInWindow(uint k) { return window_first + uvec2(k / window_count.y, k % window_count.y); }

uint taxelAt(uvec2 at) { return kOnePatch ? at.x * NUM_COLS + at.y : at.y; }

void findWindow(uint instance, bool everything) {
  uvec2 all_taxels = uvec2(kRows, kCols);
  const uint kRadius = KERNEL / 2;
  uvec2 first = all_taxels, end = uvec2(0);
  for (uint t = 0; t < NUM_TILES; ++t) {
    uvec4 reached = tile_results[instance * NUM_TILES + t].window;
    if (reached.x < reached.y) {
      first = min(first, reached.xz);
      end = max(end, reached.yw);
    }
  }
  bool touched = end.x > 0;
  // Of a sensor of several tiles all taxels have a force.
  contact_first = NUM_TILES == 1 ? first : uvec2(0);
  contact_count = NUM_TILES > 1 ? all_taxels : touched ? end - first : uvec2(0);
  window_first = first - min(first, uvec2(kRadius));
  window_count = touched ? min(end + kRadius, all_taxels) - window_first : uvec2(0);
  if (!kOnePatch || everything) {
    window_first = uvec2(0);
    window_count = all_taxels;
  }
}

// Position in C of a taxel, relative to the origin of the sums, and its area.
vec4 chartOf(uvec2 at, uvec2 origin) {
  if (!kOnePatch) return taxels[at.y].chart;
  return vec4((vec2(at) - vec2(origin)) * vec2(PITCH_X, PITCH_Y), 0, PITCH_X * PITCH_Y);
}

// Stages 3 to 5 of one taxel.
void imageTaxel(uint first_taxel, uvec2 at, bool new_frame, vec4 drive, uvec4 keys, uvec2 seed, float noise_level) {
  uint t = taxelAt(at);
  Spread spread;
  if (kOnePatch) {
    spread = spreadOnGrid(first_taxel, ivec2(at));
  } else {
    spread = spreadByList(first_taxel, t);
  }
  spread_normal[first_taxel + t] = spread.normal;
  if (SHEAR) {
    spread_shear[2 * (first_taxel + t)] = spread.shear.x;
    spread_shear[2 * (first_taxel + t) + 1] = spread.shear.y;
  }
  if (!new_frame) return;
  float gain = TAXELS_ALIKE ? drive.y : drive.y * taxels[t].readout.x;
  float trigger = TAXELS_ALIKE ? TRIGGER : taxels[t].readout.y;
  if (RANDOM && drive.z > 0.0) gain *= exp(drive.z * gaussian(seed, keys.xy, 0, t, kPurposeTaxelGain));
  float noise = 0.0;
  if (RANDOM && noise_level > 0.0) noise = noise_level * gaussian(seed, keys.xy, keys.z, t, kPurposeReadoutNoise);
  image[first_taxel + t] = countsOf(spread.normal, gain, trigger, noise);
}

// Moments of one lane's taxels: what `weight` N at a taxel adds to the nine sums.
void addTaxel(inout float image_sums[kSumsPerImage], float weight, vec4 chart, bool touched) {
  image_sums[0] += weight;
  image_sums[1] += weight * chart.x;
  image_sums[2] += weight * chart.y;
  image_sums[3] += weight * chart.z;
  image_sums[4] += weight * chart.x * chart.x;
  image_sums[5] += weight * chart.x * chart.y;
  image_sums[6] += weight * chart.y * chart.y;
  image_sums[7] += touched ? chart.w : 0.0;
  image_sums[kPeak] = max(image_sums[kPeak], weight);
}

// Features that the contact pass has computed: wrench, over-penetration, load.
void writeContact(uint instance, uint num_instances, bool load_driven) {
  const uint kNumContactFeatures = 9u;
  for (uint k = gl_LocalInvocationIndex; k < kNumContactFeatures; k += WORKGROUP) {
    float value = 0.0;
    if (k < 7) {
      for (uint t = 0; t < NUM_TILES; ++t) {
        uint result = instance * NUM_TILES + t;
        if (k < 3 || k == 6) {
          value += tile_results[result].force[min(k, 3u)];
        } else {
          value += tile_results[result].torque[k - 3];
        }
      }
      if (k == 6) value /= float(NUM_TAXELS * SAMPLES * SAMPLES);
    } else if (load_driven) {
      vec4 bracket = loads[instance].bracket;
      value = k == 7 ? bracket.x : (bracket.w == kLoadCarried ? 1.0 : 0.0);
    } else {
      value = k == 7 ? 0.0 : 1.0;
    }
    uint place = k < 6 ? kFeatureContactWrench * num_instances + 6 * instance + k : (kFeatureOverPenetration + k - 6) * num_instances + instance;
    features[place] = value;
  }
}

void imageOf(uint instance, uint num_instances, uvec2 seed) {
  uint lane = gl_LocalInvocationIndex;
  uint first_taxel = instance * NUM_TAXELS;
  vec4 drive = instances[instance].drive;
  uvec4 keys = instances[instance].keys;
  bool new_frame = (keys.w & kFlagNewFrame) != 0;
  float noise_level = sqrt(NOISE * NOISE + drive.w * drive.w);
  findWindow(instance, RANDOM && noise_level > 0.0);
  uint num_window = window_count.x * window_count.y;

  // Outside the window everything is 0.
  if (kOnePatch) {
    uvec2 end = window_first + window_count;
    for (uint t = lane; t < NUM_TAXELS; t += WORKGROUP) {
      uvec2 at = uvec2(t / NUM_COLS, t % NUM_COLS);
      if (all(greaterThanEqual(at, window_first)) && all(lessThan(at, end))) continue;
      if (OUTPUT_NORMAL) spread_normal[first_taxel + t] = 0.0;
      if (SHEAR) spread_shear[2 * (first_taxel + t)] = spread_shear[2 * (first_taxel + t) + 1] = 0.0;
      if (new_frame) image[first_taxel + t] = 0;
    }
  }
  uint k = lane;
  for (; k < num_window; k += WORKGROUP) imageTaxel(first_taxel, placeInWindow(k), new_frame, drive, keys, seed, noise_level);
  cut_short = cut_short || k < num_window;
  memoryBarrierBuffer();
  barrier();

  // Stage 6. Moments are summed about a taxel in the middle of the window, so that their variance is no difference of large numbers.
  uvec2 origin = window_first + window_count / 2;
  for (uint v = lane; v < LANES; v += WORKGROUP) {
    float measured[kSumsPerImage], clean[kSumsPerImage];
    for (uint s = 0; s < kSumsPerImage; ++s) measured[s] = clean[s] = 0.0;
    float num_saturated = 0.0;
    uint k = v;
    for (; k < num_window; k += LANES) {
      uvec2 at = placeInWindow(k);
      uint t = taxelAt(at);
      float force = spread_normal[first_taxel + t];
      uint counts = image[first_taxel + t];
      if (force == 0.0 && counts == 0) continue;
      vec4 chart = chartOf(at, origin);
      addTaxel(clean, force, chart, force > (TAXELS_ALIKE ? TRIGGER : taxels[t].readout.y));
      addTaxel(measured, nominalForce(counts), chart, counts > 0);
      if (float(counts) >= SATURATION) num_saturated += 1.0;
    }
    cut_short = cut_short || k < num_window;
    for (uint s = 0; s < kSumsPerImage; ++s) {
      partial[s * LANES + v] = measured[s];
      partial[(kSumsPerImage + s) * LANES + v] = clean[s];
    }
    partial[2 * kSumsPerImage * LANES + v] = num_saturated;
  }
  barrier();
  for (uint k = lane; k < kNumSums; k += WORKGROUP) {
    float total = 0.0;
    bool is_peak = k % kSumsPerImage == kPeak;
    for (uint v = 0; v < LANES; ++v) total = is_peak ? max(total, partial[k * LANES + v]) : total + partial[k * LANES + v];
    sums[k] = total;
  }
  barrier();
  if (lane < 2 && (lane == 1 || new_frame)) {  // one lane per image
    uint s = lane * kSumsPerImage;
    Moments moments = Moments(sums[s], vec3(sums[s + 1], sums[s + 2], sums[s + 3]), vec3(sums[s + 4], sums[s + 5], sums[s + 6]),
                              sums[s + kPeak], sums[s + 7]);
    vec3 middle = kOnePatch ? vec3((vec2(origin) - 0.5 * vec2(int(NUM_ROWS) - 1, int(NUM_COLS) - 1)) * vec2(PITCH_X, PITCH_Y), 0) : vec3(0);
    writeMoments(lane * kNumImageFeatures, instance, num_instances, moments, middle, sensor.X_SC_row0, sensor.X_SC_row1, sensor.X_SC_row2);
    if (lane == 0) features[kFeatureSaturated * num_instances + instance] = sums[2 * kSumsPerImage] / float(NUM_TAXELS);
  }
  writeContact(instance, num_instances, (keys.w & kFlagLoadDriven) != 0);
}

void main() {
  uvec4 batch = step_record.batch;
  loadKernel();
  uint first = workgroupNumber() * REPEAT;
  uint end = min(first + REPEAT, batch.x);
  uint instance = first;
  for (; instance < end; ++instance) {
    imageOf(instance, batch.x, batch.zw);
    barrier();
  }
  if (cut_short || instance < end) problems[0] = 1;
}
