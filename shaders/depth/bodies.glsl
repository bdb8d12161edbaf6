// What the slots of an instance hold, seen from a tile, and the part of the tile that bodies cover. Included by contact.comp, whose names it uses.

// What one slot holds, for this workgroup.
struct Body {
  uvec4 kind_groups;  // ObjectRecord
  Affine X_PO;
  Affine to_samples;          // from O to (u, v, z): samples, samples, m
  vec3 center, half_size;     // bounds, in (u, v, z)
  bool near;                  // reaches into the window
};

bool outsideTile(vec3 center, vec3 half_size) {
  // A hair larger, so that rounding of the box never cuts off a triangle.
  vec3 reach = half_size + vec3(1e-3, 1e-3, 1e-8) + half_size * 1e-6;
  return center.z - reach.z >= z_limit || center.x + reach.x < tile_first.x || center.x - reach.x > tile_end.x - 1.0 ||
         center.y + reach.y < tile_first.y || center.y - reach.y > tile_end.y - 1.0;
}

// Rows that nobody asks for are not fetched.
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

Body bodyInSlot(uint slot_index, int id) {
  PoseRecord pose = poseOf(slot_index);
  ObjectRecord object = objectOf(id);
  Body body;
  body.kind_groups = object.kind_groups;
  body.X_PO = Affine(pose.row0, pose.row1, pose.row2);
  body.X_PO.row2.w += offset_z;
  if (!FLAT) body.X_PO = compose(X_PS, body.X_PO);
  body.to_samples = body.X_PO;
  body.to_samples.row0.w -= patch_corner.x;
  body.to_samples.row1.w -= patch_corner.y;
  body.to_samples.row0 /= spacing.x;
  body.to_samples.row1 /= spacing.y;
  boundsOfImage(body.to_samples, object.center.xyz, object.half_size.xyz, body.center, body.half_size);
  body.near = !outsideTile(body.center, body.half_size);
  return body;
}

// Samples of the tile that a body's bounds may cover, and those next to them: boxes of its clusters are a little larger.
Box samplesUnder(Body body) {
  vec2 low = floor(body.center.xy - body.half_size.xy - 1e-3), high = ceil(body.center.xy + body.half_size.xy + 1e-3);
  return Box(wholeNumbers(clamp(low, tile_first, tile_end) - tile_first), wholeNumbers(clamp(high, tile_first - 1.0, tile_end - 1.0) - tile_first));
}
