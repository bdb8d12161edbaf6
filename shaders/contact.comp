#version 460
#extension GL_GOOGLE_include_directive : require
// Contact pass: stages 1 (depth) and 2 (contact law) of one frame, and the load search over one tile.
//
// A workgroup owns one tile of taxels of one instance; workgroup number = instance num_tiles + tile. An invocation owns triangles, then taxels.
// In:  poses (num_instances x num_slots), objects, groups, clusters, triangles, the sensor's patches and tiles.
// Out: contact_normal (num_instances x num_taxels), N; contact_depth and contact_shear alike; tile_results (num_instances x num_tiles);
//      loads (num_instances): what the search found.
// Shared memory: 4 TILE_SAMPLES + 32 (LANES + 2) + 4 WORKGROUP + 256 bytes.
// Deterministic: the tile is a minimum; sums run over LANES partial sums in a fixed order, whatever the size of the workgroup.
// Twins: src/reference/depth.cpp, contact.cpp, load.cpp.

#include "shared/layout.h"

layout(local_size_x_id = 0) in;
layout(constant_id = 0) const uint WORKGROUP = 8;
layout(constant_id = 1) const uint SAMPLES = 4;         // per taxel and side
layout(constant_id = 2) const uint TILE_SAMPLES = 1344;  // most samples of a tile
layout(constant_id = 3) const uint LANES = 16;           // partial sums
layout(constant_id = 4) const uint HAS_STATE = 0;        // the law needs the depth of the step before
layout(constant_id = 5) const uint LOAD_SEARCH = 0;      // 0: in this pass, over its one tile; 1: by load.comp, over all tiles

layout(std430, set = 0, binding = 0) readonly buffer Poses { PoseRecord poses[]; };
layout(std430, set = 0, binding = 1) readonly buffer Instances { InstanceRecord instances[]; };
layout(std430, set = 0, binding = 2) readonly buffer Step { StepRecord step_record; };
layout(std430, set = 0, binding = 3) readonly buffer Objects { ObjectRecord objects[]; };
layout(std430, set = 0, binding = 4) readonly buffer Groups { BoundsRecord groups[]; };
layout(std430, set = 0, binding = 5) readonly buffer Clusters { BoundsRecord clusters[]; };
layout(std430, set = 0, binding = 6) readonly buffer Triangles { uint triangles[]; };
layout(std430, set = 0, binding = 7) readonly buffer SensorBlock { SensorRecord sensor; };
layout(std430, set = 0, binding = 8) readonly buffer Patches { PatchRecord patches[]; };
layout(std430, set = 0, binding = 9) readonly buffer Tiles { TileRecord tiles[]; };
layout(std430, set = 0, binding = 10) buffer State { float state[]; };
layout(std430, set = 0, binding = 11) writeonly buffer ContactNormal { float contact_normal[]; };
layout(std430, set = 0, binding = 12) writeonly buffer ContactDepth { float contact_depth[]; };
layout(std430, set = 0, binding = 13) writeonly buffer ContactShear { float contact_shear[]; };
layout(std430, set = 0, binding = 14) writeonly buffer TileResults { TileResult tile_results[]; };
layout(std430, set = 0, binding = 15) buffer Loads { LoadRecord loads[]; };

const uint kEmpty = 0x7F7FFFFFu;  // the largest finite float, as bits: no surface over the sample

shared uint tile[TILE_SAMPLES];
shared vec4 partial[LANES];
shared uint group_list[WORKGROUP];
shared uint cluster_list[kClustersPerGroup];
shared uint num_listed_groups;
shared uint num_listed_clusters;
shared int active_box[4];  // in samples: first row, last row, first col, last col
shared uint num_deep;
shared uint lowest_bits;

// The window of samples that this workgroup rasters, in samples of the patch, and how a height becomes the tile's number.
vec2 tile_first, tile_end;  // half-open
uint tile_stride;
float z_limit;  // m: surfaces at or above cannot touch
float z_base;   // m: what the tile's numbers count from

#include "lib/workgroup.glsl"
#include "lib/transform.glsl"
#include "lib/analytic.glsl"
#include "lib/raster.glsl"
#include "lib/laws/registry.glsl"

Affine X_PS;         // patch from sensor
vec4 spacing;        // sample spacing x, y; sample area
vec2 patch_corner;   // of sample (0, 0), in P, m

Affine poseInPatch(uint slot_index, float offset_z) {
  PoseRecord pose = poses[slot_index];
  Affine X_SO = Affine(pose.row0, pose.row1, pose.row2);
  X_SO.row2.w += offset_z;
  return compose(X_PS, X_SO);
}

// From P in metres to (u, v, z): samples, samples, metres.
Affine toSamples(Affine X_PO) {
  X_PO.row0.w -= patch_corner.x;
  X_PO.row1.w -= patch_corner.y;
  X_PO.row0 /= spacing.x;
  X_PO.row1 /= spacing.y;
  return X_PO;
}

bool outsideTile(vec3 center, vec3 half_size) {
  // A hair larger, so that rounding of the box never cuts off a triangle.
  vec3 reach = half_size + vec3(1e-3, 1e-3, 1e-8) + abs(half_size) * 1e-6;
  return center.z - reach.z >= z_limit || center.x + reach.x < tile_first.x || center.x - reach.x > tile_end.x - 1.0 ||
         center.y + reach.y < tile_first.y || center.y - reach.y > tile_end.y - 1.0;
}

struct Box {
  vec2 low, high;  // in samples, closed
};

// `margin` is for the rounding of boxes, in samples: that of an object must hold those of its clusters.
void grow(inout Box box, vec3 center, vec3 half_size, float margin) {
  box.low = min(box.low, center.xy - half_size.xy - margin);
  box.high = max(box.high, center.xy + half_size.xy + margin);
}

const float kClusterMargin = 1e-3;
const float kObjectMargin = 1e-2;

void addToActive(Box box) {
  vec2 low = max(floor(box.low), tile_first);
  vec2 high = min(ceil(box.high), tile_end - 1.0);
  if (low.x > high.x || low.y > high.y) return;
  atomicMin(active_box[0], int(low.x));
  atomicMax(active_box[1], int(high.x));
  atomicMin(active_box[2], int(low.y));
  atomicMax(active_box[3], int(high.y));
}

vec3 unpackVertex(uint word) {
  uint w0 = triangles[word], w1 = triangles[word + 1];
  const uint kMask = (1u << kLatticeBits) - 1u;
  const int kMiddle = 1 << (kLatticeBits - 1);
  uvec3 q = uvec3(w0 & kMask, (w0 >> kLatticeBits) | ((w1 & 0x3FFu) << 11), (w1 >> 10) & kMask);
  return vec3(ivec3(q) - kMiddle);
}

// All triangles of one mesh whose clusters reach into the window.
void rasterMesh(ObjectRecord object, Affine to_samples, inout Box box) {
  Affine from_lattice = to_samples;
  from_lattice.row0 = vec4(to_samples.row0.xyz * object.lattice.w, dot(to_samples.row0, vec4(object.lattice.xyz, 1)));
  from_lattice.row1 = vec4(to_samples.row1.xyz * object.lattice.w, dot(to_samples.row1, vec4(object.lattice.xyz, 1)));
  from_lattice.row2 = vec4(to_samples.row2.xyz * object.lattice.w, dot(to_samples.row2, vec4(object.lattice.xyz, 1)));

  uint lane = gl_LocalInvocationIndex;
  uint end_group = object.kind_groups.y + object.kind_groups.z;
  for (uint start = object.kind_groups.y; start < end_group; start += WORKGROUP) {
    if (lane == 0) num_listed_groups = 0;
    barrier();
    vec3 center, half_size;
    if (start + lane < end_group) {
      boundsOfImage(from_lattice, groups[start + lane].center.xyz, groups[start + lane].half_size.xyz, center, half_size);
      if (!outsideTile(center, half_size)) group_list[atomicAdd(num_listed_groups, 1u)] = start + lane;
    }
    barrier();
    uint group_count = num_listed_groups;
    for (uint g = 0; g < group_count; ++g) {
      uint group = group_list[g];
      uint first = floatBitsToUint(groups[group].center.w);
      uint count = floatBitsToUint(groups[group].half_size.w);
      if (lane == 0) num_listed_clusters = 0;
      barrier();
      for (uint c = lane; c < count; c += WORKGROUP) {
        boundsOfImage(from_lattice, clusters[first + c].center.xyz, clusters[first + c].half_size.xyz, center, half_size);
        if (!outsideTile(center, half_size)) {
          cluster_list[atomicAdd(num_listed_clusters, 1u)] = first + c;
          grow(box, center, half_size, kClusterMargin);
        }
      }
      barrier();
      uint items = num_listed_clusters * kTrianglesPerCluster;
      for (uint i = lane; i < items; i += WORKGROUP) {
        uint cluster = cluster_list[i / kTrianglesPerCluster];
        uint within = i % kTrianglesPerCluster;
        if (within < floatBitsToUint(clusters[cluster].half_size.w)) {
          uint word = (floatBitsToUint(clusters[cluster].center.w) + within) * kTriangleWords;
          rasterTriangle(apply(from_lattice, unpackVertex(word)), apply(from_lattice, unpackVertex(word + 2)),
                         apply(from_lattice, unpackVertex(word + 4)));
        }
      }
      barrier();
    }
  }
}

vec2 samplePosition(uvec2 sample_index) { return patch_corner + vec2(sample_index) * spacing.xy; }

// An analytic solid into the tile, sample by sample over its bounds.
void rasterAnalytic(ObjectRecord object, Affine X_PO, vec3 center, vec3 half_size) {
  vec2 low = max(floor(center.xy - half_size.xy), tile_first);
  vec2 end = min(ceil(center.xy + half_size.xy) + 1.0, tile_end);
  if (low.x >= end.x || low.y >= end.y) return;
  uvec2 first = uvec2(low);
  uvec2 count = uvec2(end) - first;
  for (uint i = gl_LocalInvocationIndex; i < count.x * count.y; i += WORKGROUP) {
    uvec2 at = first + uvec2(i / count.y, i % count.y);
    float z = analyticHeight(object.kind_groups.x, object.parameters, X_PO, samplePosition(at));
    if (z < z_limit) {
      uint address = (at.x - uint(tile_first.x)) * tile_stride + at.y - uint(tile_first.y);
      atomicMin(tile[address], floatBitsToUint(max(z - z_base, 0.0)));
    }
  }
}

// Total of partial[...] in a fixed order; every invocation gets it.
vec4 sumOfPartials() {
  barrier();
  vec4 total = vec4(0);
  for (uint v = 0; v < LANES; ++v) total += partial[v];
  barrier();
  return total;
}

struct Search {
  float depth;   // of the lowest sample, m
  float lowest;  // height of the lowest sample before the move, as the tile counts it: over z_base, m
  float offset;  // by which the objects move, m
  float status;  // kLoadCarried or kLoadOutOfReach
};

// Depth of the lowest sample at which the samples of the tile's window carry `load`: Newton's method from full depth down. Only z moves, so the gaps
// between the samples are those of the tile.
Search searchLoad(float load, uvec2 first, uvec2 count) {
  const int kMaxIterations = 32;
  const float kTolerance = 2e-6;  // of the load; some ten roundings of a float
  uint total = count.x * count.y;
  for (uint i = gl_LocalInvocationIndex; i < total; i += WORKGROUP) {
    uint address = (first.x + i / count.y) * tile_stride + first.y + i % count.y;
    if (tile[address] < kEmpty) atomicMin(lowest_bits, tile[address]);
  }
  barrier();
  Search found = Search(0.0, 0.0, 0.0, kLoadOutOfReach);
  uint lowest = lowest_bits;
  if (lowest == kEmpty) return found;
  float base = uintBitsToFloat(lowest);
  found.lowest = base;
  found.depth = sensor.skin.x;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    for (uint v = gl_LocalInvocationIndex; v < LANES; v += WORKGROUP) {
      float force = 0.0, slope = 0.0;
      for (uint i = v; i < total; i += LANES) {
        uint address = (first.x + i / count.y) * tile_stride + first.y + i % count.y;
        float d = found.depth - (uintBitsToFloat(tile[address]) - base);
        force += lawPressure(sensor.skin, d, 0.0);
        slope += lawSlope(sensor.skin, d);
      }
      partial[v] = vec4(force, slope, 0, 0) * spacing.z;
    }
    vec4 sums = sumOfPartials();
    float excess = sums.x - load;
    if (iteration == 0 && excess < -kTolerance * load) break;  // even full depth carries less
    found.status = kLoadCarried;
    if (abs(excess) <= kTolerance * load || sums.y <= 0.0) break;
    found.depth = clamp(found.depth - excess / sums.y, 0.0, sensor.skin.x);
  }
  if (load == 0.0) found.depth = 0.0;
  found.offset = -found.depth - (z_base + base);
  return found;
}

// Lowest height of a half-space over the tile, m: at one of its corners.
float lowestCorner(uint slot_index, float offset_z) {
  Affine X_PO = poseInPatch(slot_index, offset_z);
  float lowest = kMiss;
  for (uint corner = 0; corner < 4; ++corner) {
    vec2 at = vec2((corner & 1) == 0 ? tile_first.x : tile_end.x - 1.0, (corner & 2) == 0 ? tile_first.y : tile_end.y - 1.0);
    lowest = min(lowest, analyticHeight(kKindHalfSpace, vec4(0), X_PO, patch_corner + at * spacing.xy));
  }
  return lowest;
}

void main() {
  uint lane = gl_LocalInvocationIndex;
  uint number = workgroupNumber();
  uint num_tiles = sensor.counts.y;
  uint instance = number / num_tiles;
  if (instance >= step_record.batch.x) return;
  uint tile_number = number - instance * num_tiles;
  TileRecord this_tile = tiles[tile_number];
  uint patch_number = this_tile.place.x;
  PatchRecord patch_record = patches[patch_number];
  X_PS = Affine(patch_record.row0, patch_record.row1, patch_record.row2);
  spacing = patch_record.spacing;
  patch_corner = -0.5 * vec2(patch_record.grid.xy * SAMPLES - 1u) * spacing.xy;
  uvec2 tile_taxel = this_tile.place.yz;
  uvec2 tile_size = this_tile.size.xy;
  tile_first = vec2(tile_taxel * SAMPLES);
  tile_end = tile_first + vec2(tile_size * SAMPLES);
  tile_stride = tile_size.y * SAMPLES;
  uint num_taxels = sensor.counts.x;
  uint num_slots = step_record.batch.y;
  float thickness = sensor.skin.x;

  uint outputs = step_record.outputs.x;
  uint flags = instances[instance].keys.w;
  bool load_driven = (flags & kFlagLoadDriven) != 0;
  bool search_here = load_driven && LOAD_SEARCH == 0;
  float offset_z = 0.0;
  if (LOAD_SEARCH == 1) {
    LoadRecord load = loads[instance];
    // The results of the evaluation that ended the search stay as they are.
    if (load.bracket.w == kLoadCarried || load.bracket.w == kLoadOutOfReach) return;
    offset_z = load.bracket.x;
  }
  z_limit = search_here ? kMiss : 0.0;
  z_base = -thickness;

  if (lane == 0) {
    active_box[0] = active_box[2] = 0x7FFFFFFF;
    active_box[1] = active_box[3] = -1;
    num_deep = 0;
    lowest_bits = kEmpty;
  }

  // Bounds of all objects: what to clear, where to count heights from, and which way to take.
  Box cleared = Box(vec2(kMiss), vec2(-kMiss));
  uint num_near = 0, near_slot = 0, near_kind = 0;
  float lowest_bound = kMiss;
  for (uint slot = 0; slot < num_slots; ++slot) {
    int id = poses[instance * num_slots + slot].object.x;
    if (id < 0) continue;
    Affine to_samples = toSamples(poseInPatch(instance * num_slots + slot, offset_z));
    vec3 center, half_size;
    boundsOfImage(to_samples, objects[id].center.xyz, objects[id].half_size.xyz, center, half_size);
    if (outsideTile(center, half_size)) continue;
    ++num_near;
    near_slot = slot;
    near_kind = objects[id].kind_groups.x;
    grow(cleared, center, half_size, kObjectMargin);
    lowest_bound = min(lowest_bound, near_kind == kKindHalfSpace ? lowestCorner(instance * num_slots + slot, offset_z) : center.z - half_size.z);
  }
  if (search_here) z_base = clamp(lowest_bound, -1.0, 1.0);
  bool tiled = search_here || num_near > 1 || near_kind == kKindMesh;
  barrier();

  Affine only_X_PO;
  ObjectRecord only_object;
  if (num_near > 0 && !tiled) {
    // One analytic solid: its heights are computed where they are summed.
    only_object = objects[poses[instance * num_slots + near_slot].object.x];
    only_X_PO = poseInPatch(instance * num_slots + near_slot, offset_z);
    if (lane == 0) addToActive(cleared);
  }
  if (num_near > 0 && tiled) {
    uvec2 low = uvec2(max(floor(cleared.low), tile_first) - tile_first);
    uvec2 end = uvec2(min(ceil(cleared.high) + 1.0, tile_end) - tile_first);
    // Whole taxels: their samples are all read.
    low -= low % SAMPLES;
    end = (end + SAMPLES - 1) / SAMPLES * SAMPLES;
    uint width = end.y - low.y;
    for (uint i = lane; i < (end.x - low.x) * width; i += WORKGROUP) tile[(low.x + i / width) * tile_stride + low.y + i % width] = kEmpty;
    barrier();
    Box box = Box(vec2(kMiss), vec2(-kMiss));
    for (uint slot = 0; slot < num_slots; ++slot) {
      int id = poses[instance * num_slots + slot].object.x;
      if (id < 0) continue;
      ObjectRecord object = objects[id];
      Affine X_PO = poseInPatch(instance * num_slots + slot, offset_z);
      Affine to_samples = toSamples(X_PO);
      vec3 center, half_size;
      boundsOfImage(to_samples, object.center.xyz, object.half_size.xyz, center, half_size);
      if (outsideTile(center, half_size)) continue;
      if (object.kind_groups.x == kKindMesh) {
        rasterMesh(object, to_samples, box);
      } else {
        rasterAnalytic(object, X_PO, center, half_size);
        grow(box, center, half_size, kClusterMargin);
      }
    }
    addToActive(box);
  }
  barrier();

  // The rectangle of taxels that can carry force, in taxels of this tile, half-open.
  uvec2 active_first = uvec2(0), active_count = uvec2(0);
  if (active_box[1] >= active_box[0] && active_box[3] >= active_box[2]) {
    active_first = uvec2(active_box[0], active_box[2]) / SAMPLES - tile_taxel;
    active_count = uvec2(active_box[1], active_box[3]) / SAMPLES - tile_taxel + 1u - active_first;
  }
  uint num_active = active_count.x * active_count.y;

  Search found = Search(0.0, 0.0, 0.0, 0.0);
  if (search_here) {
    found = searchLoad(instances[instance].drive.x, active_first * SAMPLES, active_count * SAMPLES);
    if (lane == 0) loads[instance].bracket = vec4(found.offset, 0, 0, found.status);
  }

  // Stage 2, taxel by taxel; LANES partial sums of the wrench.
  uint first_taxel = patch_record.grid.z;
  uint patch_cols = patch_record.grid.y;
  float per_sample = 1.0 / float(SAMPLES * SAMPLES);
  bool first_step = (flags & kFlagFirstStep) != 0 || load_driven;
  uint deep = 0;
  for (uint v = lane; v < LANES; v += WORKGROUP) {
    vec4 wrench = vec4(0);  // normal force, torque about x and y of P
    for (uint k = v; k < num_active; k += LANES) {
      uvec2 in_tile = active_first + uvec2(k / active_count.y, k % active_count.y);
      uvec2 base = in_tile * SAMPLES;
      float force = 0.0, depth_sum = 0.0;
      vec2 moment = vec2(0);
      for (uint a = 0; a < SAMPLES; ++a) {
        for (uint b = 0; b < SAMPLES; ++b) {
          uvec2 at = base + uvec2(a, b);
          uint address = at.x * tile_stride + at.y;
          vec2 position = samplePosition(at + tile_taxel * SAMPLES);
          float d;
          if (tiled) {
            float height = uintBitsToFloat(tile[address]);
            d = search_here ? found.depth - (height - found.lowest) : thickness - height;
          } else {
            d = -analyticHeight(only_object.kind_groups.x, only_object.parameters, only_X_PO, position);
          }
          d = clamp(d, 0.0, thickness);
          float d_rate = 0.0;
          if (HAS_STATE != 0) {
            uint where = (instance * num_tiles + tile_number) * TILE_SAMPLES + address;
            if (!first_step) d_rate = (d - state[where]) * step_record.time.y;
            state[where] = d;
          }
          deep += d >= thickness ? 1u : 0u;
          float f = lawPressure(sensor.skin, d, d_rate) * spacing.z;
          force += f;
          moment += f * position;
          depth_sum += d;
        }
      }
      uvec2 in_patch = in_tile + tile_taxel;
      uint taxel = instance * num_taxels + first_taxel + in_patch.x * patch_cols + in_patch.y;
      contact_normal[taxel] = force;
      if ((outputs & kOutputDepth) != 0) contact_depth[taxel] = depth_sum * per_sample;
      if ((outputs & kOutputShear) != 0) {
        contact_shear[2 * taxel] = 0.0;
        contact_shear[2 * taxel + 1] = 0.0;
      }
      // The skin is pressed along -z: torque (x, y, 0) x (0, 0, -f).
      wrench += vec4(force, -moment.y, moment.x, 0);
    }
    partial[v] = wrench;
  }
  if (deep > 0) atomicAdd(num_deep, deep);

  // Taxels that nothing reaches.
  for (uint k = lane; k < tile_size.x * tile_size.y; k += WORKGROUP) {
    uvec2 in_tile = uvec2(k / tile_size.y, k % tile_size.y);
    if (all(greaterThanEqual(in_tile, active_first)) && all(lessThan(in_tile, active_first + active_count))) continue;
    uvec2 in_patch = in_tile + tile_taxel;
    uint taxel = instance * num_taxels + first_taxel + in_patch.x * patch_cols + in_patch.y;
    contact_normal[taxel] = 0.0;
    if ((outputs & kOutputDepth) != 0) contact_depth[taxel] = 0.0;
    if ((outputs & kOutputShear) != 0) {
      contact_shear[2 * taxel] = 0.0;
      contact_shear[2 * taxel + 1] = 0.0;
    }
    if (HAS_STATE != 0) {
      for (uint a = 0; a < SAMPLES * SAMPLES; ++a) {
        uvec2 at = in_tile * SAMPLES + uvec2(a / SAMPLES, a % SAMPLES);
        state[(instance * num_tiles + tile_number) * TILE_SAMPLES + at.x * tile_stride + at.y] = 0.0;
      }
    }
  }

  vec4 total = sumOfPartials();
  if (lane == 0) {
    uint result = instance * num_tiles + tile_number;
    tile_results[result].force = vec4(0, 0, -total.x, float(num_deep));
    tile_results[result].torque = vec4(total.y, total.z, 0, 0);
    uvec2 first = tile_taxel + active_first;
    tile_results[result].window = num_active == 0 ? uvec4(0) : uvec4(first.x, first.x + active_count.x, first.y, first.y + active_count.y);
  }
}
