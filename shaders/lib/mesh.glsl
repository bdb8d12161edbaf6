// Stage 1 for meshes: culling of groups and clusters, and their triangles into the tile. Included by contact.comp, whose names it uses.

Affine fromLattice(Body body, int id) {
  vec4 lattice = objects[id].lattice;
  vec4 middle = vec4(lattice.xyz, 1);
  Affine X;
  X.row0 = vec4(body.to_samples.row0.xyz * lattice.w, dot(body.to_samples.row0, middle));
  X.row1 = vec4(body.to_samples.row1.xyz * lattice.w, dot(body.to_samples.row1, middle));
  X.row2 = vec4(body.to_samples.row2.xyz * lattice.w, dot(body.to_samples.row2, middle));
  return X;
}

const int kLatticeMiddle = 1 << (kLatticeBits - 1);

// Whether the box of a group or cluster reaches into the window and over any sample; `center` and `half_size` are its bounds in (u, v, z).
bool boxReaches(Affine from_lattice, uvec2 box_xy, uint box_z, out vec3 center, out vec3 half_size) {
  uvec3 box = uvec3(box_xy, box_z);
  vec3 low = vec3(box & 0xFFFFu), high = vec3(box >> 16);
  const float kUnit = float(1u << kBoxShift);
  boundsOfImage(from_lattice, (low + high) * (0.5 * kUnit) - float(kLatticeMiddle), (high - low) * (0.5 * kUnit), center, half_size);
  vec2 first = ceil(center.xy - half_size.xy - 1e-3), last = floor(center.xy + half_size.xy + 1e-3);
  return !outsideTile(center, half_size) && first.x <= last.x && first.y <= last.y;
}

vec3 unpackVertex(uint vertex) {
  uvec2 words = wordsOf(quads[vertex]);
  const uint kMask = (1u << kLatticeBits) - 1u;
  uvec3 q = uvec3(words.x & kMask, (words.x >> kLatticeBits) | ((words.y & 0x3FFu) << 11), (words.y >> 10) & kMask);
  return vec3(ivec3(q) - kLatticeMiddle);
}

void rasterNumbered(Affine from_lattice, uint quad, bool large) {
  vec3 p = apply(from_lattice, unpackVertex(4 * quad));
  vec3 q = apply(from_lattice, unpackVertex(4 * quad + 1));
  vec3 r = apply(from_lattice, unpackVertex(4 * quad + 2));
  vec3 s = apply(from_lattice, unpackVertex(4 * quad + 3));
  if (TRIANGLES == 1 || (TRIANGLES == 3 && !large)) rasterBySamples(p, q, r, s);
  if (TRIANGLES == 2 || (TRIANGLES == 3 && large)) {
    rasterBySpans(p, q, r);
    rasterBySpans(r, q, s);
  }
}

// Samples of the box, whole taxels of them, are without a surface.
void clearTile(Box box) {
  vec2 low = max(floor(box.low), tile_first) - tile_first;
  vec2 high = min(ceil(box.high), tile_end - 1.0) - tile_first;
  if (low.x > high.x || low.y > high.y) return;
  uvec2 first = uvec2(low) / SAMPLES * SAMPLES;
  uvec2 end = (uvec2(high) / SAMPLES + 1u) * SAMPLES;
  for (uint row = first.x + gl_LocalInvocationIndex; row < end.x; row += WORKGROUP) {
    for (uint address = row * tile_stride + first.y; address < row * tile_stride + end.y; ++address) tile[address] = kEmpty;
  }
}

// Triangles of a mesh into the tile: of each batch of groups those that reach into the window, of these the clusters that do, of these all quads.
// `active_part` grows by the bounds of these clusters; with `clear`, which needs the mesh to be one batch, the tile is cleared there first.
void rasterMesh(Body body, Affine from_lattice, inout Box active_part, bool clear) {
  uint lane = gl_LocalInvocationIndex;
  uint end_group = body.kind_groups.y + body.kind_groups.z;
  vec3 center, half_size;
  uint start = body.kind_groups.y;
  for (; start < end_group; start += GROUPS_PER_BATCH) {
    if (lane == 0) num_listed_groups = num_listed_clusters = 0;
    barrier();
    for (uint g = start + lane; g < min(start + GROUPS_PER_BATCH, end_group); g += WORKGROUP) {
      uvec2 box_xy = wordsOf(groups[2 * g]), box_z_items = wordsOf(groups[2 * g + 1]);
      if (boxReaches(from_lattice, box_xy, box_z_items.x, center, half_size)) group_list[atomicAdd(num_listed_groups, 1u)] = box_z_items.y;
    }
    barrier();
    for (uint g = 0; g < num_listed_groups; ++g) {
      uint group = group_list[g];
      uint first = group & ((1u << kFirstBits) - 1u);
      uint last = first + (group >> kFirstBits);
      for (uint c = first + lane; c <= last; c += WORKGROUP) {
        uvec2 box_xy = wordsOf(clusters[2 * c]), box_z_items = wordsOf(clusters[2 * c + 1]);
        if (boxReaches(from_lattice, box_xy, box_z_items.x, center, half_size)) {
          cluster_list[atomicAdd(num_listed_clusters, 1u)] = box_z_items.y;
          grow(active_part, center, half_size);
        }
      }
    }
    if (clear) {
      addToActive(active_part);
      barrier();
      clearTile(Box(vec2(active_box[0], active_box[2]), vec2(active_box[1], active_box[3])));
    }
    barrier();
    uint items = num_listed_clusters * kQuadsPerCluster;
    uint i = lane;
    for (; i < items; i += WORKGROUP) {
      uint cluster = cluster_list[i / kQuadsPerCluster];
      uint within = i % kQuadsPerCluster;
      if (within <= cluster >> kFirstBits) {
        rasterNumbered(from_lattice, (cluster & ((1u << kFirstBits) - 1u)) + within, body.kind_groups.w != 0);
      }
    }
    cut_short = cut_short || i < items;
    barrier();
  }
  cut_short = cut_short || start < end_group;
}
