#version 460
#extension GL_GOOGLE_include_directive : require
// Contact pass: stages 1 (depth) and 2 (contact law) of one frame, and the load search over one tile.
//
// A workgroup owns REPEAT tiles, one after another, of several patches those that objects are near; tile number = instance NUM_TILES + tile of the
// sensor. An invocation owns boxes, then quads of triangles, then taxels.
// In:  poses (num_instances x num_slots), objects, groups, clusters, quads of triangles, faces, the sensor's patches and tiles.
// Out: contact_normal (num_instances x num_taxels), N, over the part of the spread's kernel that stays on the sensor; of a sensor of one tile only
//      inside the window of its result; contact_shear (num_instances x num_taxels x 2), N, the same;
//      contact_depth (num_instances x num_taxels), m; tile_results (num_instances x num_tiles); loads (num_instances): what the search found;
//      contact_cells (num_instances x num_taxels), tile_changes (num_instances x num_tiles x LANES), skin/cell_fluxes.glsl.
//      Of a law that is solved apart, instead of forces and depths, the height of the lowest surface (m, in P) over each of its nodes, which take the
//      taxels' place, with the slot in its lowest bits where depth/slots.glsl keeps it; kMiss where there is none.
// State: of every sample, between steps: its depth where the law needs it, its strain and overstresses where the skin relaxes; where there is
//        friction its shear traction, or how far its bristles are bent.
// Shared memory: 4 TILE_SAMPLES + 16 LANES + 4 kClustersPerBatch + 4 GROUPS_PER_BATCH + 4 REPEAT + 64 bytes, with friction 8 LANES and 512 more,
//      in lockstep 16 FACES more.
// Deterministic: the tile is a minimum; sums run over LANES partial sums in a fixed order, whatever the size of the workgroup.
// Twins: src/reference/depth.cpp, contact.cpp, relaxation.cpp, friction.cpp, lugre.cpp, load.cpp.

#include "driver/pairs.glsl"
#include "driver/barrier.glsl"
#include "driver/texels.glsl"
#include "shared/layout.h"
#include "common/specialization.glsl"
layout(constant_id = 11) const uint TILE_SAMPLES = 1344;  // most samples of a tile
layout(constant_id = 12) const bool FLAT = true;          // the one patch's frame is the sensor's
layout(constant_id = 13) const bool HAS_STATE = false;    // the law needs the depth of the step before
layout(constant_id = 14) const uint SEARCH = 0;          // load search: kNoSearch, kSearchInTile, kSearchOverTiles
layout(constant_id = 15) const float THICKNESS = 0.002;  // m
layout(constant_id = 16) const bool SCALED = true;       // sources near a border give more to the taxels that are there, readout/spread.glsl
layout(constant_id = 17) const bool MANY_SLOTS = false;  // an instance may touch several objects
layout(constant_id = 18) const uint KINDS = 1;           // bit per kind of object in the model
layout(constant_id = 19) const uint TRIANGLES = 3;       // bit 0: meshes of small triangles, bit 1: of large ones
layout(constant_id = 20) const bool OUTPUT_DEPTH = false;  // contact_depth is wanted
layout(constant_id = 21) const uint FACES = 1;           // of each polyhedron, some perhaps listed twice
layout(constant_id = 22) const float LAW_0 = 1.73e8;     // parameters of the contact law, skin/laws/
layout(constant_id = 23) const float LAW_1 = 1.0;
layout(constant_id = 24) const float LAW_2 = 0.0;
layout(constant_id = 25) const bool FRICTION = false;     // shear with memory, skin/friction.glsl
layout(constant_id = 26) const float TANGENTIAL_STIFFNESS = 1e8;  // N/m^3
layout(constant_id = 27) const float FRICTION_COEFFICIENT = 1.0;
layout(constant_id = 28) const bool OUTPUT_SHEAR = false;  // contact_shear is wanted
layout(constant_id = 29) const bool BRISTLES = false;     // that shear is of the law lugre, skin/laws/lugre.glsl; its parameters
layout(constant_id = 30) const float BRISTLE_STIFFNESS = 1e5;  // 1/m
layout(constant_id = 31) const float BRISTLE_DAMPING = 316.0;  // s/m
layout(constant_id = 32) const float VISCOUS_FRICTION = 0.4;   // s/m
layout(constant_id = 33) const float STATIC_FRICTION = 1.5;
layout(constant_id = 34) const float COULOMB_FRICTION = 1.0;
layout(constant_id = 35) const float STRIBECK_VELOCITY = 1e-3;  // m/s
layout(constant_id = 36) const uint RELAXATION = 0;  // terms of the skin's relaxation, skin/relaxation.glsl
layout(constant_id = 37) const uint GROUPS_PER_BATCH = 32;  // groups are culled a batch at a time, so that the list of clusters has room for all of theirs
layout(constant_id = 38) const bool OUTPUT_JACOBIAN = false;  // contact_cells and tile_changes are wanted, skin/cell_fluxes.glsl

layout(constant_id = 39) const bool LEAVE_UNTOUCHED = true;  // where nothing is near, kLeavesUntouched and kManySmallTiles

layout(constant_id = 40) const float REACH = 0.0;       // up to which height over the skin surfaces matter to the law, m
layout(constant_id = 41) const uint LIST = kNumLists;    // of instances that this pass goes through: kListWithout, kListWith; all
layout(constant_id = 42) const bool IS_LAST = true;      // to write contact_normal and tile_results; of some laws, passes over taxels do

// A software driver computes both sides of every branch and a loop's body at least once, so what a model, sensor or batch does not need is left
// out by constants.
const uint kNoSearch = 0u;         // no instance is driven by load
const uint kSearchInTile = 1u;     // in this pass, over its one tile
const uint kSearchOverTiles = 2u;  // by load.comp, over all tiles
const uint kSearchEnded = 3u;      // the frame of a sensor with friction or relaxation at the offsets that this search has found
const bool kHasMesh = (KINDS & 1u) != 0;
const bool kHasAnalytic = (KINDS & ~1u) != 0;
const bool kOnlyPolyhedra = KINDS == (1u << kKindPolyhedron);
// Heights go through the tile, but for a single analytic solid, whose heights are computed where they are summed; not a torus's, which take long, nor where
// a sample's neighbours are asked for.
bool usesTile() { return OUTPUT_JACOBIAN || kHasMesh || MANY_SLOTS || SEARCH == kSearchInTile || (KINDS & (1u << kKindTorus)) != 0; }

FOURS(0, Poses);
layout(std430, set = 0, binding = 1) readonly buffer Instances { InstanceRecord instances[]; };
layout(std430, set = 0, binding = 2) readonly buffer Step { StepRecord step_record; };
FOURS(3, Objects);
FOURS(4, Groups);
FOURS(5, Clusters);
FOURS(6, Quads);
layout(std430, set = 0, binding = 7) readonly buffer Patches { PatchRecord patches[]; };
layout(std430, set = 0, binding = 8) readonly buffer Tiles { TileRecord tiles[]; };
layout(std430, set = 0, binding = 9) readonly buffer SpreadScale { float spread_scale[]; };
layout(std430, set = 0, binding = 10) buffer State { float state[]; };
layout(std430, set = 0, binding = 11) writeonly buffer ContactNormal { float contact_normal[]; };
layout(std430, set = 0, binding = 12) writeonly buffer ContactDepth { float contact_depth[]; };
layout(std430, set = 0, binding = 13) buffer TileResults { TileResult tile_results[]; };
layout(std430, set = 0, binding = 14) buffer Loads { LoadRecord loads[]; };
layout(std430, set = 0, binding = 15) writeonly buffer Problems { uint problems[]; };
FOURS(16, Faces);
layout(std430, set = 0, binding = 17) readonly buffer Motions { MotionRecord motions[]; };
layout(std430, set = 0, binding = 18) buffer FrictionState { Pair friction_state[]; };
layout(std430, set = 0, binding = 19) writeonly buffer ContactShear { float contact_shear[]; };
layout(std430, set = 0, binding = 20) writeonly buffer ContactCells { CellRecord contact_cells[]; };
layout(std430, set = 0, binding = 21) writeonly buffer TileChanges { float tile_changes[]; };
layout(std430, set = 0, binding = 22) readonly buffer Candidates { CandidateRecord candidates[]; };
layout(std430, set = 0, binding = 23) readonly buffer CandidateQuads { uint candidate_quads[]; };
layout(std430, set = 0, binding = 24) buffer Work { uvec4 work[]; };
layout(std430, set = 0, binding = 25) buffer WorkInstances { uint work_instances[]; };

const float kMiss = kNoHeight;  // height where there is no surface
// Cosine to z of S. Under a patch that looks up more than this, a surface too deep to be seen means that a load search has gone through the body; a
// steeper one may see the slope of an object that is still above.
const float kLooksUp = 0.7;
shared vec4 partial[LANES];
shared uint num_deep;
shared uint any_behind;
shared uint tile_list[REPEAT];
shared uint num_listed_tiles;
shared uint lowest_bits;

#include "common/whole.glsl"
#include "common/transform.glsl"
#include "depth/window.glsl"

float z_base;   // m: what the tile's numbers count from
uint raster_slot = 0;  // of the body on its way into the tile

// This invocation has met a surface below z_floor.
bool met_behind = false;

bool isSeen(float z) {
  if (NUM_ROWS > 0) return z < z_limit;
  met_behind = met_behind || z < z_floor;
  return z < z_limit && z >= z_floor;
}

// A loop ended before its work was done. Mesa's software driver ends all loops of an invocation after 65,535 turns together, without a word.
bool cut_short = false;

#include "common/workgroup.glsl"
#include "depth/slots.glsl"
#include "depth/depth_tile.glsl"
#include "depth/polyhedron.glsl"
#include "depth/analytic.glsl"
#include "skin/laws/registry.glsl"

const bool kShears = FRICTION && !kLawSolvedApart;  // else the pass that solves has the shear, and needs the slots

#include "depth/bodies.glsl"
#include "depth/subpixels.glsl"
#include "depth/mesh.glsl"
#include "depth/raster.glsl"

void writeShear(uint taxel, vec2 shear) {
  contact_shear[2 * taxel] = shear.x;
  contact_shear[2 * taxel + 1] = shear.y;
}

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

// Total of partial[] in a fixed order; every invocation gets it.
vec4 sumOfPartials() {
  workgroupBarrier();
  vec4 total = vec4(0);
  for (uint v = 0; v < LANES; ++v) total += partial[v];
  workgroupBarrier();
  return total;
}

#include "skin/relaxation.glsl"
#include "skin/load_search.glsl"
#include "skin/friction.glsl"
#include "skin/laws/lugre.glsl"

float per_dt;  // 1 / the step's time, 1/s, for laws that ask

vec2 tractionAfter(inout vec2 held, vec2 u, float share, float pressure) {
  if (BRISTLES) return pressure * bristleShear(held, u, share, per_dt);
  return held = springTraction(held, u, share, pressure);
}

#include "skin/cell_fluxes.glsl"
#include "depth/tiles.glsl"
#include "depth/touched.glsl"
#include "common/work_lists.glsl"

void contactOnTile(uint instance, uint tile_number, uint num_slots) {
  uint lane = gl_LocalInvocationIndex;
  if (!enterTile(instance, tile_number)) return;
  uint flags = instances[instance].keys.w;
  bool load_driven = SEARCH != kNoSearch && (flags & kFlagLoadDriven) != 0;
  bool search_here = SEARCH == kSearchInTile && load_driven;  // of a law that is solved apart, the search is, too
  z_base = -THICKNESS;
  met_behind = false;

  if (lane == 0) {
    startBoxes();
    num_deep = 0;
    if (NUM_ROWS == 0) any_behind = 0;
    lowest_bits = kEmpty;
  }

  // Stage 1. First which objects reach into the window, and how low.
  Box reached = noSamples();
  float lowest_bound = kMiss;
  Body body;
  int id = -1;
  for (uint slot = 0; slot < num_slots; ++slot) {
    id = objectInSlot(instance * num_slots + slot);
    body = bodyInSlot(instance * num_slots + slot, max(id, 0));
    body.near = body.near && id >= 0;
    if (!body.near) continue;
    grow(reached, samplesUnder(body));
    float lowest = body.center.z - body.half_size.z;
    if (SEARCH == kSearchInTile && (KINDS & (1u << kKindHalfSpace)) != 0 && body.kind_groups.x == kKindHalfSpace) lowest = lowestCorner(body);
    lowest_bound = min(lowest_bound, lowest);
  }
  if (kLeavesUntouched && !isAny(reached)) {
    leaveUntouched(instance, tile_number, lane, WORKGROUP);
    return;
  }
  if (search_here) z_base = clamp(lowest_bound, -1.0, 1.0);
  workgroupBarrier();

  // Then their heights. The active part of the window is where triangles are seen and solids reach.
  Box active_part = reached;
  if (usesTile()) {
    seen = noSamples();
    for (uint slot = 0; slot < num_slots; ++slot) {
      if (MANY_SLOTS) {  // a single slot's body is at hand
        id = objectInSlot(instance * num_slots + slot);
        body = bodyInSlot(instance * num_slots + slot, max(id, 0));
        body.near = body.near && id >= 0;
      }
      if (!body.near) continue;
      raster_slot = slot;
      bool is_mesh = body.kind_groups.x == kKindMesh;
      subpixel_bits = int(body.kind_groups.w & kSubpixelMask);
      if (LIST == kListWith) {
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
    active_part = boxAround(seen);
  } else {
    if (isKind(body.kind_groups.x, kKindPolyhedron)) loadFaces(body.kind_groups.y, body.X_PO);
  }

  // The rectangle of taxels that can carry force, in taxels of this tile, half-open.
  uvec2 active_first = uvec2(0), active_count = uvec2(0);
  if (isAny(active_part)) {
    active_first = uvec2(active_part.first) / SAMPLES;
    active_count = uvec2(active_part.last) / SAMPLES + 1u - active_first;
  }
  uint num_active = active_count.x * active_count.y;

  bool is_first = (flags & kFlagFirstStep) != 0;
  if (RELAXATION > 0) loadRelaxation(instance * NUM_TILES + tile_number, is_first);
  Search found = Search(0.0, 0.0, 0.0, kLoadOutOfReach);
  if (!kLawSolvedApart && SEARCH == kSearchInTile && search_here) {
    if (num_active > 0) found = searchLoad(instances[instance].drive.x, active_first * SAMPLES, active_count * SAMPLES);
    if (lane == 0) loads[instance].bracket = vec4(found.offset, 0, 0, found.status);
  }

  uint tile_state = (instance * NUM_TILES + tile_number) * (kFrictionHeader + TILE_SAMPLES);
  uvec4 kept = uvec4(0);
  if (kShears) {
    kept = keptWindow(tile_state);
    loadMotions(instance, num_slots, search_here ? found.offset : offset_z);
  }

  // Stage 2, taxel by taxel; LANES partial sums of the wrench.
  vec4 parameters = vec4(0);
  if (!usesTile()) parameters = objectOf(max(id, 0)).parameters;
  uint first_taxel = instance * NUM_TAXELS + grid.z;
  const float kPerSample = 1.0 / float(SAMPLES * SAMPLES);
  bool at_rest = is_first || load_driven;
  per_dt = HAS_STATE || BRISTLES ? step_record.time.y : 0.0;
  uint deep = 0;
  float surface = search_here ? found.depth + found.lowest : THICKNESS;  // depth where the tile's height is 0
  for (uint v = lane; v < LANES; v += WORKGROUP) {
    vec4 wrench = vec4(0);  // normal force, torque about x, y and z of P
    vec2 lane_shear = vec2(0);
    vec3 change[6] = vec3[6](vec3(0), vec3(0), vec3(0), vec3(0), vec3(0), vec3(0));
    uint touched = kPassesOver ? touchedTaxels(v, active_first, active_count, first_taxel) : 0;
    uint k = kPassesOver ? nextTouched(touched, v) : v;
    while (k < num_active) {
      uvec2 in_tile = active_first + cellNumbered(k, active_count.y);
      uvec2 base = in_tile * SAMPLES;
      uvec2 in_patch = in_tile + tile_taxel;
      float depth_sum = 0.0;
      // Added as written: a driver may take out a common factor, in one variant of this pass and not in another.
      precise float force = 0.0;
      precise vec2 moment = vec2(0), shear = vec2(0);
      precise vec3 shear_moment = vec3(0);
      bool is_reached = RELAXATION > 0 && isReached(in_tile);
      bool is_kept = kShears && isKept(in_patch, kept);
      Cell cell = noCell();
      bvec4 rim = bvec4(equal(in_patch, uvec2(0)), equal(in_patch + 1u, grid.xy)).xzyw;
      vec2 first_sample = vec2(base + tile_taxel * SAMPLES);
      for (uint a = 0; a < SAMPLES; ++a) {
        float x = samplePosition(first_sample + vec2(a, 0)).x;
        if (!usesTile() && kOnlyPolyhedra) startRow(x);
        for (uint b = 0; b < SAMPLES; ++b) {
          uint address = (base.x + a) * tile_stride + base.y + b;
          vec2 position = vec2(x, samplePosition(first_sample + vec2(0, b)).y);
          // Over z_base, with or without a tile: a batch may change between the two, and no bit may show it.
          float height;
          uint word = 0;
          if (usesTile()) {
            word = tile[address];
            height = withoutSlot(word);
          } else {
            float z = kOnlyPolyhedra ? heightInRow(position.y) : analyticHeight(body.kind_groups.x, parameters, body.X_PO, position);
            height = NUM_ROWS > 0 || isSeen(z) ? max(z - z_base, 0.0) : kMiss;
          }
          if (kLawSolvedApart) {
            force = height >= kMiss ? kMiss : uintBitsToFloat(withSlot(z_base + height, slotOf(word)));
            continue;
          }
          float d = clamp(search_here ? found.depth - (height - found.lowest) : THICKNESS - height, 0.0, THICKNESS);
          float d_rate = 0.0;
          if (HAS_STATE) {
            uint where = (instance * NUM_TILES + tile_number) * TILE_SAMPLES + address;
            if (!at_rest) d_rate = (d - state[where]) * per_dt;
            state[where] = d;
          }
          deep += d >= THICKNESS ? 1u : 0u;
          float f = lawPressure(d, d_rate);
          if (RELAXATION > 0) {
            SkinState skin = skinAt(address, is_reached);
            if (kAdvances) keepSkin(address, skin, f);
            f = relaxedPressure(skin, f);
          }
          force += f;
          moment += f * position;
          depth_sum += d;
          if (OUTPUT_JACOBIAN) {
            float signed_d = surface - height;
            vec2 steps = vec2(stepOfDepth(signed_d, a, address, tile_stride, surface), stepOfDepth(signed_d, b, address, 1, surface));
            addToCell(cell, change, uvec2(a, b), rim, position, signed_d, length(steps), f);
          }
          if (kShears) {
            vec2 q = shearTraction(tile_state + kFrictionHeader + address, is_kept, d > 0.0, slotOf(word), vec3(position, -d), f);
            shear += q;
            shear_moment += cross(vec3(position, -d), vec3(q, 0));
          }
        }
      }
      if (!kLawSolvedApart) force *= sample_area;
      moment *= sample_area;
      uint in_sensor = grid.z + in_patch.x * grid.y + in_patch.y;
      uint taxel = instance * NUM_TAXELS + in_sensor;
      contact_normal[taxel] = SCALED ? force * spread_scale[in_sensor] : force;
      if (OUTPUT_DEPTH) contact_depth[taxel] = depth_sum * kPerSample;
      if (OUTPUT_JACOBIAN) keepCell(taxel, cell);
      // The skin is pressed along -z: torque (x, y, 0) x (0, 0, -f).
      wrench += vec4(force, -moment.y, moment.x, 0);
      if (kShears) {
        shear *= sample_area;
        if (OUTPUT_SHEAR) writeShear(taxel, SCALED ? shear * spread_scale[in_sensor] : shear);
        wrench.yzw += shear_moment * sample_area;
        lane_shear += shear;
      }
      k = kPassesOver ? nextTouched(touched, v) : k + LANES;
    }
    cut_short = cut_short || k < num_active;
    partial[v] = wrench;
    if (kShears) partial_shear[v] = lane_shear;
    if (OUTPUT_JACOBIAN) keepChange((instance * NUM_TILES + tile_number) * LANES + v, change);
  }
  if (deep > 0) atomicAdd(num_deep, deep);
  if (NUM_ROWS == 0 && met_behind && X_PS.row2.z > kLooksUp) atomicOr(any_behind, 1u);

  // Taxels that nothing reaches. Of a sensor of one tile nobody reads their force, but for a spread by lists.
  if (OUTPUT_JACOBIAN || NUM_TILES > 1 || NUM_ROWS == 0 || OUTPUT_DEPTH || HAS_STATE) {
    for (uint k = lane; k < tile_size.x * tile_size.y; k += WORKGROUP) {
      uvec2 in_tile = cellNumbered(k, tile_size.y);
      if (all(greaterThanEqual(in_tile, active_first)) && all(lessThan(in_tile, active_first + active_count))) continue;
      uvec2 in_patch = in_tile + tile_taxel;
      uint taxel = first_taxel + in_patch.x * grid.y + in_patch.y;
      contact_normal[taxel] = kLawSolvedApart ? kMiss : 0.0;
      if (OUTPUT_SHEAR) writeShear(taxel, vec2(0));
      if (OUTPUT_DEPTH) contact_depth[taxel] = 0.0;
      if (OUTPUT_JACOBIAN) leaveCell(taxel);
      if (HAS_STATE) {
        for (uint a = 0; a < SAMPLES * SAMPLES; ++a) {
          uvec2 at = in_tile * SAMPLES + uvec2(a / SAMPLES, a % SAMPLES);
          state[(instance * NUM_TILES + tile_number) * TILE_SAMPLES + at.x * tile_stride + at.y] = 0.0;
        }
      }
    }
  }

  vec4 total = sumOfPartials();
  if (usesTile() && REPEAT > 1) clearSamples(active_part);
  if (RELAXATION > 0 && kAdvances) keepRestOfSkin(active_first, active_count);
  vec3 force = -total.x * X_PS.row2.xyz;  // rows of R_PS are the axes of P in S
  vec3 torque = total.y * X_PS.row0.xyz + total.z * X_PS.row1.xyz;
  if (kShears) {
    vec2 shear = vec2(0);
    for (uint v = 0; v < LANES; ++v) shear += partial_shear[v];
    force += shear.x * X_PS.row0.xyz + shear.y * X_PS.row1.xyz;
    torque += total.w * X_PS.row2.xyz;
  }
  if (!FLAT) {
    vec3 origin = -(X_PS.row0.xyz * X_PS.row0.w + X_PS.row1.xyz * X_PS.row1.w + X_PS.row2.xyz * X_PS.row2.w);  // of P in S
    torque += cross(origin, force);
  }
  uvec2 first = tile_taxel + active_first;
  uvec4 window = num_active == 0 ? uvec4(0) : uvec4(first.x, first.x + active_count.x, first.y, first.y + active_count.y);
  if (kShears && lane == 0) keepWindow(tile_state, window);
  if (NUM_ROWS == 0) window = uvec4(any_behind, 0, 0, 0);
  // A word a lane.
  uint result = instance * NUM_TILES + tile_number;
  vec4 force_row = vec4(force, float(num_deep));
  vec4 torque_row = vec4(torque, total.x);
  for (uint k = lane; k < 4; k += WORKGROUP) {
    tile_results[result].force[k] = force_row[k];
    tile_results[result].torque[k] = torque_row[k];
    tile_results[result].window[k] = window[k];
  }
}

void main() {
  uvec4 batch = step_record.batch;
  uint first = workgroupNumber() * REPEAT;
  uint end = min(first + REPEAT, LIST < kNumLists ? work[LIST].w : batch.x * NUM_TILES);
  uint count = max(first, end) - first;  // of two dimensions of workgroups some are left over
  if (findsNear()) {
    if (gl_LocalInvocationIndex == 0) num_listed_tiles = 0;
    workgroupBarrier();
    for (uint number = first + gl_LocalInvocationIndex; number < end; number += WORKGROUP) {
      uint instance = number / NUM_TILES, tile_number = number - instance * NUM_TILES;
      if (!enterTile(instance, tile_number)) continue;
      if (anyObjectNear(instance, batch.y)) {
        tile_list[atomicAdd(num_listed_tiles, 1u)] = number;
      } else {
        leaveUntouched(instance, tile_number, 0, 1);
      }
    }
    workgroupBarrier();
    count = num_listed_tiles;
  }
  if (usesTile() && count > 0) {
    clearTile();
    workgroupBarrier();
  }
  uint k = 0;
  for (; k < count; ++k) {
    uint number = findsNear() ? tile_list[k] : first + k;
    if (LIST < kNumLists) number = work_instances[placeInList(LIST, number)];  // of sensors of one tile
    uint instance = number / NUM_TILES;
    contactOnTile(instance, number - instance * NUM_TILES, batch.y);
    workgroupBarrier();
  }
  if (cut_short || k < count) problems[0] = 1;
}
