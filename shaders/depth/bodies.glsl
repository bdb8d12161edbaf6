// The objects in the slots of an instance, seen from a tile, and the samples of the tile that their bounds cover. Lengths in m.
// In: poses, objects (shared/objects.h, batch.h).

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

// Number of the slot that a pose is of; the host leaves out slots whose object is far.
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
