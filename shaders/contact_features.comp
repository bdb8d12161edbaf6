#version 460
#extension GL_GOOGLE_include_directive : require
// Features of what is in contact, of the sensor, of each of its patches, of each region: moments, edge angle under a window, tilt of a flat face, type of the
// contact. After contact_regions.comp.
//
// TEAM invocations share a part (a row of an instance); a workgroup has WORKGROUP / TEAM teams, and each does REPEAT parts one after another. The parts of one
// kind of all instances follow each other.
// In:  forces (num_instances x num_taxels), N; taxel_regions alike, shared/features.h; regions (num_instances x REGIONS).
// Out: features (block after block, each num_instances x num_rows x components, shared/features.h).
// Shared memory: 4 PARTIALS bytes.
// Deterministic: sums run over LANES partial sums in a fixed order, whatever the size of team and workgroup.
// Twin: src/reference/contact_features.cpp.

#include "shared/batch.h"
#include "shared/features.h"
#include "shared/sensor.h"
#include "passes/declare.glsl"
#include "passes/contact_features.h"

const uint kTeams = WORKGROUP / TEAM;
const bool kList = PATCHES == 0;      // of taxels with places of their own
const bool kOnePatch = PATCHES == 1;  // whose row is the sensor's
const uint kRows = 1 + PATCHES + REGIONS;
const uint kFirstRegion = kOnePatch ? 1u : 1u + PATCHES;  // among the parts that are computed
const uint kParts = kFirstRegion + REGIONS;

// The window under which the edge's angle is found, of its pitch, and how often its middle is moved to the centre of the forces under it.
const float kWindow = 1.15;
const uint kWindowRounds = 4u;
const float kLeastUnderWindow = 1e-3;  // of the force: two contacts far apart have nothing between them

// What ContactType says of forces and lengths.
const float kNoiseFactor = 5.0;
const float kLongestPoint = 2.5;  // pitches
const float kWidestEdge = 0.5;    // of its length

// A core on a row or column has no second moment across it, any other at least 3/4 of a pitch squared. Of one on a diagonal line the determinant is 0 but for
// rounding, of two rows of 128 1.8e-4 times the product of the diagonal.
const float kLeastSpread = 3e-5;

// Largest taxel number plus 1 that a float holds among others.
const float kTaxelNumbers = 16777216.0;

shared float partial[PARTIALS];

// A loop ended before its work was done; see contact.comp.
bool cut_short = false;

#include "common/workgroup.glsl"
#include "common/moments.glsl"

// A row of an instance, as its team sees it.
struct Part {
  uint first_taxel;  // of the instance
  uint first, end;   // its taxels are among these
  uint region;       // whose taxels they are; kNoRegion: all
  uint plane;
  bool is_grid;      // of that plane, else places in S
  vec4 pitch;        // of the plane
  vec2 size;         // of the grid, rows and columns
};

// What is summed over the taxels of a part.
const uint kScanForce = 0u;   // the largest force; force, first moments, area, taxels that report
const uint kScanPeak = 1u;    // of lists: which taxel has the largest force
const uint kScanSecond = 2u;  // moments about a middle; of the core, too, with how forces change over it
const uint kScanWindow = 3u;  // moments about a middle, under a window around it

uint numSums(uint scan) { return scan == kScanForce ? 7u : scan == kScanPeak ? 1u : scan == kScanSecond ? kMostSums : 6u; }

// Of scans over forces and peaks the first one is no sum but the largest value.
bool hasLargest(uint scan) { return scan <= kScanPeak; }

// kScanSecond: sums of the core begin here: taxels, first and second moments of their places (pitches), forces less `force`, first moments and squares of them.
const uint kCore = 6u;

struct Sums {
  float s[kMostSums];
};

Sums noSums() {
  Sums sums;
  for (uint k = 0; k < kMostSums; ++k) sums.s[k] = 0.0;
  return sums;
}

void addSums(uint scan, inout Sums total, Sums more) {
  float largest = max(total.s[0], more.s[0]);
  for (uint k = 0; k < numSums(scan); ++k) total.s[k] += more.s[k];
  if (hasLargest(scan)) total.s[0] = largest;
}

// Place of a taxel in C.
vec3 placeOf(Part part, uint t) {
  if (kOnePatch || part.is_grid) {
    // The row by a product: a driver's integer division is slow. It is half a taxel from where it could be off.
    float number = float(t - part.first);
    float i = floor((number + 0.5) / part.size.y);
    return vec3((vec2(i, number - i * part.size.y) - 0.5 * (part.size - 1.0)) * part.pitch.xy, 0);
  }
  vec3 p_S = taxels[t].chart.xyz;
  if (!kList || part.plane == LAST_PLANE) return p_S;
  PlaneRecord plane = planes[part.plane];
  vec3 d = p_S - vec3(plane.X_SC_row0.w, plane.X_SC_row1.w, plane.X_SC_row2.w);
  return plane.X_SC_row0.xyz * d.x + plane.X_SC_row1.xyz * d.y + plane.X_SC_row2.xyz * d.z;
}

void addTaxel(uint scan, Part part, uint t, vec3 middle, float force, inout Sums sums) {
  uint word = taxel_regions[part.first_taxel + t];
  uint name = word & kNoRegion;
  float weight = forces[part.first_taxel + t];
  if (part.region != kNoRegion && name != part.region) weight = 0.0;
  if (scan == kScanPeak) {
    if (weight == force) sums.s[0] = max(sums.s[0], kTaxelNumbers - float(t));
    return;
  }
  vec3 p = placeOf(part, t) - middle;
  if (scan == kScanForce) {
    bool counts = name != kNoRegion && (part.region == kNoRegion || name == part.region);
    sums.s[0] = max(sums.s[0], weight);
    sums.s[1] += weight;
    sums.s[2] += weight * p.x;
    sums.s[3] += weight * p.y;
    sums.s[4] += weight * p.z;
    sums.s[5] += counts ? (kOnePatch ? PITCH_X * PITCH_Y : taxels[t].chart.w) : 0.0;
    sums.s[6] += counts ? 1.0 : 0.0;
    return;
  }
  if (scan == kScanWindow) {
    float width = kWindow * part.pitch.z;
    weight *= exp(-0.5 * dot(p.xy, p.xy) / (width * width));
  }
  sums.s[0] += weight * p.x;
  sums.s[1] += weight * p.y;
  sums.s[2] += scan == kScanWindow ? weight : weight * p.z;
  sums.s[3] += weight * p.x * p.x;
  sums.s[4] += weight * p.x * p.y;
  sums.s[5] += weight * p.y * p.y;
  if (kList || scan != kScanSecond) return;
  vec2 at = p.xy / part.pitch.xy;
  float one = (word & kCoreTaxel) != 0 && weight > 0.0 ? 1.0 : 0.0;
  float more = one * (weight - force);
  sums.s[kCore] += one;
  sums.s[kCore + 1] += one * at.x;
  sums.s[kCore + 2] += one * at.y;
  sums.s[kCore + 3] += one * at.x * at.x;
  sums.s[kCore + 4] += one * at.x * at.y;
  sums.s[kCore + 5] += one * at.y * at.y;
  sums.s[kCore + 6] += more;
  sums.s[kCore + 7] += more * at.x;
  sums.s[kCore + 8] += more * at.y;
  sums.s[kCore + 9] += more * more;
}

// Over all taxels of the part, the same for every invocation of the team.
Sums sumsOf(uint scan, Part part, vec3 middle, float force) {
  uint lane = gl_LocalInvocationIndex % TEAM;
  uint first_partial = gl_LocalInvocationIndex / TEAM * kMostSums * LANES;
  Sums total = noSums();
  for (uint v = lane; v < LANES; v += TEAM) {
    Sums sums = noSums();
    uint t = part.first + v;
    for (; t < part.end; t += LANES) addTaxel(scan, part, t, middle, force, sums);
    cut_short = cut_short || t < part.end;
    if (TEAM == 1) {
      addSums(scan, total, sums);
    } else {
      for (uint k = 0; k < numSums(scan); ++k) partial[first_partial + k * LANES + v] = sums.s[k];
    }
  }
  if (TEAM > 1) {
    barrier();
    for (uint v = 0; v < LANES; ++v) {
      Sums sums = noSums();
      for (uint k = 0; k < numSums(scan); ++k) sums.s[k] = partial[first_partial + k * LANES + v];
      addSums(scan, total, sums);
    }
    barrier();
  }
  return total;
}

// Axes of the forces under a Gaussian window that finds their middle by itself, from `middle` on.
Axes windowedAxes(Part part, vec3 middle, float force) {
  vec3 second = vec3(0);
  bool is_empty = force <= 0.0;
  for (uint round = 0; round < kWindowRounds; ++round) {
    Sums sums = sumsOf(kScanWindow, part, middle, 0.0);
    float weight = sums.s[2];
    is_empty = is_empty || weight < kLeastUnderWindow * force;
    if (is_empty) continue;
    vec2 first = vec2(sums.s[0], sums.s[1]);
    second = centralMoments(weight, first, vec3(sums.s[3], sums.s[4], sums.s[5]));
    middle.xy += first / weight;
  }
  if (is_empty) second = vec3(0);
  return axesOf(second);
}

struct Tilt {
  vec2 angles;  // rad, about x and y of C
  float confidence;
};

// How a flat face stands to the plane, from a pressure p + g . x over the core: there the centre of pressure less the middle of the area is the area's second
// moments times g area / force. The slope is g over the skin's stiffness.
Tilt tiltOf(PlaneRecord plane, Sums sums, float force) {
  Tilt none = Tilt(vec2(0), 0.0);
  float n = sums.s[kCore];
  if (n < 4.0) return none;  // a plane through three says nothing
  vec2 middle = vec2(sums.s[kCore + 1], sums.s[kCore + 2]) / n;
  float mean = sums.s[kCore + 6] / n;
  vec3 area = vec3(sums.s[kCore + 3], sums.s[kCore + 4], sums.s[kCore + 5]) - n * vec3(middle.x * middle.x, middle.x * middle.y, middle.y * middle.y);
  vec2 lean = vec2(sums.s[kCore + 7], sums.s[kCore + 8]) - n * mean * middle;
  float determinant = area.x * area.z - area.y * area.y;
  if (min(area.x, area.z) < 0.5 || determinant <= kLeastSpread * area.x * area.z) return none;
  vec2 gradient = vec2(area.z * lean.x - area.y * lean.y, area.x * lean.y - area.y * lean.x) / determinant;  // N per pitch
  float missed = max(sums.s[kCore + 9] - n * mean * mean - dot(gradient, lean), 0.0);
  float mean_force = force + mean;
  if (mean_force <= 0.0) return none;
  float stiffness = STIFFNESS * (EXPONENT == 1.0 ? 1.0 : pow(mean_force / plane.pitch.w, 1.0 - 1.0 / EXPONENT));
  vec2 slope = gradient / (plane.pitch.xy * plane.pitch.w * stiffness);
  return Tilt(vec2(angleOf(-slope.y, 1.0), angleOf(slope.x, 1.0)), max(1.0 - sqrt(missed / (n - 3.0)) / mean_force, 0.0));
}

// From the length and width of the patch of even pressure that has these second moments, less what spread and taxels add.
float typeOf(PlaneRecord plane, vec3 second, float force, float least_force) {
  if (force <= least_force) return kContactNone;
  Axes touched = axesOf(second - plane.spread.xyz);
  float pitch = length(vec2(cos(touched.angle), sin(touched.angle)) * plane.pitch.xy);
  float size = sqrt(12.0 * max(touched.large, 0.0)), width = sqrt(12.0 * touched.small);
  if (size <= kLongestPoint * pitch) return kContactPoint;
  return width <= kWidestEdge * size ? kContactEdge : kContactArea;
}

void writeRow(uint row, uint num_rows, PlaneRecord plane, float patch_number, Moments moments, vec3 middle, Axes windowed, Tilt tilt, float type) {
  writeMoments(0, row, num_rows, moments, middle, plane.X_SC_row0, plane.X_SC_row1, plane.X_SC_row2);
  features[kContactWindowedEdgeAngle * num_rows + row] = windowed.angle;
  features[kContactWindowedEdgeConfidence * num_rows + row] = windowed.confidence;
  features[kContactTilt * num_rows + 2 * row] = tilt.angles.x;
  features[kContactTilt * num_rows + 2 * row + 1] = tilt.angles.y;
  features[kContactTiltConfidence * num_rows + row] = tilt.confidence;
  features[kContactType * num_rows + row] = type;
  features[kContactPatch * num_rows + row] = patch_number;
}

// Part `number` (below kParts) of an instance; empty where it has nothing to do.
Part partOf(uint instance, uint number, bool is_due) {
  uint plane = kOnePatch ? 0 : LAST_PLANE;
  uint first = 0, end = NUM_TAXELS, region = kNoRegion;
  bool is_grid = kOnePatch;
  if (number >= kFirstRegion) {
    if (is_due) region = regions[instance * REGIONS + number - kFirstRegion];
    if (region == kNoRegion) end = 0;
  }
  if (!kOnePatch && !kList && number > 0 && end > 0) {
    plane = number < kFirstRegion ? number - 1 : uint(taxels[region].readout.z);
    uvec4 grid = planes[plane].grid;
    first = grid.z;
    end = grid.z + grid.x * grid.y;
    is_grid = true;
  }
  if (!is_due) end = 0;
  return Part(instance * NUM_TAXELS, first, end, region, plane, is_grid, planes[plane].pitch, vec2(planes[plane].grid.xy));
}

// Every team goes the same way through the barriers; one without a part of its own (`is_there` false) does and writes nothing. Between the sensor's own frames
// measured values stay.
void featuresOf(uint number, bool is_there, uint num_instances) {
  uint instance = number % num_instances, which = number / num_instances;
  bool is_due = is_there && (CLEAN || (instances[instance].keys.w & kFlagNewFrame) != 0);
  Part part = partOf(instance, which, is_due);
  Sums sums = sumsOf(kScanForce, part, vec3(0), 0.0);
  if (kList && REGIONS > 0) {
    Sums peak = sumsOf(kScanPeak, part, vec3(0), sums.s[0]);
    if (part.region != kNoRegion) part.plane = uint(taxels[uint(kTaxelNumbers - peak.s[0])].readout.z);
    sums = sumsOf(kScanForce, part, vec3(0), 0.0);
  }
  Moments moments = Moments(sums.s[1], vec3(0), vec3(0), sums.s[0], sums.s[5]);
  float num_reporting = sums.s[6];
  float mean_force = moments.force / max(num_reporting, 1.0);
  vec3 center = vec3(0);
  if (moments.force > 0.0) center = vec3(sums.s[2], sums.s[3], sums.s[4]) / moments.force;
  Sums core = sumsOf(kScanSecond, part, center, mean_force);
  moments.first = vec3(core.s[0], core.s[1], core.s[2]);
  moments.second = vec3(core.s[3], core.s[4], core.s[5]);
  Axes axes = windowedAxes(part, center, moments.force);
  if (!is_due || gl_LocalInvocationIndex % TEAM > 0) return;

  PlaneRecord plane = planes[part.plane];
  Tilt tilt = Tilt(vec2(0), 0.0);
  if (part.is_grid) tilt = tiltOf(plane, core, mean_force);
  float num_taxels = which >= kFirstRegion ? num_reporting : float(part.end - part.first);
  float noise = CLEAN ? 0.0 : sqrt(NOISE * NOISE + instances[instance].drive.w * instances[instance].drive.w) / SLOPE;
  vec3 second = vec3(0);
  if (moments.force > 0.0) second = centralMoments(moments.force, moments.first.xy, moments.second);
  float type = typeOf(plane, second, moments.force, kNoiseFactor * noise * sqrt(num_taxels));
  uint num_rows = num_instances * kRows;
  uint row = instance * kRows + which + (kOnePatch && which > 0 ? 1 : 0);
  float patch_number = part.plane == LAST_PLANE ? -1.0 : float(part.plane);
  writeRow(row, num_rows, plane, patch_number, moments, center, axes, tilt, type);
  if (kOnePatch && which == 0) writeRow(row + 1, num_rows, plane, patch_number, moments, center, axes, tilt, type);
}

void main() {
  uint num_instances = step_record.batch.x;
  uint num_parts = num_instances * kParts;
  uint number = workgroupNumber() * REPEAT * kTeams + gl_LocalInvocationIndex / TEAM;
  uint r = 0;
  for (; r < REPEAT; ++r, number += kTeams) featuresOf(min(number, num_parts - 1), number < num_parts, num_instances);
  if (cut_short || r < REPEAT) problems[0] = 1;
}
