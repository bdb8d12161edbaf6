#version 460
#extension GL_GOOGLE_include_directive : require
// Keeping candidates: for which instances the quads that find_candidates.comp has found before still are all that the contact pass need look at. First
// pass of a frame, where a batch's objects are meshes.
//
// A quad that no sample can see now, nor after its object has moved within bounds, is no candidate until the object leaves these. The bounds are some steps
// of the motion so far, so that finding candidates is paid for by the steps that use them. An object that moves too fast for that has none, and the
// contact pass culls its mesh. Candidates are still tested exactly, so that no bit shows which way an instance went.
//
// An invocation owns an instance.
// In:  poses, objects, the sensor's patch.
// Out: candidates (num_instances), work lists.

#include "driver/texels.glsl"
#include "shared/batch.h"
#include "shared/candidates.h"
#include "shared/objects.h"
#include "shared/sensor.h"
#include "passes/declare.glsl"
#include "passes/keep_candidates.h"

// Measured on software drivers. Finding costs once in so many steps, the room for so many in each of them: together least where their number goes with
// the root of the speed.
const float kStepsAhead = 2.0;  // at a sample's spacing a step
const float kMostStepsAhead = 32.0;
const float kMostMotion = 0.4;        // of the samples' spacing, in all these steps
const float kLeastMotion = 1.0 / 64;  // the same: any object may tremble by so much
const float kFewestStepsAhead = 3.0;  // else nothing is won

const float kMiss = kNoHeight;

#include "common/workgroup.glsl"
#include "common/whole.glsl"
#include "common/transform.glsl"
#include "depth/window.glsl"
#include "depth/bodies.glsl"
#include "common/work_lists.glsl"

float greatestOf(vec3 v) { return max(v.x, max(v.y, v.z)); }

// The part of the window that a body's bounds reach, in P, m.
void reachedPart(Body body, out vec3 center, out vec3 half_size) {
  vec3 low = max(body.center - body.half_size, vec3(tile_first, -1e9));
  vec3 high = min(body.center + body.half_size, vec3(tile_end - 1.0, z_limit));
  center = 0.5 * (low + high) * vec3(spacing, 1) + vec3(patch_corner, 0);
  half_size = 0.5 * max(high - low, 0.0) * vec3(spacing, 1);
}

// Between which bounds a point of the object that is in the window, or comes into it, has moved along x, y, z of P, m. A point outside the part of the
// window by r in the maximum norm moves by at most a r more than one in it, a being the rotation's largest sum of a row; since it comes in, r is at most
// its motion.
void motionOf(CandidateRecord before, Affine X_PO, out vec3 low, out vec3 high) {
  mat3 R = transpose(mat3(X_PO.row0.xyz, X_PO.row1.xyz, X_PO.row2.xyz)) * mat3(before.row0.xyz, before.row1.xyz, before.row2.xyz);  // R_new R_old^T
  vec3 p_old = vec3(before.row0.w, before.row1.w, before.row2.w), p_new = vec3(X_PO.row0.w, X_PO.row1.w, X_PO.row2.w);
  mat3 turn = R - mat3(1);
  mat3 size = mat3(abs(turn[0]), abs(turn[1]), abs(turn[2]));
  vec3 middle = p_new - R * p_old + turn * before.center.xyz;
  vec3 half_size = size * before.half_size.xyz;
  float a = greatestOf(size * vec3(1));
  const float kRounding = 1e-6;  // of floats of these coordinates, several times
  float more = a / (1.0 - a) * greatestOf(abs(middle) + half_size) + kRounding * (greatestOf(abs(p_old)) + spacing.x);
  low = middle - half_size - more;
  high = middle + half_size + more;
  if (a < 0.5) return;
  low = vec3(-kMiss);
  high = vec3(kMiss);
}

// To which list the instance goes. Leaves what the next step needs to know.
uint listOf(uint instance) {
  int id = objectInSlot(instance);
  Body body = bodyInSlot(instance, max(id, 0));
  CandidateRecord before = candidates[instance];
  bool suits = id >= 0 && body.near && body.kind_groups.x == kKindMesh && body.kind_groups.z >= kMinGroups;
  bool known = suits && before.list.x == uint(id + 1);
  bool listed = known && before.list.y != kNoCandidates;
  vec3 low, high;
  motionOf(before, body.X_PO, low, high);
  if (listed && all(greaterThanEqual(low, before.low.xyz)) && all(lessThanEqual(high, before.high.xyz))) {
    candidates[instance].center.w = before.center.w + 1.0;
    atomicAdd(work[kNumLists].x, 1u);
    return step_record.candidates.x != 0 ? kListCandidates : kListWholeMesh;
  }
  float wait = listed || !known ? 0.0 : max(before.center.w - 1.0, 0.0);
  float share = known && before.half_size.w > 0.0 ? before.half_size.w : 1.0;
  // As fast as so far, and a little otherwise.
  float per_step = 1.0 / (listed ? before.center.w + 1.0 : 1.0), unit = min(spacing.x, spacing.y);
  float speed = max(greatestOf(max(high, -low)) * per_step, 1e-6 * unit), relative = speed / unit;
  float steps = min(min(kStepsAhead * inversesqrt(relative), kMostMotion / relative), kMostStepsAhead);
  float otherwise = max(kLeastMotion * unit, 0.5 * speed);
  low = min(share * steps * per_step * low, 0.0) - otherwise;
  high = max(share * steps * per_step * high, 0.0) + otherwise;
  vec3 center, half_size;
  reachedPart(body, center, half_size);
  candidates[instance] = CandidateRecord(body.X_PO.row0, body.X_PO.row1, body.X_PO.row2, vec4(center, wait), vec4(half_size, share), vec4(low, 0),
                                         vec4(high, 0), uvec4(suits ? uint(id + 1) : 0u, kNoCandidates, 0, 0));
  return known && wait == 0.0 && steps >= kFewestStepsAhead ? kListFindCandidates : kListWholeMesh;
}

void main() {
  enterWindow(0);
  uint instance = workgroupNumber() * WORKGROUP + gl_LocalInvocationIndex;
  if (instance < step_record.batch.x) enlist(listOf(instance), instance, LISTED_PER_WORKGROUP);
}
