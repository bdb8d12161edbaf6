// Vertices of a mesh seen from a tile, and culling of a mesh's groups and clusters of quads against a tile.
//
// Vertices are at (u, v) in units of 2^-subpixel_bits of the samples' spacing, from the tile's first sample; z in m, in P. Sample (a, b) is
// at (a, b) << subpixel_bits.
// In:  objects, groups, clusters, quads (shared/model.h).
// Out: listedQuad(i) for i < listQuads().
// Shared memory: 4 kClustersPerBatch + 4 GROUPS_PER_BATCH + 8 bytes.

#include "driver/loops.glsl"
#include "driver/workgroup.glsl"
#include "depth/tile.glsl"

struct Vertex {
  ivec2 at;
  float z;
};

// How the mesh in one slot is seen from a tile.
struct MeshView {
  Affine from_lattice;  // from the mesh's lattice to (u, v, z)
  int subpixel_bits;    // ObjectRecord
  bool large;           // the mesh has large triangles, ObjectRecord
  bool closed;          // and is closed; with AREA
  uint slot;
  ivec2 motion_low, motion_high;  // by how much the mesh may still move along u and v, in units; 0 in the contact pass
};

// First and last sample of the tile between `low` and `high`, in units; none where one is greater.
ivec2 firstSample(MeshView view, ivec2 low) { return max((low + ((1 << view.subpixel_bits) - 1)) >> view.subpixel_bits, 0); }
ivec2 lastSample(Tile tile, MeshView view, ivec2 high) { return min(high >> view.subpixel_bits, ivec2(tile.size * SAMPLES) - 1); }

// First and last sample whose reach (kSampleReach, depth/tile.glsl) is between `low` and `high`.
int reachOf(MeshView view) { return AREA ? 1 << view.subpixel_bits >> 1 : 0; }
ivec2 firstReaching(MeshView view, ivec2 low) { return firstSample(view, low - reachOf(view)); }
ivec2 lastReaching(Tile tile, MeshView view, ivec2 high) { return lastSample(tile, view, high + reachOf(view)); }

const uint kClustersPerBatch = GROUPS_PER_BATCH * kClustersPerGroup;
shared uint group_list[GROUPS_PER_BATCH];  // first cluster | (how many - 1) << kFirstBits
shared uint cluster_list[kClustersPerBatch];
shared uint num_listed_groups;
shared uint num_listed_clusters;

uint listedQuad(uint i) { return cluster_list[i / kQuadsPerCluster] * kQuadsPerCluster + i % kQuadsPerCluster; }

// `slot`: the body's; `id`: of its object.
MeshView meshView(Tile tile, Body body, int id, uint slot) {
  MeshView view;
  view.subpixel_bits = int(body.kind_groups.w & kSubpixelMask);
  view.large = (body.kind_groups.w & kLargeTriangles) != 0;
  view.closed = AREA && (body.kind_groups.w & kClosed) != 0;
  view.slot = slot;
  view.motion_low = view.motion_high = ivec2(0);
  vec4 lattice = objectOf(id).lattice;
  vec4 middle = vec4(lattice.xyz, 1);
  float units = float(1 << view.subpixel_bits);
  view.from_lattice.row0 = vec4(body.to_samples.row0.xyz * lattice.w, dot(body.to_samples.row0, middle) - tile.first.x) * units;
  view.from_lattice.row1 = vec4(body.to_samples.row1.xyz * lattice.w, dot(body.to_samples.row1, middle) - tile.first.y) * units;
  view.from_lattice.row2 = vec4(body.to_samples.row2.xyz * lattice.w, dot(body.to_samples.row2, middle));
  return view;
}

const int kLatticeMiddle = 1 << (kLatticeBits - 1);
const uint kFirstMask = (1u << kFirstBits) - 1u;

// Whether the box of a group or cluster is low enough and over any sample.
bool boxReaches(Tile tile, MeshView view, uvec3 box) {
  vec3 low = vec3(box & 0xFFFFu), high = vec3(box >> 16), center, half_size;
  const float kUnit = float(1u << kBoxShift);
  boundsOfImage(view.from_lattice, (low + high) * (0.5 * kUnit) - float(kLatticeMiddle), (high - low) * (0.5 * kUnit), center, half_size);
  // Slightly larger: rounding that differs from that of the vertices never cuts off a triangle.
  int margin = 2 + ((1 << view.subpixel_bits) >> 10);
  Box reached = Box(firstReaching(view, wholeNumbers(center.xy - half_size.xy) - margin + view.motion_low),
                    lastReaching(tile, view, wholeNumbers(center.xy + half_size.xy) + margin + view.motion_high));
  return center.z - half_size.z * (1.0 + 1e-6) - 1e-8 < tile.z_limit && isAny(reached);
}

vec3 unpackVertex(uvec2 words) {
  const uint kMask = (1u << kLatticeBits) - 1u;
  uvec3 q = uvec3(words.x & kMask, (words.x >> kLatticeBits) | ((words.y & 0x3FFu) << 11), (words.y >> 10) & kMask);
  return vec3(ivec3(q) - kLatticeMiddle);
}

Vertex vertexOf(MeshView view, uvec2 words) {
  vec3 image = apply(view.from_lattice, unpackVertex(words));
  return Vertex(wholeNumbers(image.xy), image.z);
}

void fetchQuad(MeshView view, uint quad, out Vertex p, out Vertex q, out Vertex r, out Vertex s) {
  uvec4 pq = fourOf(Quads, 2 * quad), rs = fourOf(Quads, 2 * quad + 1);
  p = vertexOf(view, pq.xy);
  q = vertexOf(view, pq.zw);
  r = vertexOf(view, rs.xy);
  s = vertexOf(view, rs.zw);
}

// Number of the cluster at an index of the listed groups, which have kClustersPerGroup each; false where the group has fewer clusters.
bool clusterAt(uint index, out uint cluster) {
  uint group = group_list[index / kClustersPerGroup], at = index % kClustersPerGroup;
  cluster = (group & kFirstMask) + at;
  return at <= group >> kFirstBits;
}

// Lists all clusters of the listed groups that reach into the tile. All invocations call it after a barrier; it ends with one.
void listClusters(Tile tile, MeshView view) {
  const uint kRounds = 32;  // whose clusters are collected as bits, so that one atomicAdd makes room for all that an invocation finds
  uint lane = gl_LocalInvocationIndex, num_clusters = num_listed_groups * kClustersPerGroup;
  uint start = 0, cluster;
  if (num_clusters > 0) do {
      uint i = start, end = min(start + kRounds * WORKGROUP, num_clusters), reaching = 0, bit = 1;
      do {
        if (i + lane < end && clusterAt(i + lane, cluster) && boxReaches(tile, view, fourOf(Clusters, cluster).xyz)) reaching |= bit;
        bit <<= 1;
        i += WORKGROUP;
      } while (i < end);
      uint at = atomicAdd(num_listed_clusters, uint(bitCount(reaching)));
      for (; reaching != 0; reaching &= reaching - 1u) {
        clusterAt(start + lane + uint(findLSB(reaching)) * WORKGROUP, cluster);
        cluster_list[at++] = cluster;
      }
      start += kRounds * WORKGROUP;
    } while (start < num_clusters);
  checkLoop(start < num_clusters);
  workgroupBarrier();
  countIterations(num_listed_groups * kClustersPerGroup);
}

// Lists the quads of up to GROUPS_PER_BATCH groups, from `start` on, that may cover a sample below Tile::z_limit, and some others. Returns
// their number. All invocations call it; the next call follows a barrier.
uint listQuads(Tile tile, MeshView view, uint start, uint end_group) {
  uint lane = gl_LocalInvocationIndex;
  if (lane == 0) num_listed_groups = num_listed_clusters = 0;
  workgroupBarrier();
  uint g = start, end = min(start + GROUPS_PER_BATCH, end_group);
  do {
    if (g + lane < end) {
      uvec4 words = fourOf(Groups, g + lane);
      if (boxReaches(tile, view, words.xyz)) group_list[atomicAdd(num_listed_groups, 1u)] = words.w;
    }
    g += WORKGROUP;
  } while (g < end);
  workgroupBarrier();
  listClusters(tile, view);
  return num_listed_clusters * kQuadsPerCluster;
}
