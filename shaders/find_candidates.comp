#version 460
#extension GL_GOOGLE_include_directive : require
// Pass that finds candidates: the quads of a mesh that may cover a sample while the instance's object stays within the bounds that
// keep_candidates.comp has set.
//
// A workgroup owns REPEAT instances of a list in sequence; an invocation owns boxes, then quads.
// In:  poses, objects, groups, clusters, quads of triangles, the sensor's patch, a work list.
// Out: candidates (num_instances), candidate_quads (num_instances x kMaxCandidates), work lists.
// Shared memory: 4 kClustersPerBatch + 4 GROUPS_PER_BATCH + 12 bytes.
// Deterministic: the order of candidates varies, which does not affect heights.
// Mutable globals: any_unfinished_loop (driver/loops.glsl).

#include "passes/declare.glsl"
#include "passes/find_candidates.h"

const float kMinShare = 0.25;      // share of the planned steps; with a smaller one the instance gives up
const float kStepsWithout = 32.0;  // steps until an instance that has given up tries again

shared uint num_found;

#include "common/work_lists.glsl"
#include "driver/loops.glsl"
#include "depth/mesh.glsl"

// Lists the quad if a sample may see it after any motion within the bounds.
void visitQuad(Tile tile, MeshView view, uint quad, uint first_candidate) {
  Vertex p, q, r, s;
  fetchQuad(view, quad, p, q, r, s);
  const ivec2 kRounding = ivec2(2);  // rounding of vertices to units, with a margin
  Box reached = Box(firstReaching(view, min(min(p.at, q.at), min(r.at, s.at)) + view.motion_low - kRounding),
                    lastReaching(tile, view, max(max(p.at, q.at), max(r.at, s.at)) + view.motion_high + kRounding));
  if (min(min(p.z, q.z), min(r.z, s.z)) >= tile.z_limit || !isAny(reached)) return;
  uint at = atomicAdd(num_found, 1u);
  if (at < kMaxCandidates) candidate_quads[first_candidate + at] = quad;
}

// Lists the quads of a mesh, in batches of GROUPS_PER_BATCH groups.
void visitMesh(Tile tile, Body body, MeshView view, uint first_candidate) {
  uint start = body.kind_groups.y, end_group = start + body.kind_groups.z;
  do {
    uint count = listQuads(tile, view, start, end_group), i = gl_LocalInvocationIndex;
    for (; i < count; i += WORKGROUP) visitQuad(tile, view, listedQuad(i), first_candidate);
    checkLoop(i < count);
    workgroupBarrier();
    start += GROUPS_PER_BATCH;
  } while (start < end_group);
  checkLoop(start < end_group);
}

void findCandidates(Tile tile, uint instance) {
  uint lane = gl_LocalInvocationIndex;
  if (lane == 0) num_found = 0;
  workgroupBarrier();
  int id = objectInSlot(instance);
  Body body = bodyInSlot(tile, instance, id);
  MeshView view = meshView(tile, body, id, 0);
  vec3 low = candidates[instance].low.xyz, high = candidates[instance].high.xyz;
  vec2 units = float(1 << view.subpixel_bits) / tile.spacing;
  view.motion_low = ivec2(floor(low.xy * units));
  view.motion_high = ivec2(ceil(high.xy * units));
  tile.z_limit -= low.z;
  visitMesh(tile, body, view, instance * kMaxCandidates);
  workgroupBarrier();
  if (lane == 0) {
    bool fits = num_found <= kMaxCandidates;
    candidates[instance].list = uvec4(uint(id + 1), fits ? num_found : kNoCandidates, 0, 0);
    float share = candidates[instance].half_size.w;
    bool gives_up = !fits && share <= kMinShare;
    candidates[instance].center.w = gives_up ? kStepsWithout : 0.0;
    if (gives_up || num_found < kMaxCandidates / 4) candidates[instance].half_size.w = min(2.0 * share, 1.0);
    if (!fits && !gives_up) candidates[instance].half_size.w = 0.5 * share;
    if (fits) atomicAdd(work[kNumLists].x, 1u);
    appendToList(fits && step_record.candidates.x != 0 ? kListCandidates : kListWholeMesh, instance, LISTED_PER_WORKGROUP);
  }
  workgroupBarrier();
}

void main() {
  Tile tile = loadTile(0);
  uint first = workgroupNumber() * REPEAT;
  uint end = min(first + REPEAT, work[kListFindCandidates].w);
  uint k = first;
  for (; k < end; ++k) findCandidates(tile, work_instances[listIndex(kListFindCandidates, k)]);
  checkLoop(k < end);
  reportUnfinishedLoops();
}
