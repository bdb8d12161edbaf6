// Stage 1 of the contact pass: which objects reach into the window of a tile, and their heights into the tile. Included by contact.comp.
//
// In:  the window that enterTile() has entered (depth/window.glsl), poses and objects of the instance (depth/bodies.glsl).
// Out: Reach; of a pass that uses the tile the lowest surface over each sample (depth/depth_tile.glsl). Twin: src/reference/depth.cpp.

vec2 samplePosition(vec2 sample_index) { return patch_corner + sample_index * spacing; }

// An analytic solid into the tile, sample by sample over its bounds.
void rasterAnalytic(Body body, vec4 parameters) {
  vec2 low = max(floor(body.center.xy - body.half_size.xy), tile_first);
  vec2 end = min(ceil(body.center.xy + body.half_size.xy) + 1.0, tile_end);
  if (low.x >= end.x || low.y >= end.y) return;
  uvec2 first = uvec2(low);
  uvec2 count = uvec2(end) - first;
  uint i = gl_LocalInvocationIndex;
  for (; i < count.x * count.y; i += WORKGROUP) {
    uvec2 at = first + cellNumbered(i, count.y);
    float z = analyticHeight(body.kind_groups.x, parameters, body.X_PO, samplePosition(at));
    if (isSeen(z)) lowerTile((at.x - uint(tile_first.x)) * tile_stride + at.y - uint(tile_first.y), z);
  }
  cut_short = cut_short || i < count.x * count.y;
}

// Lowest height of a half-space over the tile, m: at one of its corners.
float lowestCorner(Body body) {
  float lowest = kMiss;
  for (uint corner = 0; corner < 4; ++corner) {
    vec2 at = vec2((corner & 1) == 0 ? tile_first.x : tile_end.x - 1.0, (corner & 2) == 0 ? tile_first.y : tile_end.y - 1.0);
    lowest = min(lowest, analyticHeight(kKindHalfSpace, vec4(0), body.X_PO, patch_corner + at * spacing));
  }
  return lowest;
}

// The objects near a tile. With one slot, `body` and `id` are that slot's; else those of the last slot.
struct Reach {
  Box samples;         // that their bounds cover
  float lowest_bound;  // m, lower bound of their surfaces in P; kMiss without any
  Body body;
  int id;              // -1: the slot is empty
};

Body nearBodyInSlot(uint slot_index, out int id) {
  id = objectInSlot(slot_index);
  Body body = bodyInSlot(slot_index, max(id, 0));
  body.near = body.near && id >= 0;
  return body;
}

Reach objectsNear(uint instance, uint num_slots) {
  Reach reach;
  reach.samples = noSamples();
  reach.lowest_bound = kMiss;
  reach.id = -1;
  for (uint slot = 0; slot < num_slots; ++slot) {
    reach.body = nearBodyInSlot(instance * num_slots + slot, reach.id);
    if (!reach.body.near) continue;
    grow(reach.samples, samplesUnder(reach.body));
    float lowest = reach.body.center.z - reach.body.half_size.z;
    if (SEARCH == kSearchInTile && (KINDS & (1u << kKindHalfSpace)) != 0 && reach.body.kind_groups.x == kKindHalfSpace) {
      lowest = lowestCorner(reach.body);
    }
    reach.lowest_bound = min(reach.lowest_bound, lowest);
  }
  return reach;
}

// One object into the tile.
void rasterBody(uint instance, uint slot, Body body, int id) {
  raster_slot = slot;
  bool is_mesh = body.kind_groups.x == kKindMesh;
  subpixel_bits = int(body.kind_groups.w & kSubpixelMask);
  if (LIST == kListCandidates) {
    visitCandidates(instance, body, fromLattice(body, id));
  } else if (kHasMesh && (!kHasAnalytic || is_mesh)) {
    visitMesh(body, fromLattice(body, id));
  }
  if (kHasAnalytic && (!kHasMesh || !is_mesh)) {
    if (isKind(body.kind_groups.x, kKindPolyhedron)) loadFaces(body.kind_groups.y, body.X_PO);
    rasterAnalytic(body, objectOf(id).parameters);
    grow(seen, samplesUnder(body));
  }
}

// Heights of all near objects into the tile, or what heightOfSolid() needs. Returns the samples where triangles are seen and solids reach.
Box rasterHeights(uint instance, uint num_slots, inout Reach reach) {
  if (!usesTile()) {
    if (isKind(reach.body.kind_groups.x, kKindPolyhedron)) loadFaces(reach.body.kind_groups.y, reach.body.X_PO);
    return reach.samples;
  }
  seen = noSamples();
  for (uint slot = 0; slot < num_slots; ++slot) {
    if (MANY_SLOTS) reach.body = nearBodyInSlot(instance * num_slots + slot, reach.id);
    if (reach.body.near) rasterBody(instance, slot, reach.body, reach.id);
  }
  return boxAround(seen);
}
