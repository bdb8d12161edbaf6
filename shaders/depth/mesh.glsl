// A mesh seen from the window: culling of its groups and clusters. What is done with quads of triangles that are left is the including pass's own:

void visitQuad(Affine from_lattice, uint quad, bool large);

// How far boxes and quads may yet move along u and v, in units.
ivec2 motion_low = ivec2(0), motion_high = ivec2(0);

const uint kClustersPerBatch = GROUPS_PER_BATCH * kClustersPerGroup;
shared uint group_list[GROUPS_PER_BATCH];      // first cluster | (how many - 1) << kFirstBits
shared uint cluster_list[kClustersPerBatch];
shared uint num_listed_groups;
shared uint num_listed_clusters;

// To (u, v, z) as shaders/depth/subpixels.glsl has them.
Affine fromLattice(Body body, int id) {
  vec4 lattice = objectOf(id).lattice;
  vec4 middle = vec4(lattice.xyz, 1);
  float units = float(1 << subpixel_bits);
  Affine X;
  X.row0 = vec4(body.to_samples.row0.xyz * lattice.w, dot(body.to_samples.row0, middle) - tile_first.x) * units;
  X.row1 = vec4(body.to_samples.row1.xyz * lattice.w, dot(body.to_samples.row1, middle) - tile_first.y) * units;
  X.row2 = vec4(body.to_samples.row2.xyz * lattice.w, dot(body.to_samples.row2, middle));
  return X;
}

const int kLatticeMiddle = 1 << (kLatticeBits - 1);
const uint kFirstMask = (1u << kFirstBits) - 1u;

// Whether the box of a group or cluster is low enough and over any sample.
bool boxReaches(Affine from_lattice, uvec3 box) {
  vec3 low = vec3(box & 0xFFFFu), high = vec3(box >> 16), center, half_size;
  const float kUnit = float(1u << kBoxShift);
  boundsOfImage(from_lattice, (low + high) * (0.5 * kUnit) - float(kLatticeMiddle), (high - low) * (0.5 * kUnit), center, half_size);
  // A hair larger: what is rounded differently than the vertices never cuts off a triangle.
  int hair = 2 + ((1 << subpixel_bits) >> 10);
  Box reached = Box(firstSample(wholeNumbers(center.xy - half_size.xy) - hair + motion_low),
                    lastSample(wholeNumbers(center.xy + half_size.xy) + hair + motion_high));
  return center.z - half_size.z * (1.0 + 1e-6) - 1e-8 < z_limit && isAny(reached);
}

vec3 unpackVertex(uvec2 words) {
  const uint kMask = (1u << kLatticeBits) - 1u;
  uvec3 q = uvec3(words.x & kMask, (words.x >> kLatticeBits) | ((words.y & 0x3FFu) << 11), (words.y >> 10) & kMask);
  return vec3(ivec3(q) - kLatticeMiddle);
}

Vertex vertexOf(Affine from_lattice, uvec2 words) {
  vec3 image = apply(from_lattice, unpackVertex(words));
  return Vertex(wholeNumbers(image.xy), image.z);
}

void fetchQuad(Affine from_lattice, uint quad, out Vertex p, out Vertex q, out Vertex r, out Vertex s) {
  uvec4 pq = fourOf(Quads, 2 * quad), rs = fourOf(Quads, 2 * quad + 1);
  p = vertexOf(from_lattice, pq.xy);
  q = vertexOf(from_lattice, pq.zw);
  r = vertexOf(from_lattice, rs.xy);
  s = vertexOf(from_lattice, rs.zw);
}

// The box of a group; `items`: its clusters, packed as in shared/objects.h.
bool groupReaches(Affine from_lattice, uint group, out uint items) {
  uvec4 words = fourOf(Groups, group);
  items = words.w;
  return boxReaches(from_lattice, words.xyz);
}

// Of the listed groups those clusters that reach into the window, of these all quads. Before and after, all invocations have met.
void visitListedGroups(Body body, Affine from_lattice) {
  uint lane = gl_LocalInvocationIndex;
  for (uint g = 0; g < num_listed_groups; ++g) {
    uint group = group_list[g];
    uint first = (group & kFirstMask) + lane, end = (group & kFirstMask) + (group >> kFirstBits) + 1u;
    // As bits first: the list is asked for room once for all that this invocation finds.
    uint reaching = 0;
    for (uint c = first, bit = 1u; c < end; c += WORKGROUP, bit <<= 1) {
      if (boxReaches(from_lattice, fourOf(Clusters, c).xyz)) reaching |= bit;
    }
    if (reaching == 0) continue;
    uint at = atomicAdd(num_listed_clusters, uint(bitCount(reaching)));
    for (; reaching != 0; reaching &= reaching - 1u) cluster_list[at++] = first + uint(findLSB(reaching)) * WORKGROUP;
  }
  workgroupBarrier();
  uint items = num_listed_clusters * kQuadsPerCluster;
  uint i = lane;
  for (; i < items; i += WORKGROUP) {
    uint quad = cluster_list[i / kQuadsPerCluster] * kQuadsPerCluster + i % kQuadsPerCluster;
    visitQuad(from_lattice, quad, (body.kind_groups.w & kLargeTriangles) != 0);
  }
  cut_short = cut_short || i < items;
  workgroupBarrier();
}

// Visits all quads that may lie over a sample of the window below z_limit, and others: a batch of groups at a time.
void visitMesh(Body body, Affine from_lattice) {
  uint end_group = body.kind_groups.y + body.kind_groups.z;
  uint items;
  uint start = body.kind_groups.y;
  for (; start < end_group; start += GROUPS_PER_BATCH) {
    if (gl_LocalInvocationIndex == 0) num_listed_groups = num_listed_clusters = 0;
    workgroupBarrier();
    for (uint g = start + gl_LocalInvocationIndex; g < min(start + GROUPS_PER_BATCH, end_group); g += WORKGROUP) {
      if (groupReaches(from_lattice, g, items)) group_list[atomicAdd(num_listed_groups, 1u)] = items;
    }
    workgroupBarrier();
    visitListedGroups(body, from_lattice);
  }
  cut_short = cut_short || start < end_group;
}
