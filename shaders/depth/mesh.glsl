// Culling of a mesh's groups and clusters of quads against a tile. The includer defines visitListedQuads(), which is called with all quads
// that may cover a sample below Tile::z_limit and some others, listedQuad(i) for i < count, and the struct Found, which it updates. All
// invocations call it.
// In: objects, groups, clusters, quads (shared/objects.h).
// Shared memory: 4 kClustersPerBatch + 4 GROUPS_PER_BATCH + 8 bytes.

void visitListedQuads(Tile tile, MeshView view, uint count, inout Found found);

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

// The box of a group; `items`: its clusters, packed as in shared/objects.h.
bool groupReaches(Tile tile, MeshView view, uint group, out uint items) {
  uvec4 words = fourOf(Groups, group);
  items = words.w;
  return boxReaches(tile, view, words.xyz);
}

// Number of the cluster at a place of the listed groups, of which each has kClustersPerGroup; false where the group has fewer clusters.
bool clusterAt(uint place, out uint cluster) {
  uint group = group_list[place / kClustersPerGroup], at = place % kClustersPerGroup;
  cluster = (group & kFirstMask) + at;
  return at <= group >> kFirstBits;
}

// Visits all quads of the clusters of the listed groups that reach into the tile. All invocations call it after a barrier; it ends with
// one.
void visitListedGroups(Tile tile, MeshView view, inout Found found) {
  const uint kRounds = 32;  // whose clusters are collected as bits, so that one atomicAdd makes room for all that an invocation finds
  uint lane = gl_LocalInvocationIndex, num_places = num_listed_groups * kClustersPerGroup;
  uint start = 0, cluster;
  if (num_places > 0) do {
      uint i = start, end = min(start + kRounds * WORKGROUP, num_places), reaching = 0, bit = 1;
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
    } while (start < num_places);
  checkLoop(start < num_places);
  workgroupBarrier();
  countIterations(num_listed_groups * kClustersPerGroup);
  visitListedQuads(tile, view, num_listed_clusters * kQuadsPerCluster, found);
  workgroupBarrier();
}

// Visits the mesh in batches of GROUPS_PER_BATCH groups.
void visitMesh(Tile tile, Body body, MeshView view, inout Found found) {
  uint lane = gl_LocalInvocationIndex, start = body.kind_groups.y, end_group = start + body.kind_groups.z;
  do {
    if (lane == 0) num_listed_groups = num_listed_clusters = 0;
    workgroupBarrier();
    uint g = start, end = min(start + GROUPS_PER_BATCH, end_group), items;
    do {
      if (g + lane < end && groupReaches(tile, view, g + lane, items)) group_list[atomicAdd(num_listed_groups, 1u)] = items;
      g += WORKGROUP;
    } while (g < end);
    workgroupBarrier();
    visitListedGroups(tile, view, found);
    start += GROUPS_PER_BATCH;
  } while (start < end_group);
  countIterations(body.kind_groups.z);
  checkLoop(start < end_group);
}
