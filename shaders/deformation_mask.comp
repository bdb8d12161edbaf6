#version 460
#extension GL_GOOGLE_include_directive : require
// Pass of the law deformation_mask, after the contact pass: the force on a taxel also deforms its neighbours, by a mask, and every taxel
// saturates; where one does, the forces of all taxels are scaled so that their sum is the contact force again. include/taxelsim/sensor.h,
// DeformationMask.
//
// A workgroup has WORKGROUP / TEAM teams, each of which owns an instance; an invocation owns rows of taxels, as in the image pass.
// In:  contact_normal (num_instances x num_taxels), N, on one grid patch divided by the part of the mask that stays on the sensor;
//      tile_results (num_instances x num_tiles); mask (MASK_SOURCES / 2 x num_taxels): two sources of every taxel of another sensor.
// Out: masked_normal (num_instances x num_taxels), N, divided by the part of the spread's kernel that stays on the sensor; on a grid of one
//      tile only around the window of its result. law_state (num_instances x num_taxels), .x: force before it is scaled, N.
// Shared memory: 8 PARTIALS bytes.
// Deterministic: sums run over at most LANES partial sums in a fixed order, whatever the size of team and workgroup.
// Mutable globals: any_unfinished_loop (driver/loops.glsl).
// Reference: src/reference/taxel_laws.cpp.

#include "passes/declare.glsl"
#include "passes/deformation_mask.h"

#include "common/instances.glsl"
#include "driver/loops.glsl"

const bool WHOLE_ARRAY = false;
const uint kContactMargin = 0u, kSpreadRadius = 1u;
#include "readout/image_window.glsl"

const uint kRowsAtOnce = kOnePatch && TEAM == 1 && LANES > 1 ? 2 : 1;
const bool kWritesAll = NUM_TILES > 1 || OUTPUT_RESPONSE;

shared vec2 partial_sums[PARTIALS];

// Forces of the sources in rows i - 1 to i + 2 of a column; 0 outside of the window of contact.
vec4 columnAt(uint first_taxel, ImageWindow window, ivec2 at) {
  vec4 column = vec4(0);
  for (int d = 0; d < 2 + int(kRowsAtOnce); ++d) {
    uvec2 source = uvec2(at + ivec2(d - 1, 0));  // -1 wraps to a large number
    if (any(greaterThanEqual(source - window.contact_first, window.contact_count))) continue;
    column[d] = floatOfFours(ForceFours, first_taxel + source.x * NUM_COLS + source.y);
  }
  return column;
}

// Force of the taxel in the middle of three columns.
float masked(vec3 before, vec3 here, vec3 after) {
  float sides = (before.y + after.y) + (here.x + here.z), corners = (before.x + before.z) + (after.x + after.z);
  return kMaskMiddle * here.y + (kMaskSide * sides + kMaskCorner * corners);
}

float maskedByList(uint first_taxel, uint taxel) {
  float force = 0.0;
  for (uint e = 0; e < MASK_SOURCES / 2u; ++e) {
    uvec4 sources = fourOf(Mask, e * NUM_TAXELS + taxel);
    force += uintBitsToFloat(sources.y) * contact_normal[first_taxel + sources.x];
    force += uintBitsToFloat(sources.w) * contact_normal[first_taxel + sources.z];
  }
  return force;
}

// `sums`: of the forces, and of the number of taxels that saturate at the force `most`.
void writeTaxel(uint first_taxel, uint taxel, float force, float most, inout vec2 sums) {
  sums += vec2(min(force, most), force > most ? 1.0 : 0.0);
  force = min(force, most);
  if (OUTPUT_RESPONSE) law_state[first_taxel + taxel].x = force;
  masked_normal[first_taxel + taxel] = SCALED ? force * spread_scale[taxel] : force;
}

// Row `i` of the window and, with kRowsAtOnce 2, the next one if there is one.
void maskRows(uint first_taxel, ImageWindow window, uint i, inout vec2 sums, inout vec2 next_sums) {
  vec2 row = vec2(0), next_row = vec2(0);
  uvec2 at = uvec2(window.first.x + i, window.first.y);
  float most = LAW_0 * taxels[0].chart.w;
  vec4 before, here = vec4(0), after;
  if (kOnePatch) after = columnAt(first_taxel, window, ivec2(at));
  uint j = 0;
  for (; j < window.count.y; ++j, ++at.y) {
    uint t = at.x * kCols + at.y;
    if (!kOnePatch) {
      if (t < NUM_TAXELS) writeTaxel(first_taxel, t, maskedByList(first_taxel, t), LAW_0 * taxels[t].chart.w, row);
      continue;
    }
    before = here;
    here = after;
    after = columnAt(first_taxel, window, ivec2(at) + ivec2(0, 1));
    writeTaxel(first_taxel, t, masked(before.xyz, here.xyz, after.xyz), most, row);
    if (kRowsAtOnce > 1 && i + 1 < window.count.x)
      writeTaxel(first_taxel, t + kCols, masked(before.yzw, here.yzw, after.yzw), most, next_row);
  }
  checkLoop(j < window.count.y);
  sums += row;
  next_sums += next_row;
}

// Sums over all rows, the same for every invocation of the team. `num_parts`: partial sums of the team.
vec2 maskInstance(uint first_taxel, ImageWindow window, uint lane, uint num_parts) {
  vec2 total = vec2(0);
  uint first_partial = gl_LocalInvocationIndex / TEAM * LANES;
  for (uint v = lane * kRowsAtOnce; v < num_parts; v += TEAM * kRowsAtOnce) {
    vec2 part = vec2(0), next_part = vec2(0);
    uint i = v;
    for (; i < window.count.x; i += LANES) maskRows(first_taxel, window, i, part, next_part);
    checkLoop(i < window.count.x);
    if (TEAM == 1) {
      total += part;
      total += next_part;
    } else {
      partial_sums[first_partial + v] = part;
    }
  }
  if (TEAM > 1) {
    barrier();
    for (uint v = 0; v < num_parts; ++v) total += partial_sums[first_partial + v];
  }
  return total;
}

// Scales the rows that this invocation has written.
void scaleRows(uint first_taxel, ImageWindow window, uint lane, uint num_parts, float scale) {
  for (uint v = lane; v < num_parts; v += TEAM) {
    uint i = v;
    for (; i < window.count.x; i += LANES) {
      uint first = first_taxel + (window.first.x + i) * kCols + window.first.y;
      uint count = min(window.count.y, first_taxel + NUM_TAXELS - first), j = 0;
      for (; j < count; ++j) masked_normal[first + j] *= scale;
      checkLoop(j < count);
    }
    checkLoop(i < window.count.x);
  }
}

void main() {
  const uint kTeams = WORKGROUP / TEAM;
  uint number = workgroupNumber() * kTeams + gl_LocalInvocationIndex / TEAM, lane = gl_LocalInvocationIndex % TEAM;
  uint instance = min(number, step_record.batch.x - 1), first_taxel = instance * NUM_TAXELS;
  ImageWindow window = imageWindow(instance, kWritesAll);
  uint num_parts = isProcessed(number) ? min(LANES, window.count.x) : 0;
  vec2 carried = maskInstance(first_taxel, window, lane, num_parts);
  float pressed = 0.0;
  for (uint t = 0; t < NUM_TILES; ++t) pressed += tileResult(instance * NUM_TILES + t).torque.w;
  scaleRows(first_taxel, window, lane, carried.y > 0.0 ? num_parts : 0, carried.x > 0.0 ? pressed / carried.x : 0.0);
  reportUnfinishedLoops();
}
