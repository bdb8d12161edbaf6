#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
// Contact features pass: moments, edge angle under a window and of a fitted ridge, tilt of a flat face and type of the contact, of the
// sensor, of each of its patches and of each region. Runs after contact_regions.comp.
//
// TEAM invocations share a part (one row of an instance); a workgroup has WORKGROUP / TEAM teams, and each team processes the same part of
// REPEAT instances in sequence. The parts of a block of instances are in consecutive workgroups: most regions do not exist, and drivers
// give each thread consecutive workgroups.
// In:  forces, N, and taxel_regions, shared/features.h (num_instances x num_taxels, features/taxel_words.glsl); regions (num_instances x
//      REGIONS).
// Out: features (block after block, each num_instances x num_rows x components, shared/features.h).
// Parts without force skip all scans but the first. The row of an only region is written with the sensor's (hasOnlyRegion()).
// Shared memory: 4 PARTIALS + 4 bytes.
// Deterministic: sums run over LANES partial sums in a fixed order, whatever the size of team and workgroup.
// Mutable globals: is_clean; any_unfinished_loop (driver/loops.glsl).
// Reference: src/reference/contact_features.cpp.

#include "shared/features.h"
#include "passes/declare.glsl"
#include "passes/contact_features.h"

const uint kTeams = WORKGROUP / TEAM;

bool is_clean;  // whether features are those of the clean forces

#include "common/instances.glsl"
#include "driver/loops.glsl"
#include "features/moments.glsl"
#include "features/taxel_words.glsl"
#include "features/contact_parts.glsl"
#include "features/part_sums.glsl"
#include "features/ridge.glsl"
#include "features/contact_sums.glsl"
#include "features/windowed_axes.glsl"
#include "features/ridge_edge.glsl"
#include "features/tilt.glsl"
#include "features/contact_type.glsl"

void writeRow(uint row, uint num_rows, PlaneRecord plane, float patch_number, Moments moments, vec3 middle, Axes windowed, Axes ridge,
              Tilt tilt, float type) {
  writeMoments(0, row, num_rows, moments, middle, plane.X_SC_row0, plane.X_SC_row1, plane.X_SC_row2);
  features[kContactWindowedEdgeAngle * num_rows + row] = windowed.angle;
  features[kContactWindowedEdgeConfidence * num_rows + row] = windowed.confidence;
  features[kContactTilt * num_rows + 2 * row] = tilt.angles.x;
  features[kContactTilt * num_rows + 2 * row + 1] = tilt.angles.y;
  features[kContactTiltConfidence * num_rows + row] = tilt.confidence;
  features[kContactType * num_rows + row] = type;
  features[kContactPatch * num_rows + row] = patch_number;
  features[kContactRidgeEdgeAngle * num_rows + row] = ridge.angle;
  features[kContactRidgeEdgeConfidence * num_rows + row] = ridge.confidence;
}

// For lists of taxels: the plane of a region is that of its taxel with the largest force, and its sums are computed again in that plane.
void choosePlane(inout Part part, inout PartSums sums) {
  PartSums peak = sumPart(kSumsPeak, part, vec3(0), sums.s[0]);
  if (part.region != kNoRegion) part.plane = uint(readoutOf(uint(kTaxelNumbers - peak.s[0])).z);
  sums = sumPart(kSumsForce, part, vec3(0), 0.0);
}

shared uint any_team;  // for isTrueForAnyTeam(); a scan's barriers lie between its last read and the next write

// Standard deviation of a taxel's force from noise, N.
float forceNoise(uint instance) {
  return is_clean ? 0.0 : sqrt(NOISE * NOISE + instanceRecord(instance).drive.w * instanceRecord(instance).drive.w) / SLOPE;
}

// Whether the condition holds for any team of the workgroup: all execute the same barriers. A team of one invocation has none, and decides
// alone.
bool isTrueForAnyTeam(bool condition) {
  if (TEAM == 1) return condition;
  if (gl_LocalInvocationIndex == 0) any_team = 0;
  barrier();
  if (condition) any_team = 1;
  barrier();
  return any_team != 0;
}

// All teams execute the same barriers; a team without a part of its own (`is_valid` false) writes nothing.
void computePart(uint instance, uint which, bool is_valid, uint num_instances) {
  bool is_due = is_valid && hasNewValues(instance, is_clean), has_only_region = is_due && hasOnlyRegion(instance);
  if (has_only_region && which == kFirstRegion) is_due = false;  // with the sensor
  Part part = loadPart(instance, which, is_due);
  PartSums sums = sumPart(kSumsForce, part, vec3(0), 0.0);
  if (kList && REGIONS > 0) choosePlane(part, sums);
  Moments moments = Moments(sums.s[1], vec3(0), vec3(0), sums.s[0], sums.s[5]);
  float num_reporting = sums.s[6];
  float mean_force = moments.force / max(num_reporting, 1.0);
  float noise = forceNoise(instance);
  vec3 center = vec3(0), second = vec3(0);
  PartSums core = noSums();
  Axes windowed = Axes(0.0, 0.0, 0.0, 0.0), ridge_axes = windowed;
  if (isTrueForAnyTeam(moments.force > 0.0)) {
    if (moments.force > 0.0) center = vec3(sums.s[2], sums.s[3], sums.s[4]) / moments.force;
    ForceWindow window = windowAt(center, moments.force);
    core = sumPart(kSumsWindow | kSumsSecond, part, center, mean_force);
    moveWindow(core, moments.force, window);
    moments.first = vec3(core.s[kAfterWindow], core.s[kAfterWindow + 1], core.s[kAfterWindow + 2]);
    moments.second = vec3(core.s[kAfterWindow + 3], core.s[kAfterWindow + 4], core.s[kAfterWindow + 5]);
    if (moments.force > 0.0) second = centralMoments(moments.force, moments.first.xy, moments.second);
    Ridge ridge = ridgeOf(part, second, center, moments.peak, noise);
    fitRidge(part, moments.force, window, ridge);
    windowed = axesOf(window);
    ridge_axes = axesOf(ridge, moments.peak);
  }
  if (!is_due || gl_LocalInvocationIndex % TEAM > 0) return;

  PlaneRecord plane = planeRecord(part.plane);
  Tilt tilt = Tilt(vec2(0), 0.0);
  if (part.is_grid) tilt = tiltOf(plane, core, mean_force);
  float any_type = typeOf(plane, second, moments.force), least_force = kNoiseFactor * noise;
  float region_type = moments.force > least_force * sqrt(num_reporting) ? any_type : kContactNone;
  float type = which >= kFirstRegion                                              ? region_type
               : moments.force > least_force * sqrt(float(part.end - part.first)) ? any_type
                                                                                  : kContactNone;
  uint num_rows = num_instances * kRows;
  uint row = instance * kRows + which + (kOnePatch && which > 0 ? 1 : 0);
  float patch_number = part.plane == LAST_PLANE ? -1.0 : float(part.plane);
  writeRow(row, num_rows, plane, patch_number, moments, center, windowed, ridge_axes, tilt, type);
  if (!kOnePatch || which > 0) return;
  writeRow(row + 1, num_rows, plane, patch_number, moments, center, windowed, ridge_axes, tilt, type);
  if (has_only_region) writeRow(row + 2, num_rows, plane, patch_number, moments, center, windowed, ridge_axes, tilt, region_type);
}

void main() {
  is_clean = feature_source != 0;
  uint num_instances = step_record.batch.x;
  uint number = workgroupNumber(), which = number % kParts;
  uint instance = number / kParts * REPEAT * kTeams + gl_LocalInvocationIndex / TEAM;
  uint r = 0;
  do {
    computePart(min(instance, num_instances - 1), which, instance < num_instances, num_instances);
    instance += kTeams;
  } while (++r < REPEAT);
  checkLoop(r < REPEAT);
  reportUnfinishedLoops();
}
