#version 460
#extension GL_GOOGLE_include_directive : require
// Contacts pass: replaces stages 1 and 2 of one frame where another engine has found contacts and their forces; paper eq. (2). The rule is
// in include/taxelsim/contact_point.h.
//
// A workgroup has WORKGROUP / TEAM teams; each team processes REPEAT instances in sequence. Every invocation reads all contacts of its
// instance and adds up those of its own taxels, lane, lane + TEAM, ...: no sum crosses invocations.
// In:  contacts (num_instances x room for contacts), num_contacts (num_instances), the sensor's patches.
// Out: contact_normal (num_instances x num_taxels), N, divided by the part of the spread's kernel that stays on the sensor; tile_results
//      (num_instances x num_tiles), the whole result in that of the first tile; features of contacts outside the taxels.
// Shared memory: none.
// Deterministic: forces are added in the order in which the contacts were given.
// Mutable globals: any_unfinished_loop (driver/loops.glsl).
// Reference: src/reference/contact_points.cpp.

#include "shared/features.h"
#include "passes/declare.glsl"
#include "passes/contacts.h"

#include "common/instances.glsl"
#include "common/transform.glsl"
#include "driver/loops.glsl"
#include "depth/contact_taxels.glsl"

// Sums over the contacts of an instance.
struct Sums {
  vec3 force, torque;  // on the sensor, in S, at its origin
  float normal, off_array_load;
  uint num_off_array;
  uvec2 first, end;  // rectangle of cells
};

void writeResults(uint instance, uint num_instances, Sums sums) {
  bool touched = sums.end.x > 0;
  for (uint t = 0; t < NUM_TILES; ++t) {
    TileResult result = TileResult(vec4(0), vec4(0), uvec4(0));
    if (t == 0 && touched) {
      result.force.xyz = sums.force;
      result.torque = vec4(sums.torque, sums.normal);
      result.window = uvec4(sums.first.x, sums.end.x, sums.first.y, sums.end.y);
    }
    tile_results[instance * NUM_TILES + t] = result;
  }
  features[kFeatureOffArrayLoad * num_instances + instance] = sums.off_array_load;
  features[kFeatureOffArrayContacts * num_instances + instance] = float(sums.num_off_array);
}

void sumContacts(uint instance, uint num_instances, uint room, float band, Patch first_patch) {
  uint lane = gl_LocalInvocationIndex % TEAM;
  uint first_taxel = instance * NUM_TAXELS;
  uint t = lane;
  for (; t < NUM_TAXELS; t += TEAM) contact_normal[first_taxel + t] = 0.0;

  Sums sums = Sums(vec3(0), vec3(0), 0.0, 0.0, 0u, uvec2(kNoCell), uvec2(0));
  uint count = num_contacts[instance];
  uint k = 0;
  for (; k < count; ++k) {
    vec4 point = contacts[instance * room + k].point;
    ContactTaxel at;
    if (kTaxelList) {
      at = taxelInList(point.xyz, band);
    } else {
      at = taxelOnPatches(first_patch, point.xyz, band);
    }
    if (at.taxel == kNoCell) {
      sums.off_array_load += point.w;
      ++sums.num_off_array;
      continue;
    }
    vec3 force = -point.w * at.normal;
    sums.force += force;
    sums.torque += cross(point.xyz, force);
    sums.normal += point.w;
    sums.first = min(sums.first, at.cell);
    sums.end = max(sums.end, at.cell + 1u);
    if (TEAM > 1 && at.taxel % TEAM != lane) continue;
    contact_normal[first_taxel + at.taxel] += SCALED ? point.w * spread_scale[at.taxel] : point.w;
  }
  checkLoop(t < NUM_TAXELS || k < count);
  if (lane == 0) writeResults(instance, num_instances, sums);
}

void main() {
  uvec4 batch = step_record.batch;
  const uint kTeams = WORKGROUP / TEAM;
  Patch first_patch = patchAt(0);
  uint instance = workgroupNumber() * REPEAT * kTeams + gl_LocalInvocationIndex / TEAM;
  uint r = 0;
  for (; r < REPEAT; ++r, instance += kTeams) {
    if (isProcessed(instance)) sumContacts(instance, batch.x, batch.y, step_record.contacts.x, first_patch);
  }
  checkLoop(r < REPEAT);
  reportUnfinishedLoops();
}
