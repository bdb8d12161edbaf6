// Stage 1: which objects reach into a tile, and the lowest surface over each of its samples (depth/tile_heights.glsl). Heights in m, in P.
//
// The includer defines kAllHeights: surfaces at or above Tile::z_limit count, too.
// Reference: src/reference/depth.cpp.

#include "depth/raster.glsl"
#include "depth/area/solid_cells.glsl"

// Lowers the heights of the tile to an analytic solid, sample by sample over its bounds.
void rasterAnalytic(Tile tile, Body body, vec4 parameters, uint slot, inout Found found) {
  vec2 low = max(floor(body.center.xy - body.half_size.xy), tile.first);
  vec2 end = min(ceil(body.center.xy + body.half_size.xy) + 1.0, tile.end);
  if (low.x >= end.x || low.y >= end.y) return;
  uvec2 first = uvec2(low);
  uvec2 count = uvec2(end) - first;
  uint i = gl_LocalInvocationIndex;
  for (; i < count.x * count.y; i += WORKGROUP) {
    uvec2 at = first + cellNumbered(i, count.y);
    float z = analyticHeight(body.kind_groups.x, parameters, body.X_PO, samplePosition(tile, at), tile.z_floor, found);
    uint address = (at.x - uint(tile.first.x)) * tile.stride + at.y - uint(tile.first.y);
    if (kAllHeights ? z < kNoHeight : isVisible(tile, z, found)) lowerHeight(tile, address, z, slot);
  }
  checkLoop(i < count.x * count.y);
}

// Lowest height of a half-space over the tile, which it has at one of the corners.
float lowestCorner(Tile tile, Body body) {
  float lowest = kNoHeight;
  Found found;
  for (uint corner = 0; corner < 4; ++corner) {
    vec2 at = vec2((corner & 1) == 0 ? tile.first.x : tile.end.x - 1.0, (corner & 2) == 0 ? tile.first.y : tile.end.y - 1.0);
    lowest = min(lowest, analyticHeight(kKindHalfSpace, vec4(0), body.X_PO, samplePosition(tile, at), tile.z_floor, found));
  }
  return lowest;
}

// The objects near a tile. `body` and `id` are those of the last slot, which is the only one without MANY_SLOTS.
struct Reach {
  Box samples;         // that their bounds may cover
  float lowest_bound;  // m, lower bound of their surfaces in P; kNoHeight without any
  Body body;
  int id;  // -1: the slot is empty
};

// Whether a face of the object's bounds has what the tile sees in front of it: surfaces over its samples between z_floor and z_limit. The
// bounds in P of an object that is turned against the tile, as against most taxels of a curved sensor, are much larger than the object.
// Only rejects bodies of which no sample sees anything. A load search looks below z_floor as well.
const bool kTestsFaces = NUM_ROWS == 0 && SEARCH == kNoSearch;
bool isInFrontOfFace(Tile tile, Body body, int id) {
  const float kMargin = 1e-6;  // m, more than the rounding of poses and of the lattice of a mesh
  ObjectRecord object = objectOf(id);
  vec2 spread = (kSampleReach + 1e-3) * tile.spacing;
  vec3 low = vec3(samplePosition(tile, tile.first) - spread, tile.z_floor),
       high = vec3(samplePosition(tile, tile.end - 1.0) + spread, tile.z_limit);
  Affine X = body.X_PO;
  mat3 R_OP = mat3(X.row0.xyz, X.row1.xyz, X.row2.xyz);  // by columns
  vec3 half_size = 0.5 * (high - low);
  vec3 offset = R_OP * (0.5 * (low + high) - vec3(X.row0.w, X.row1.w, X.row2.w)) - object.center.xyz;
  vec3 reach = abs(X.row0.xyz) * half_size.x + abs(X.row1.xyz) * half_size.y + abs(X.row2.xyz) * half_size.z +
               object.half_size.xyz * (1.0 + 1e-6) + kMargin;
  return any(greaterThan(abs(offset), reach));
}

const bool kBoundsRound = (OBJECT_KINDS & kRoundKinds) != 0 && !kAllHeights;
// Shrinks the bounds of a round solid along u and v to the part that is lower than z_limit.
void boundRound(Tile tile, vec4 parameters, inout Body body) {
  RoundPart part = roundPartBelow(tile.z_limit, body.kind_groups.x, parameters, body.X_PO);
  vec2 middle = (part.middle - tile.corner) / tile.spacing, half_size = halfSizeOf(part) / tile.spacing;
  vec2 first = max(middle - half_size, body.center.xy - body.half_size.xy),
       last = min(middle + half_size, body.center.xy + body.half_size.xy);
  body.center.xy = 0.5 * (first + last);
  body.half_size.xy = 0.5 * (last - first);
  body.near = body.near && part.exists && all(lessThanEqual(first, last)) && !outsideTile(tile, body.center, body.half_size);
}

Body nearBodyInSlot(Tile tile, uint slot_index, out int id) {
  id = objectInSlot(slot_index);
  Body body = bodyInSlot(tile, slot_index, max(id, 0));
  body.near = body.near && id >= 0;
  if (kBoundsRound && (kRoundKinds & (1u << body.kind_groups.x)) != 0) boundRound(tile, objectOf(max(id, 0)).parameters, body);
  if (kTestsFaces) body.near = body.near && !isInFrontOfFace(tile, body, max(id, 0));
  return body;
}

Reach objectsNear(Tile tile, uint instance, uint num_slots) {
  Reach reach;
  reach.samples = noSamples();
  reach.lowest_bound = kNoHeight;
  reach.id = -1;
  uint slot = 0;
  do {
    reach.body = nearBodyInSlot(tile, instance * num_slots + slot, reach.id);
    if (!reach.body.near) continue;
    grow(reach.samples, samplesUnder(tile, reach.body));
    float lowest = reach.body.center.z - reach.body.half_size.z;
    if (SEARCH == kSearchInTile && (OBJECT_KINDS & (1u << kKindHalfSpace)) != 0 && reach.body.kind_groups.x == kKindHalfSpace) {
      lowest = lowestCorner(tile, reach.body);
    }
    reach.lowest_bound = min(reach.lowest_bound, lowest);
  } while (MANY_SLOTS && ++slot < num_slots);
  return reach;
}

// Moves the objects to full depth, for a load search that runs later and needs to know which cells they cover.
void lowerObjects(inout Tile tile, uint instance, uint num_slots, inout Reach reach) {
  if (reach.lowest_bound >= kNoHeight) return;
  tile.offset_z = -THICKNESS - reach.lowest_bound;
  reach = objectsNear(tile, instance, num_slots);
}

// Gives the cells of a box to the object whose sums are complete. All invocations call it.
void takeCells(Tile tile, Box box, uint slot, inout Found found) {
  if (!isAny(box)) return;
  uint num_cols = uint(box.last.y - box.first.y + 1), count = uint(box.last.x - box.first.x + 1) * num_cols;
  uint i = gl_LocalInvocationIndex;
  do {
    if (i < count) {
      uvec2 at = uvec2(box.first) + cellNumbered(i, num_cols);
      uint address = at.x * tile.stride + at.y;
      CellSums sums = takeSums(tile, address);
      if (sums.volume != 0.0 || sums.covered != 0.0) giveCell(tile, address, slot, sums, found);
    }
    i += WORKGROUP;
  } while (i - gl_LocalInvocationIndex < count);
  workgroupBarrier();
}

// Lowers the heights of the tile to one object.
void rasterBody(Tile tile, uint instance, uint slot, Body body, int id, inout Found found) {
  bool is_mesh = body.kind_groups.x == kKindMesh;
  bool sums_cells = AREA && (!is_mesh || (body.kind_groups.w & kClosed) != 0);
  tile.deepest = max(body.half_size.z - body.center.z, kLeastDepth);
  if (LIST == kListCandidates) {
    visitCandidates(tile, instance, meshView(tile, body, id, slot), found);
  } else if (kHasMesh && (!kHasAnalytic || is_mesh)) {
    visitMesh(tile, body, meshView(tile, body, id, slot), found);
  }
  if (kHasAnalytic && (!kHasMesh || !is_mesh)) {
    if (isKind(body.kind_groups.x, kKindPolyhedron)) loadFaces(body.kind_groups.y, body.X_PO);
    vec4 parameters = objectOf(id).parameters;
    if (AREA) {
      Solid solid = Solid(body.kind_groups.x, parameters, body.X_PO);
      if (isKind(solid.kind, kKindHalfSpace)) {
        addHalfSpace(tile, solid, found);
      } else if (hasFacets(solid)) {
        addRound(tile, solid, found);
      } else {
        tile.deepest = min(tile.deepest, THICKNESS);
        addSolid(tile, solid, slot, found);
        sums_cells = false;
      }
    } else {
      rasterAnalytic(tile, body, parameters, slot, found);
      grow(found.samples, samplesUnder(tile, body));
    }
  }
  if (sums_cells) takeCells(tile, boxAround(found.samples), slot, found);
}

// Lowers the heights of the tile to all near objects; a pass that does not use the tile loads what analyticHeight() needs. Returns the
// samples that the surfaces may cover.
Box rasterHeights(Tile tile, uint instance, uint num_slots, inout Reach reach, inout Found found) {
  if (!usesTile()) {
    if (isKind(reach.body.kind_groups.x, kKindPolyhedron)) loadFaces(reach.body.kind_groups.y, reach.body.X_PO);
    return reach.samples;
  }
  uint k = 0;
  do {
    uint index = instance * num_slots + k;
    if (MANY_SLOTS) reach.body = nearBodyInSlot(tile, index, reach.id);
    if (reach.body.near) rasterBody(tile, instance, kKeepsSlots ? slotNumber(index) : 0u, reach.body, reach.id, found);
  } while (MANY_SLOTS && ++k < num_slots);
  return boxAround(found.samples);
}

// ---- heights without a tile ----

// The only object of a pass that does not use the tile: its heights are computed where they are needed.
struct OnlyObject {
  Body body;
  uint slot;  // object slot of body
  vec4 parameters;
};

OnlyObject onlyObject(Reach reach, uint slot_index, bool loads_parameters) {
  OnlyObject only = OnlyObject(reach.body, kKeepsSlots && !usesTile() ? slotNumber(slot_index) : 0u, vec4(0));
  if (!usesTile() || loads_parameters) only.parameters = objectOf(max(reach.id, 0)).parameters;
  return only;
}

// Height of a sample over Tile::z_base, m, with or without a tile: a batch may change between the two, and both give the same bits. `word`:
// the tile's word. With kOnlyPolyhedra and without a tile startRow() has been called.
float sampleHeight(Tile tile, OnlyObject only, uint address, vec2 position, inout Found found, out uint word) {
  word = 0;
  if (usesTile()) {
    word = tile_heights[address];
    return withoutSlot(word);
  }
  float z = kOnlyPolyhedra ? heightInRow(position.y, tile.z_floor, found)
                           : analyticHeight(only.body.kind_groups.x, only.parameters, only.body.X_PO, position, tile.z_floor, found);
  if ((NUM_ROWS == 0 || OUTPUT_JACOBIAN) && !isVisible(tile, z, found)) return kNoHeight;
  word = withSlot(max(z - tile.z_base, 0.0), only.slot);
  return withoutSlot(word);
}
