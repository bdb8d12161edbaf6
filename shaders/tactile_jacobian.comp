#version 460
#extension GL_GOOGLE_include_directive : require
// Tactile Jacobian, last step: the spread of the taxels' derivatives, and how force, centre of pressure and edge angle of the sensor and of its patches change
// with the six coordinates of the sensor's twist. After the image pass, of clean forces or of what the readout makes of them before noise.
//
// TEAM invocations share a part (a row of an instance); a workgroup has WORKGROUP / TEAM teams, and each does REPEAT parts one after another. The parts of one
// kind of all instances follow each other.
// In:  spread_normal (num_instances x num_taxels), N; taxel_jacobian (num_instances x 6 x num_taxels); wrench_jacobian (num_instances x num_tiles x 6 x 6).
// Out: features (block after block, each num_instances x num_rows x components x 6, then the wrench's, shared/features.h).
// Shared memory: 4 PARTIALS bytes.
// Deterministic: sums run over LANES partial sums in a fixed order, whatever the size of team and workgroup.
// Twin: src/reference/feature_jacobian.cpp.

#include "shared/batch.h"
#include "shared/features.h"
#include "shared/random.h"
#include "shared/sensor.h"
#include "passes/declare.glsl"
#include "passes/tactile_jacobian.h"
const float BIAS = 0.0;  // of counts, which have no part in this

const uint kTeams = WORKGROUP / TEAM;
const bool kOnePatch = PATCHES == 1;  // whose row is the sensor's
const uint kRows = 1 + PATCHES;
const uint kParts = kOnePatch ? 1u : kRows;

shared float partial[PARTIALS];

// A loop ended before its work was done; see contact.comp.
bool cut_short = false;

#include "common/workgroup.glsl"
#include "common/philox.glsl"
#include "readout/imperfections.glsl"
#include "common/axes.glsl"

float kernel_of_nine[9];  // of 3 x 3, at hand

// A row of an instance, as its team sees it.
struct Part {
  uint instance;
  uint first, end;  // its taxels
  uint plane;
  bool is_grid;     // of that plane, else places in S
  vec2 pitch;       // of the plane
  vec2 size;        // of the grid, rows and columns
};

// What is summed over the taxels of a part.
const uint kScanFirst = 0u;   // force, first moments
const uint kScanSecond = 1u;  // second moments about a middle
const uint kScanChange = 2u;  // what one coordinate of the twist does to force, first and second moments about a middle
const uint kScanWrench = 3u;  // over tiles: what it does to the wrench

struct Sums {
  float s[kMostSums];
};

Sums noSums() {
  Sums sums;
  for (uint k = 0; k < kMostSums; ++k) sums.s[k] = 0.0;
  return sums;
}

// Place of a taxel in C.
vec3 placeOf(Part part, uint t) {
  if (kOnePatch || part.is_grid) {
    // As in contact_features.comp.
    float number = float(t - part.first);
    float i = floor((number + 0.5) / part.size.y);
    return vec3((vec2(i, number - i * part.size.y) - 0.5 * (part.size - 1.0)) * part.pitch, 0);
  }
  return taxels[t].chart.xyz;
}

// A taxel's force as the row has it, N, and by how much it changes with the spread force.
vec2 readingOf(Part part, uint t) {
  float force = spread_normal[part.instance * NUM_TAXELS + t];
  if (CLEAN) return vec2(force, 1);
  vec4 drive = instances[part.instance].drive;
  uvec4 keys = instances[part.instance].keys;
  uvec2 seed = step_record.batch.zw;
  float gain = drive.y * taxels[t].readout.x;
  if (RANDOM && drive.z > 0.0) gain *= exp(drive.z * gaussian(seed, keys.xy, 0, t, kPurposeTaxelGain));
  float trigger = taxels[t].readout.y, x = gain * force - trigger;
  if (isDead(seed, keys.xy, t)) return vec2(0);
  // Without a trigger the first force counts, too, which a contact is about to bring over a side.
  bool follows = (x > 0.0 || trigger <= 0.0) && x < MOST;
  return vec2(x > 0.0 ? min(x, MOST) + TRIGGER : 0.0, follows ? gain : 0.0);
}

// Coordinate `k` of the derivatives, spread to a taxel.
float spreadChange(Part part, uint t, uint k) {
  uint first = (part.instance * 6 + k) * NUM_TAXELS;
  float sum = 0.0;
  if (NUM_ROWS == 0) {
    for (uint e = 0; e < NUM_ENTRIES; ++e) {
      uint number = e * NUM_TAXELS + t;
      vec2 entry = (number & 1u) == 0 ? spread_rows[number >> 1].xy : spread_rows[number >> 1].zw;
      sum += entry.y * taxel_jacobian[first + floatBitsToUint(entry.x)];
    }
    return sum;
  }
  ivec2 at = ivec2(t / NUM_COLS, t % NUM_COLS);
  const int kRadius = int(KERNEL) / 2;
  for (int a = -kRadius; a <= kRadius; ++a) {
    for (int b = -kRadius; b <= kRadius; ++b) {
      uvec2 source = uvec2(at - ivec2(a, b));  // wraps to large numbers outside
      if (any(greaterThanEqual(source, uvec2(NUM_ROWS, NUM_COLS)))) continue;
      uint number = uint((a + kRadius) * int(KERNEL) + b + kRadius);
      float weight = KERNEL == 3 ? kernel_of_nine[min(number, 8u)] : spread_rows[number >> 2][number & 3u];
      sum += weight * taxel_jacobian[first + source.x * NUM_COLS + source.y];
    }
  }
  return sum;
}

void addTaxel(uint scan, Part part, uint t, vec3 middle, uint k, inout Sums sums) {
  vec2 reading = vec2(0, 1);
  if (!CLEAN || scan != kScanChange) reading = readingOf(part, t);
  vec3 p = placeOf(part, t) - middle;
  if (scan == kScanSecond) {
    sums.s[0] += reading.x * p.x * p.x;
    sums.s[1] += reading.x * p.x * p.y;
    sums.s[2] += reading.x * p.y * p.y;
    return;
  }
  float weight = scan == kScanFirst ? reading.x : reading.y * spreadChange(part, t, k);
  sums.s[0] += weight;
  sums.s[1] += weight * p.x;
  sums.s[2] += weight * p.y;
  sums.s[3] += weight * p.z;
  if (scan == kScanFirst) return;
  sums.s[4] += weight * p.x * p.x;
  sums.s[5] += weight * p.x * p.y;
  sums.s[6] += weight * p.y * p.y;
}

void addTile(Part part, uint tile, uint k, inout Sums sums) {
  uint first = (part.instance * NUM_TILES + tile) * kNumWrenchJacobian + k;
  for (uint c = 0; c < 6; ++c) sums.s[c] += wrench_jacobian[first + 6 * c];
}

// Over all taxels of the part, or tiles of the instance; the same for every invocation of the team.
Sums sumsOf(uint scan, Part part, vec3 middle, uint k) {
  uint lane = gl_LocalInvocationIndex % TEAM;
  uint first_partial = gl_LocalInvocationIndex / TEAM * kMostSums * LANES;
  uint first = scan == kScanWrench ? 0 : part.first, end = scan == kScanWrench ? NUM_TILES : part.end;
  Sums total = noSums();
  for (uint v = lane; v < LANES; v += TEAM) {
    Sums sums = noSums();
    uint t = first + v;
    for (; t < end; t += LANES) {
      if (scan == kScanWrench) {
        addTile(part, t, k, sums);
      } else {
        addTaxel(scan, part, t, middle, k, sums);
      }
    }
    cut_short = cut_short || t < end;
    for (uint s = 0; s < kMostSums; ++s) {
      if (TEAM == 1) {
        total.s[s] += sums.s[s];
      } else {
        partial[first_partial + s * LANES + v] = sums.s[s];
      }
    }
  }
  if (TEAM > 1) {
    barrier();
    for (uint v = 0; v < LANES; ++v) {
      for (uint s = 0; s < kMostSums; ++s) total.s[s] += partial[first_partial + s * LANES + v];
    }
    barrier();
  }
  return total;
}

// Part `number` (below kParts) of an instance; empty where it has nothing to do.
Part partOf(uint instance, uint number, bool is_due) {
  uint plane = kOnePatch ? 0 : number == 0 ? LAST_PLANE : number - 1;
  uvec4 grid = planes[plane].grid;
  bool is_grid = kOnePatch || number > 0;
  uint first = number > 0 ? grid.z : 0;
  uint end = number > 0 ? grid.z + grid.x * grid.y : NUM_TAXELS;
  return Part(instance, first, is_due ? end : first, plane, is_grid, planes[plane].pitch.xy, vec2(grid.xy));
}

// What coordinate `k` of the twist does to the features of a row.
struct Change {
  float force, angle;
  vec3 center;  // in C
};

Change noChange() { return Change(0.0, 0.0, vec3(0)); }

// From the changes of force and moments about the centre of pressure: mean and second moments are quotients, the angle is 1/2 atan2(2 xy, xx - yy).
Change changeOf(Sums sums, float force, vec3 second, Axes axes) {
  Change change = Change(sums.s[0], 0.0, vec3(sums.s[1], sums.s[2], sums.s[3]) / force);
  vec3 moments = (vec3(sums.s[4], sums.s[5], sums.s[6]) - second * sums.s[0]) / force;
  float difference = axes.large - axes.small;
  if (axes.confidence > 0.0) {
    change.angle = ((second.x - second.z) / difference * moments.y - second.y / difference * (moments.x - moments.z)) / difference;
  }
  return change;
}

void writeChange(uint row, uint num_rows, uint k, PlaneRecord plane, Change change) {
  uint center = kJacobianCenterOfPressure * num_rows + 18 * row + k;
  features[center] = dot(plane.X_SC_row0.xyz, change.center);
  features[center + 6] = dot(plane.X_SC_row1.xyz, change.center);
  features[center + 12] = dot(plane.X_SC_row2.xyz, change.center);
  features[kJacobianTotalForce * num_rows + 6 * row + k] = change.force;
  features[kJacobianEdgeAngle * num_rows + 6 * row + k] = change.angle;
}

// Every team goes the same way through the barriers; one without a part of its own (`is_there` false) does and writes nothing. Between the sensor's own frames
// measured values stay.
void jacobianOf(uint number, bool is_there, uint num_instances) {
  const float kLeastForce = 1e-20;  // N: less is no contact, and quotients stay finite
  uint instance = number % num_instances, which = number / num_instances;
  bool is_due = is_there && (CLEAN || (instances[instance].keys.w & kFlagNewFrame) != 0);
  bool writes = is_due && gl_LocalInvocationIndex % TEAM == 0;
  Part part = partOf(instance, which, is_due);
  PlaneRecord plane = planes[part.plane];
  Sums first = sumsOf(kScanFirst, part, vec3(0), 0);
  float force = first.s[0];
  bool touches = force > kLeastForce;
  vec3 center = vec3(0), second = vec3(0);
  if (touches) center = vec3(first.s[1], first.s[2], first.s[3]) / force;
  Sums about = sumsOf(kScanSecond, part, center, 0);
  if (touches) second = vec3(about.s[0], about.s[1], about.s[2]) / force;
  Axes axes = axesOf(second);
  uint num_rows = num_instances * kRows;
  uint row = instance * kRows + which;
  for (uint k = 0; k < 6; ++k) {
    Sums sums = sumsOf(kScanChange, part, center, k);
    Change change = noChange();
    if (touches) change = changeOf(sums, force, second, axes);
    if (writes) {
      writeChange(row, num_rows, k, plane, change);
      if (kOnePatch) writeChange(row + 1, num_rows, k, plane, change);
    }
    if (!CLEAN) continue;
    // Only the sensor has a wrench.
    Sums wrench = sumsOf(kScanWrench, part, vec3(0), k);
    uint first_wrench = kNumJacobian * num_rows + kNumWrenchJacobian * instance + k;
    for (uint c = 0; c < 6; ++c) {
      if (writes && which == 0) features[first_wrench + 6 * c] = wrench.s[c];
    }
  }
}

void main() {
  uint num_instances = step_record.batch.x;
  uint num_parts = num_instances * kParts;
  if (NUM_ROWS > 0 && KERNEL == 3) {
    for (uint n = 0; n < 9; ++n) kernel_of_nine[n] = spread_rows[n >> 2][n & 3u];
  }
  uint number = workgroupNumber() * REPEAT * kTeams + gl_LocalInvocationIndex / TEAM;
  uint r = 0;
  for (; r < REPEAT; ++r, number += kTeams) jacobianOf(min(number, num_parts - 1), number < num_parts, num_instances);
  if (cut_short || r < REPEAT) problems[0] = 1;
}
