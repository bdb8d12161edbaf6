#version 460
#extension GL_GOOGLE_include_directive : require
// Pass that keeps candidates: decides for which instances the quads that find_candidates.comp has found still suffice for the contact pass
// (temporal coherence). First pass of a frame of a batch with meshes.
//
// A quad that covers no sample now, nor after any motion of its object within the bounds, is no candidate until the object leaves the
// bounds. The bounds are some steps of the motion so far, so that the cost of finding candidates is shared by the steps that use them. An
// object that moves too fast has no candidates, and the contact pass culls its mesh. Candidates are tested exactly, so that results do not
// depend on which path an instance takes.
//
// An invocation owns an instance.
// In:  poses, objects, the sensor's patch.
// Out: candidates (num_instances), work lists.
// Shared memory: none.
// Mutable globals: none.

#include "passes/declare.glsl"
#include "passes/keep_candidates.h"

// Measured with the path `candidates` (docs/notes/performance.md). Finding costs once per kStepsAhead steps, larger bounds cost in each of
// them; the total is least when the number of steps is inversely proportional to the square root of the speed.
const float kStepsAhead = 2.0;  // at a speed of one sample spacing per step
const float kMaxStepsAhead = 32.0;
const float kMaxMotion = 0.4;       // sample spacings, over all these steps
const float kMinMotion = 1.0 / 64;  // sample spacings; bounds of an object at rest
const float kMinStepsAhead = 3.0;   // fewer do not pay

#include "depth/tile.glsl"
#include "common/work_lists.glsl"

float largestOf(vec3 v) { return max(v.x, max(v.y, v.z)); }

// The part of the tile that a body's bounds reach, in P, m.
void reachedPart(Tile tile, Body body, out vec3 center, out vec3 half_size) {
  vec3 low = max(body.center - body.half_size, vec3(tile.first - kSampleReach, -1e9));
  vec3 high = min(body.center + body.half_size, vec3(tile.end - 1.0 + kSampleReach, tile.z_limit));
  center = 0.5 * (low + high) * vec3(tile.spacing, 1) + vec3(tile.corner, 0);
  half_size = 0.5 * max(high - low, 0.0) * vec3(tile.spacing, 1);
}

// Bounds of the motion along x, y, z of P (m) of any point of the object that is or comes into the part of the tile. A point outside that
// part by r in the maximum norm moves by at most a r more than a point inside, where a is the rotation's largest row sum; since it comes
// in, r is at most its motion.
void motionBounds(Tile tile, CandidateRecord before, Affine X_PO, out vec3 low, out vec3 high) {
  mat3 R = transpose(mat3(X_PO.row0.xyz, X_PO.row1.xyz, X_PO.row2.xyz)) *
           mat3(before.row0.xyz, before.row1.xyz, before.row2.xyz);  // R_new R_old^T
  vec3 p_old = vec3(before.row0.w, before.row1.w, before.row2.w), p_new = vec3(X_PO.row0.w, X_PO.row1.w, X_PO.row2.w);
  mat3 rotation = R - mat3(1);
  mat3 size = mat3(abs(rotation[0]), abs(rotation[1]), abs(rotation[2]));
  vec3 middle = p_new - R * p_old + rotation * before.center.xyz;
  vec3 half_size = size * before.half_size.xyz;
  float a = largestOf(size * vec3(1));
  const float kRounding = 1e-6;  // several roundings of floats of these coordinates
  float more = a / (1.0 - a) * largestOf(abs(middle) + half_size) + kRounding * (largestOf(abs(p_old)) + tile.spacing.x);
  low = middle - half_size - more;
  high = middle + half_size + more;
  if (a < 0.5) return;
  low = vec3(-kNoHeight);
  high = vec3(kNoHeight);
}

// Returns the list for the instance. Writes its CandidateRecord for the next step.
uint listOf(Tile tile, uint instance) {
  int id = objectInSlot(instance);
  Body body = bodyInSlot(tile, instance, max(id, 0));
  CandidateRecord before = candidates[instance];
  bool suits = id >= 0 && body.near && body.kind_groups.x == kKindMesh && body.kind_groups.z >= kMinGroups;
  bool known = suits && before.list.x == uint(id + 1);
  bool listed = known && before.list.y != kNoCandidates;
  vec3 low, high;
  motionBounds(tile, before, body.X_PO, low, high);
  if (listed && all(greaterThanEqual(low, before.low.xyz)) && all(lessThanEqual(high, before.high.xyz))) {
    candidates[instance].center.w = before.center.w + 1.0;
    atomicAdd(work[kNumLists].x, 1u);
    return step_record.candidates.x != 0 ? kListCandidates : kListWholeMesh;
  }
  float wait = listed || !known ? 0.0 : max(before.center.w - 1.0, 0.0);
  float share = known && before.half_size.w > 0.0 ? before.half_size.w : 1.0;
  // Expects the speed so far, and some motion in other directions.
  float per_step = 1.0 / (listed ? before.center.w + 1.0 : 1.0), unit = min(tile.spacing.x, tile.spacing.y);
  float speed = max(largestOf(max(high, -low)) * per_step, 1e-6 * unit), relative = speed / unit;
  float steps = min(min(kStepsAhead * inversesqrt(relative), kMaxMotion / relative), kMaxStepsAhead);
  float margin = max(kMinMotion * unit, 0.5 * speed);
  low = min(share * steps * per_step * low, 0.0) - margin;
  high = max(share * steps * per_step * high, 0.0) + margin;
  vec3 center, half_size;
  reachedPart(tile, body, center, half_size);
  candidates[instance] = CandidateRecord(body.X_PO.row0, body.X_PO.row1, body.X_PO.row2, vec4(center, wait), vec4(half_size, share),
                                         vec4(low, 0), vec4(high, 0), uvec4(suits ? uint(id + 1) : 0u, kNoCandidates, 0, 0));
  return known && wait == 0.0 && steps >= kMinStepsAhead ? kListFindCandidates : kListWholeMesh;
}

void main() {
  Tile tile = loadTile(0);
  uint instance = workgroupNumber() * WORKGROUP + gl_LocalInvocationIndex;
  if (instance >= step_record.batch.x) return;
  uint list = listOf(tile, instance);
  appendToList(list, instance, list == kListFindCandidates ? FOUND_PER_WORKGROUP : LISTED_PER_WORKGROUP);
}
