// A tile of a patch: a rectangle of whole taxels and their samples, in the patch's frame P; and the objects in the slots of an instance,
// seen from a tile, with the samples of the tile that their bounds cover. Lengths in m.
//
// The includer defines OUTPUT_JACOBIAN and REACH where they are no constants of the pass.
// In:  patches, tiles (shared/model.h), poses, objects.
#ifndef DEPTH_TILE_GLSL
#define DEPTH_TILE_GLSL
#include "driver/arithmetic.glsl"
#include "common/transform.glsl"

struct Tile {
  Affine X_PS;        // patch from sensor
  vec2 spacing;       // spacing of samples
  float sample_area;  // m^2
  float force_area;   // m^2: sample_area times the instance's factor on the skin's stiffness
  vec2 corner;        // position of sample (0, 0) of the patch, in P
  uvec4 grid;         // grid of the patch, PatchRecord
  uvec2 first_taxel;  // row and column in the patch
  uvec2 size;         // in taxels
  uint stride;        // samples of a row
  vec2 first, end;    // in samples of the patch, half-open
  float z_limit;      // surfaces at or above cannot touch
  float z_floor;      // surfaces below are the far side of the body and are ignored
  float z_base;       // reference of the heights of the tile
  float level;        // height of the undeformed skin: the part of a load search's offset that is below a float's resolution of the poses
  float deepest;      // bound of the depth of the object whose cells are summed, m; depth/area/cell_sums.glsl
  float offset_z;     // offset of the objects along z of S that a load search over several tiles tries
};

// Samples of the tile: first and last row and column, inclusive; empty where a last is before its first.
struct Box {
  ivec2 first, last;
};

bool isAny(Box box) { return box.first.x <= box.last.x && box.first.y <= box.last.y; }
uint areaOf(Box box) { return isAny(box) ? uint(box.last.x - box.first.x + 1) * uint(box.last.y - box.first.y + 1) : 0u; }
Box noSamples() { return Box(ivec2(0x7FFFFFFF), ivec2(-1)); }

void grow(inout Box box, Box other) {
  box.first = min(box.first, other.first);
  box.last = max(box.last, other.last);
}

vec2 samplePosition(Tile tile, vec2 sample_index) { return tile.corner + sample_index * tile.spacing; }

// Up to which height over the skin surfaces count for the slope of depth, m.
float cellReach(Tile tile) { return SAMPLES > 1 ? max(tile.spacing.x, tile.spacing.y) : 0.0; }

// `number`: index of the tile in the sensor.
Tile loadTile(uint number) {
  Tile tile;
  uvec4 origin = uvec4(0), size = uvec4(NUM_ROWS, NUM_COLS, 0, 0);
  if (NUM_TILES > 1 || NUM_ROWS == 0) {
    origin = tiles[number].origin;
    size = tiles[number].size;
  }
  tile.grid = uvec4(NUM_ROWS, NUM_COLS, 0, 0);
  tile.spacing = vec2(PITCH_X, PITCH_Y) / float(SAMPLES);
  tile.z_floor = 0.0;
  if (NUM_ROWS == 0) {
    tile.grid = patchRecord(origin.x).grid;
    tile.spacing = patchRecord(origin.x).spacing.xy;
    tile.z_floor = -patchRecord(origin.x).spacing.w;
  }
  tile.sample_area = tile.spacing.x * tile.spacing.y;
  tile.force_area = tile.sample_area;
  tile.X_PS = Affine(vec4(1, 0, 0, 0), vec4(0, 1, 0, 0), vec4(0, 0, 1, 0));
  if (!FLAT) tile.X_PS = Affine(patchRecord(origin.x).row0, patchRecord(origin.x).row1, patchRecord(origin.x).row2);
  tile.corner = -0.5 * vec2(tile.grid.xy * SAMPLES - 1u) * tile.spacing;
  tile.first_taxel = origin.yz;
  tile.size = size.xy;
  tile.first = vec2(tile.first_taxel * SAMPLES);
  tile.end = tile.first + vec2(tile.size * SAMPLES);
  tile.stride = tile.size.y * SAMPLES;
  tile.offset_z = 0.0;
  tile.z_limit = OUTPUT_JACOBIAN ? cellReach(tile) : REACH;
  tile.z_base = 0.0;
  tile.level = 0.0;
  tile.deepest = 0.0;
  return tile;
}

// How far a sample reaches, in samples: with area sampling to the border of its cell.
const float kSampleReach = AREA ? 0.5 : 0.0;

struct Body {
  uvec4 kind_groups;  // ObjectRecord
  Affine X_PO;
  Affine to_samples;       // from O to (u, v, z): samples, samples, m
  vec3 center, half_size;  // bounds, in (u, v, z)
  bool near;               // reaches into the tile
};

bool outsideTile(Tile tile, vec3 center, vec3 half_size) {
  // Slightly larger, so that rounding of the box never cuts off a triangle.
  vec3 reach = half_size + vec3(vec2(kSampleReach + 1e-3), 1e-8) + half_size * 1e-6;
  return center.z - reach.z >= tile.z_limit || center.x + reach.x < tile.first.x || center.x - reach.x > tile.end.x - 1.0 ||
         center.y + reach.y < tile.first.y || center.y - reach.y > tile.end.y - 1.0;
}

// Compilers drop the rows that are not used.
PoseRecord poseOf(uint slot_index) {
  uint row = 4 * slot_index;
  return PoseRecord(floatsOfFour(Poses, row), floatsOfFour(Poses, row + 1), floatsOfFour(Poses, row + 2), floatsOfFour(Poses, row + 3));
}

ObjectRecord objectOf(int id) {
  uint row = 5 * uint(id);
  return ObjectRecord(fourOf(Objects, row), floatsOfFour(Objects, row + 1), floatsOfFour(Objects, row + 2), floatsOfFour(Objects, row + 3),
                      floatsOfFour(Objects, row + 4));
}

int objectInSlot(uint slot_index) { return wholeNumber(poseOf(slot_index).object.x); }

// Number of the slot of a pose; the host leaves out slots whose object is far.
uint slotNumber(uint slot_index) { return uint(wholeNumber(poseOf(slot_index).object.y)); }

Body bodyInSlot(Tile tile, uint slot_index, int id) {
  PoseRecord pose = poseOf(slot_index);
  ObjectRecord object = objectOf(id);
  Body body;
  body.kind_groups = object.kind_groups;
  body.X_PO = Affine(pose.row0, pose.row1, pose.row2);
  body.X_PO.row2.w += tile.offset_z;
  if (!FLAT) body.X_PO = compose(tile.X_PS, body.X_PO);
  body.to_samples = body.X_PO;
  body.to_samples.row0.w -= tile.corner.x;
  body.to_samples.row1.w -= tile.corner.y;
  body.to_samples.row0 /= tile.spacing.x;
  body.to_samples.row1 /= tile.spacing.y;
  boundsOfImage(body.to_samples, object.center.xyz, object.half_size.xyz, body.center, body.half_size);
  body.near = !outsideTile(tile, body.center, body.half_size);
  return body;
}

// Samples of the tile that a body's bounds may cover, with a margin of one sample, since the boxes of its clusters are slightly larger.
Box samplesUnder(Tile tile, Body body) {
  vec2 low = floor(body.center.xy - body.half_size.xy - 1e-3), high = ceil(body.center.xy + body.half_size.xy + 1e-3);
  return Box(wholeNumbers(clamp(low, tile.first, tile.end) - tile.first),
             wholeNumbers(clamp(high, tile.first - 1.0, tile.end - 1.0) - tile.first));
}
#endif
