#version 460
#extension GL_GOOGLE_include_directive : require
// Image pass: stages 3 (spread), 4 (time), 5 (readout) and 6 (features) of one frame.
//
// TEAM invocations share an instance; a workgroup has WORKGROUP / TEAM teams, and each does REPEAT instances one after another. An invocation owns rows of
// taxels, so that of a row's sources each is fetched once. On a software driver a team is one invocation: what is done once per instance, above all
// the features, is then done for as many instances at a time as a vector has lanes.
// In:  contact_normal (num_instances x num_taxels), N; contact_shear; tile_results; the spread's kernel or lists.
// Out: image (num_instances x num_taxels), counts; spread_normal, N, and spread_shear alike; features (block after block, shared/features.h).
// Kept between steps: taxel_states (num_instances x states x num_taxels), readout/lag.glsl; image_windows.
// Shared memory: 4 PARTIALS bytes.
// Deterministic: sums run over at most LANES partial sums in a fixed order, whatever the size of team and workgroup.
// Twins: src/reference/psf.cpp, lag.cpp, imperfections.cpp, readout.cpp, features.cpp.

#include "shared/batch.h"
#include "shared/features.h"
#include "shared/random.h"
#include "shared/sensor.h"
#include "passes/declare.glsl"
#include "passes/image.h"

const uint kPeak = 8u;  // of the sums of an image

shared float partial[PARTIALS];

// The part of the sensor that contact reaches, and that forces reach after the spread: of one grid patch rectangles, else all taxels in rows of
// kCols, the last one perhaps too long.
uvec2 contact_first, contact_count;
uvec2 window_first, window_count;

// A loop ended before its work was done; see contact.comp.
bool cut_short = false;

const bool kOnePatch = NUM_ROWS > 0;
const bool kSliding = kOnePatch && KERNEL == 3;
const uint kRowsAtOnce = kSliding && TEAM == 1 && LANES > 1 ? 2 : 1;

#include "common/workgroup.glsl"
#include "common/whole.glsl"
#include "common/philox.glsl"
#include "readout/spread.glsl"
#include "readout/lag.glsl"
#include "readout/imperfections.glsl"
#include "readout/readout.glsl"
#include "common/moments.glsl"

// Scalars: Mesa 22.3 picks the wrong components where a specialization constant chooses between two vectors.
const uint kCols = kOnePatch ? NUM_COLS : kListCols;
const uint kRows = kOnePatch ? NUM_ROWS : (NUM_TAXELS + kCols - 1) / kCols;

void findWindow(uint instance, bool everything) {
  uvec2 all_taxels = uvec2(kRows, kCols);
  if (!kOnePatch) {
    contact_first = window_first = uvec2(0);
    contact_count = window_count = all_taxels;
    return;
  }
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
  // Of a sensor of several tiles, and after passes over its taxels, all have a force.
  const bool kWritten = NUM_TILES > 1 || WHOLE_ARRAY;
  contact_first = kWritten ? uvec2(0) : first;
  contact_count = kWritten ? all_taxels : touched ? end - first : uvec2(0);
  window_first = first - min(first, uvec2(kRadius));
  window_count = touched ? min(end + kRadius, all_taxels) - window_first : uvec2(0);
  if (WHOLE_ARRAY || everything) {
    window_first = uvec2(0);
    window_count = all_taxels;
  }
}

// Position in C of a taxel, relative to the origin of the sums, and its area.
vec4 chartOf(uvec2 at, uvec2 origin) {
  if (!kOnePatch) return taxels[at.x * kCols + at.y].chart;
  return vec4((vec2(at) - vec2(origin)) * vec2(PITCH_X, PITCH_Y), 0, PITCH_X * PITCH_Y);
}

// What an invocation sums over its taxels.
struct Sums {
  float measured[kSumsPerImage], clean[kSumsPerImage];
  float num_saturated;
};

Sums noSums() {
  Sums sums;
  for (uint s = 0; s < kSumsPerImage; ++s) sums.measured[s] = sums.clean[s] = 0.0;
  sums.num_saturated = 0.0;
  return sums;
}

// What `weight` N at a taxel adds to the sums of an image.
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

void addSums(inout Sums total, Sums part) {
  for (uint s = 0; s < kPeak; ++s) {
    total.measured[s] += part.measured[s];
    total.clean[s] += part.clean[s];
  }
  total.measured[kPeak] = max(total.measured[kPeak], part.measured[kPeak]);
  total.clean[kPeak] = max(total.clean[kPeak], part.clean[kPeak]);
  total.num_saturated += part.num_saturated;
}

// One instance, as its team sees it.
struct Instance {
  uint number, first_taxel;
  vec4 drive;
  uvec4 keys;
  bool new_frame;
  uint step;          // since reset
  float noise_level;  // counts
  uvec2 origin;       // the taxel in the middle of the window: moments about it are no differences of large numbers
};

// Stages 4 to 6 of one taxel.
void readTaxel(Instance of, uint t, uvec2 at, Spread spread, uvec2 seed, inout Sums sums) {
  if (OUTPUT_NORMAL) spread_normal[of.first_taxel + t] = spread.normal;
  if (SHEAR) {
    spread_shear[2 * (of.first_taxel + t)] = spread.shear.x;
    spread_shear[2 * (of.first_taxel + t) + 1] = spread.shear.y;
  }
  vec4 chart = chartOf(at, of.origin);
  float nominal_trigger = TAXELS_ALIKE ? TRIGGER : taxels[t].readout.y;
  addTaxel(sums.clean, spread.normal, chart, spread.normal > nominal_trigger);
  TaxelTime time = TaxelTime(of.number * numStates() * NUM_TAXELS + t, of.step);
  float force = lagged(time, spread.normal);
  float drift = 0.0;
  if (RANDOM_WALK) drift = drifted(time, step_record.time.w * gaussian(seed, of.keys.xy, of.step, t, kPurposeRandomWalk));
  if (!of.new_frame) return;
  float gain = TAXELS_ALIKE ? of.drive.y : of.drive.y * taxels[t].readout.x;
  if (RANDOM && of.drive.z > 0.0) gain *= exp(of.drive.z * gaussian(seed, of.keys.xy, 0, t, kPurposeTaxelGain));
  uint counts = countsOf(force, gain, nominal_trigger, offsetOf(seed, of.keys.xy, of.keys.z, t, of.noise_level) + drift);
  if (isDead(seed, of.keys.xy, t)) counts = 0;
  image[of.first_taxel + t] = counts;
  addTaxel(sums.measured, nominalForce(counts), chart, counts > 0);
  if (float(counts) >= SATURATION) sums.num_saturated += 1.0;
}

// Stages 3 to 6 of row `i` of the window and, where rows are taken in twos, of the next if there is one.
void readRows(Instance of, uint i, uvec2 seed, inout Sums sums, inout Sums next_sums) {
  Sums row = noSums(), next_row = noSums();
  uvec2 at = uvec2(window_first.x + i, window_first.y);
  if (kSliding) startColumns(of.first_taxel, ivec2(at));
  uint j = 0;
  for (; j < window_count.y; ++j, ++at.y) {
    uint t = at.x * kCols + at.y;
    if (!kOnePatch && t >= NUM_TAXELS) continue;
    Spread spread;
    if (kSliding) {
      nextColumn(of.first_taxel, ivec2(at));
      spread = spreadSliding(0);
    } else if (kOnePatch) {
      spread = spreadOnGrid(of.first_taxel, ivec2(at));
    } else {
      spread = spreadByList(of.first_taxel, t);
    }
    readTaxel(of, t, at, spread, seed, row);
    if (kRowsAtOnce > 1 && i + 1 < window_count.x) readTaxel(of, t + kCols, at + uvec2(1, 0), spreadSliding(1), seed, next_row);
  }
  cut_short = cut_short || j < window_count.y;
  addSums(sums, row);
  addSums(next_sums, next_row);
}

// Outside the window everything is 0.
void clearOutside(Instance of, uint lane) {
  if (!kOnePatch) return;
  uvec4 before = KEEPS_WINDOW ? image_windows[of.number] : uvec4(0, 0, kRows, kCols);
  uvec2 first = before.xy, count = before.zw;
  bool covered = all(greaterThanEqual(first, window_first)) && all(lessThanEqual(first + count, window_first + window_count));
  uint num_rows = covered ? 0 : count.x;
  uint i = lane;
  for (; i < num_rows; i += TEAM) {
    uint j = 0;
    for (; j < count.y; ++j) {
      uvec2 at = first + uvec2(i, j);
      if (all(lessThan(at - window_first, window_count))) continue;
      uint t = of.first_taxel + at.x * kCols + at.y;
      if (OUTPUT_NORMAL) spread_normal[t] = 0.0;
      if (SHEAR) spread_shear[2 * t] = spread_shear[2 * t + 1] = 0.0;
      if (of.new_frame) image[t] = 0;
    }
    cut_short = cut_short || j < count.y;
  }
  cut_short = cut_short || i < num_rows;
}

// A tile left untouched has no forces, one that came to nothing has -0: the sum is 0 either way. In bits, since drivers leave out what is added to 0.
float unsignedZero(float x) { return (floatBitsToUint(x) << 1) == 0 ? 0.0 : x; }

// Features that the contact pass has computed: wrench, over-penetration, load.
void writeContact(Instance of, uint num_instances) {
  vec4 force = vec4(0), torque = vec4(0);
  for (uint t = 0; t < NUM_TILES; ++t) {
    force += tile_results[of.number * NUM_TILES + t].force;
    torque += tile_results[of.number * NUM_TILES + t].torque;
  }
  vec4 bracket = vec4(0, 0, 0, kLoadCarried);
  if ((of.keys.w & kFlagLoadDriven) != 0) bracket = loads[of.number].bracket;
  uint wrench = kFeatureContactWrench * num_instances + 6 * of.number;
  features[wrench] = unsignedZero(force.x);
  features[wrench + 1] = unsignedZero(force.y);
  features[wrench + 2] = unsignedZero(force.z);
  features[wrench + 3] = unsignedZero(torque.x);
  features[wrench + 4] = unsignedZero(torque.y);
  features[wrench + 5] = unsignedZero(torque.z);
  features[kFeatureOverPenetration * num_instances + of.number] = force.w / float(NUM_TAXELS * SAMPLES * SAMPLES);
  features[kFeatureLoadOffset * num_instances + of.number] = bracket.x;
  features[kFeatureLoadReached * num_instances + of.number] = bracket.w == kLoadCarried ? 1.0 : 0.0;
}

void writeImageFeatures(uint start, Instance of, uint num_instances, float s[kSumsPerImage]) {
  Moments moments = Moments(s[0], vec3(s[1], s[2], s[3]), vec3(s[4], s[5], s[6]), s[kPeak], s[7]);
  vec3 middle = vec3(0);
  if (kOnePatch) middle.xy = (vec2(of.origin) - 0.5 * vec2(int(NUM_ROWS) - 1, int(NUM_COLS) - 1)) * vec2(PITCH_X, PITCH_Y);
  writeMoments(start, of.number, num_instances, moments, middle, sensor.X_SC_row0, sensor.X_SC_row1, sensor.X_SC_row2);
}

// Every team goes the same way through the barriers; one without an instance of its own (`is_there` false) does and writes nothing.
void imageOf(uint number, bool is_there, uint num_instances, uvec2 seed) {
  uint lane = gl_LocalInvocationIndex % TEAM;
  Instance of;
  of.number = number;
  of.first_taxel = number * NUM_TAXELS;
  of.drive = instances[number].drive;
  of.keys = instances[number].keys;
  of.new_frame = (of.keys.w & kFlagNewFrame) != 0;
  of.noise_level = sqrt(NOISE * NOISE + of.drive.w * of.drive.w);
  of.step = hasState() ? instances[number].clock.x : 0;
  findWindow(number, hasState() || BIAS > 0.0 || RANDOM && of.noise_level > 0.0);
  of.origin = window_first + window_count / 2;
  if (is_there) clearOutside(of, lane);

  uint num_parts = is_there ? min(LANES, window_count.x) : 0;
  Sums total = noSums();
  uint first_partial = gl_LocalInvocationIndex / TEAM * kNumSums * LANES;
  for (uint v = lane * kRowsAtOnce; v < num_parts; v += TEAM * kRowsAtOnce) {
    Sums part = noSums(), next_part = noSums();
    uint i = v;
    for (; i < window_count.x; i += LANES) readRows(of, i, seed, part, next_part);
    cut_short = cut_short || i < window_count.x;
    if (TEAM == 1) {
      addSums(total, part);
      addSums(total, next_part);
    } else {
      for (uint s = 0; s < kSumsPerImage; ++s) {
        partial[first_partial + s * LANES + v] = part.measured[s];
        partial[first_partial + (kSumsPerImage + s) * LANES + v] = part.clean[s];
      }
      partial[first_partial + 2 * kSumsPerImage * LANES + v] = part.num_saturated;
    }
  }
  if (TEAM > 1) {
    barrier();
    for (uint v = 0; v < num_parts; ++v) {
      Sums part;
      for (uint s = 0; s < kSumsPerImage; ++s) {
        part.measured[s] = partial[first_partial + s * LANES + v];
        part.clean[s] = partial[first_partial + (kSumsPerImage + s) * LANES + v];
      }
      part.num_saturated = partial[first_partial + 2 * kSumsPerImage * LANES + v];
      addSums(total, part);
    }
    barrier();
  }
  if (!is_there || lane > 0) return;
  if (kOnePatch && KEEPS_WINDOW) image_windows[number] = uvec4(window_first, window_count);
  if (of.new_frame) {
    writeImageFeatures(0, of, num_instances, total.measured);
    features[kFeatureSaturated * num_instances + number] = total.num_saturated / float(NUM_TAXELS);
  }
  writeImageFeatures(kNumImageFeatures, of, num_instances, total.clean);
  writeContact(of, num_instances);
}

void main() {
  uvec4 batch = step_record.batch;
  loadKernel();
  loadLag();
  const uint kTeams = WORKGROUP / TEAM;
  uint number = workgroupNumber() * REPEAT * kTeams + gl_LocalInvocationIndex / TEAM;
  uint r = 0;
  for (; r < REPEAT; ++r, number += kTeams) imageOf(min(number, batch.x - 1), number < batch.x, batch.x, batch.zw);
  if (cut_short || r < REPEAT) problems[0] = 1;
}
