#version 460
#extension GL_GOOGLE_include_directive : require
// Finding candidates: all quads of its mesh that a sample may see while an instance's object stays within the bounds that keep_candidates.comp has set.
//
// A workgroup owns REPEAT instances of a list, one after another; an invocation owns boxes, then quads.
// In:  poses, objects, groups, clusters, quads of triangles, the sensor's patch, a work list.
// Out: candidates (num_instances), candidate_quads (num_instances x kMaxCandidates), work lists.
// Shared memory: 4 kClustersPerBatch + 4 GROUPS_PER_BATCH + 16 bytes.

#include "driver/barrier.glsl"
#include "driver/texels.glsl"
#include "shared/batch.h"
#include "shared/candidates.h"
#include "shared/objects.h"
#include "shared/sensor.h"
#include "passes/declare.glsl"
#include "passes/find_candidates.h"

const float kLeastShare = 0.25;    // of the steps ahead, where more of them are too many candidates
const float kStepsWithout = 32.0;  // where these are, too

shared uint num_found;

uint first_candidate;  // of the instance
bool cut_short = false;

#include "common/workgroup.glsl"
#include "common/whole.glsl"
#include "common/transform.glsl"
#include "depth/window.glsl"
#include "depth/bodies.glsl"
#include "depth/subpixels.glsl"
#include "depth/mesh.glsl"
#include "common/work_lists.glsl"

void visitQuad(Affine from_lattice, uint quad, bool large) {
  Vertex p, q, r, s;
  fetchQuad(from_lattice, quad, p, q, r, s);
  const ivec2 kRounding = ivec2(2);  // of vertices to units, and to be sure
  Box reached = Box(firstSample(min(min(p.at, q.at), min(r.at, s.at)) + motion_low - kRounding),
                    lastSample(max(max(p.at, q.at), max(r.at, s.at)) + motion_high + kRounding));
  if (min(min(p.z, q.z), min(r.z, s.z)) >= z_limit || !isAny(reached)) return;
  uint at = atomicAdd(num_found, 1u);
  if (at < kMaxCandidates) candidate_quads[first_candidate + at] = quad;
}

void findCandidates(uint instance) {
  uint lane = gl_LocalInvocationIndex;
  if (lane == 0) num_found = 0;
  workgroupBarrier();
  int id = objectInSlot(instance);
  Body body = bodyInSlot(instance, id);
  subpixel_bits = int(body.kind_groups.w & kSubpixelMask);
  vec3 low = candidates[instance].low.xyz, high = candidates[instance].high.xyz;
  vec2 units = float(1 << subpixel_bits) / spacing;
  motion_low = ivec2(floor(low.xy * units));
  motion_high = ivec2(ceil(high.xy * units));
  z_limit -= low.z;
  first_candidate = instance * kMaxCandidates;
  visitMesh(body, fromLattice(body, id));
  z_limit += low.z;
  workgroupBarrier();
  if (lane == 0) {
    bool fits = num_found <= kMaxCandidates;
    candidates[instance].list = uvec4(uint(id + 1), fits ? num_found : kNoCandidates, 0, 0);
    float share = candidates[instance].half_size.w;
    bool gives_up = !fits && share <= kLeastShare;
    candidates[instance].center.w = gives_up ? kStepsWithout : 0.0;
    if (gives_up || num_found < kMaxCandidates / 4) candidates[instance].half_size.w = min(2.0 * share, 1.0);
    if (!fits && !gives_up) candidates[instance].half_size.w = 0.5 * share;
    if (fits) atomicAdd(work[kNumLists].x, 1u);
    enlist(fits && step_record.candidates.x != 0 ? kListCandidates : kListWholeMesh, instance, REPEAT);
  }
  workgroupBarrier();
}

void main() {
  enterWindow(0);
  uint first = workgroupNumber() * REPEAT;
  uint end = min(first + REPEAT, work[kListFindCandidates].w);
  uint k = first;
  for (; k < end; ++k) findCandidates(work_instances[placeInList(kListFindCandidates, k)]);
  if (cut_short || k < end) problems[0] = 1;
}
