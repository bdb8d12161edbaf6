#version 460
#extension GL_GOOGLE_include_directive : require
// Contacts pass: stages 1 and 2 of one frame where another engine has found contacts and forces; paper eq. (2), by the rule of
// include/taxelsim/contact_point.h.
//
// TEAM invocations share an instance; a workgroup has WORKGROUP / TEAM teams, and each does REPEAT instances one after another. Every
// invocation looks at all contacts of its instance and adds up those of its own taxels, which are lane, lane + TEAM, ...: no sum crosses
// invocations.
// In:  contacts (num_instances x room for contacts), num_contacts (num_instances), the sensor's patches.
// Out: contact_normal (num_instances x num_taxels), N, over the part of the spread's kernel that stays on the sensor; tile_results
//      (num_instances x num_tiles): all of it in the first tile's; off-array features.
// Shared memory: none.
// Deterministic: forces are added in the order in which the contacts were given.
// Twin: src/reference/contact_points.cpp.

#include "shared/batch.h"
#include "shared/features.h"
#include "shared/sensor.h"
#include "passes/declare.glsl"
#include "passes/contacts.h"

const float kRimTolerance = 1e-6;  // m, include/taxelsim/contact_point.h
const uint kNoCell = 0xFFFFFFFFu;
const bool kTaxelList = NUM_PATCHES > 1 && NUM_PATCHES == NUM_TAXELS;  // places of their own

// A loop ended before its work was done; see contact.comp.
bool cut_short = false;

#include "common/workgroup.glsl"
#include "common/transform.glsl"

struct Patch {
  Affine X_PS;
  uvec2 size;  // rows, cols
  uint first_taxel;
  vec2 pitch;  // m
};

Patch patchAt(uint p) {
  Patch patch_p;
  patch_p.X_PS = Affine(vec4(1, 0, 0, 0), vec4(0, 1, 0, 0), vec4(0, 0, 1, 0));
  if (!FLAT) patch_p.X_PS = Affine(patches[p].row0, patches[p].row1, patches[p].row2);
  patch_p.size = uvec2(NUM_ROWS, NUM_COLS);
  patch_p.first_taxel = 0;
  patch_p.pitch = vec2(PITCH_X, PITCH_Y);
  if (NUM_ROWS == 0) {
    patch_p.size = patches[p].grid.xy;
    patch_p.first_taxel = patches[p].grid.z;
    patch_p.pitch = patches[p].spacing.xy * float(SAMPLES);
  }
  return patch_p;
}

// Number of the cell of a row of `count` cells in which x lies, m from the row's middle.
//
//      cell 0        cell 1               cell count - 1
//   [- - - - - -)[- - - - - -)    ...   [- - - - - - - -]
//
// A quotient may be a few units in the last place off, by driver; a border is a product, rounded once everywhere, and decides.
uint cellOf(float x, uint count, float pitch) {
  float middle = 0.5 * float(count);
  if (!(abs(x) <= middle * pitch + kRimTolerance)) return kNoCell;
  float cell = floor(x / pitch + middle);
  if (x < (cell - middle) * pitch) {
    cell -= 1.0;
  } else if (x >= (cell + 1.0 - middle) * pitch) {
    cell += 1.0;
  }
  return uint(clamp(cell, 0.0, float(count) - 1.0));
}

// Where a contact belongs.
struct Place {
  uint taxel;   // of the sensor; kNoCell: none
  uvec2 cell;   // row and column in its patch
  vec3 normal;  // z of the patch in S
};

Place placeOn(Patch on, vec3 p_SQ_S, float band) {
  vec3 p_PQ_P = p_SQ_S;
  if (!FLAT) p_PQ_P = apply(on.X_PS, p_SQ_S);
  uvec2 cell = uvec2(cellOf(p_PQ_P.x, on.size.x, on.pitch.x), cellOf(p_PQ_P.y, on.size.y, on.pitch.y));
  bool inside = cell.x != kNoCell && cell.y != kNoCell && p_PQ_P.z >= -THICKNESS && p_PQ_P.z <= band;
  return Place(inside ? on.first_taxel + cell.x * on.size.y + cell.y : kNoCell, cell, on.X_PS.row2.xyz);
}

// Of taxels with places of their own the one in whose rectangle the contact lies nearest the middle.
Place placeInList(vec3 p_SQ_S, float band) {
  Place at = Place(kNoCell, uvec2(0), vec3(0));
  float least = 0.5;  // the ellipse through the corners
  uint t = 0;
  for (; t < NUM_PATCHES; ++t) {
    Patch on = patchAt(t);
    vec3 p_PQ_P = apply(on.X_PS, p_SQ_S);
    vec2 off = p_PQ_P.xy / on.pitch;
    float away = dot(off, off);
    if (p_PQ_P.z < -THICKNESS || p_PQ_P.z > band || !(away < least)) continue;
    least = away;
    at = Place(t, uvec2(0), on.X_PS.row2.xyz);
  }
  cut_short = cut_short || t < NUM_PATCHES;
  return at;
}

// Where the volumes of patches hold the contact, the first.
Place placeOnPatches(Patch first_patch, vec3 p_SQ_S, float band) {
  Place at = placeOn(first_patch, p_SQ_S, band);
  uint p = 1;
  for (; p < NUM_PATCHES && at.taxel == kNoCell; ++p) at = placeOn(patchAt(p), p_SQ_S, band);
  cut_short = cut_short || (p < NUM_PATCHES && at.taxel == kNoCell);
  return at;
}

// What an instance's contacts sum to.
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

void contactsOf(uint instance, uint num_instances, uint room, float band, Patch first_patch) {
  uint lane = gl_LocalInvocationIndex % TEAM;
  uint first_taxel = instance * NUM_TAXELS;
  uint t = lane;
  for (; t < NUM_TAXELS; t += TEAM) contact_normal[first_taxel + t] = 0.0;

  Sums sums = Sums(vec3(0), vec3(0), 0.0, 0.0, 0u, uvec2(kNoCell), uvec2(0));
  uint count = num_contacts[instance];
  uint k = 0;
  for (; k < count; ++k) {
    vec4 point = contacts[instance * room + k].point;
    Place at;
    if (kTaxelList) {
      at = placeInList(point.xyz, band);
    } else {
      at = placeOnPatches(first_patch, point.xyz, band);
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
  cut_short = cut_short || t < NUM_TAXELS || k < count;
  if (lane == 0) writeResults(instance, num_instances, sums);
}

void main() {
  uvec4 batch = step_record.batch;
  const uint kTeams = WORKGROUP / TEAM;
  Patch first_patch = patchAt(0);
  uint instance = workgroupNumber() * REPEAT * kTeams + gl_LocalInvocationIndex / TEAM;
  uint r = 0;
  for (; r < REPEAT; ++r, instance += kTeams) {
    if (instance < batch.x) contactsOf(instance, batch.x, batch.y, step_record.contacts.x, first_patch);
  }
  if (cut_short || r < REPEAT) problems[0] = 1;
}
