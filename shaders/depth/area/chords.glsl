// Where a solid touches a line x = const of P: the part of the line over which the solid is below z = 0, in closed form for cylinder,
// capsule and sphere. Lengths in m, in P. The level is z = 0.
//
// The part of a convex solid below the level is convex, so that it touches the line in one piece. The ends of the piece are points of the
// level's section of the tube, of the silhouettes of the tube, or of its ends: rims of a cylinder, spheres of a capsule.

// The solid in a slot.
struct Solid {
  uint kind;
  vec4 parameters;
  Affine X_PO;
};

// A tube around an axis. A sphere is a capsule without length.
struct Tube {
  vec3 middle, axis;  // the axis has unit length and does not point down
  float radius, half_length;
  vec2 ahead;       // the axis seen from above, of unit length
  float per_level;  // 1 over the length of the axis seen from above
};

Tube tubeOf(Solid solid) {
  vec3 axis = vec3(solid.X_PO.row0.z, solid.X_PO.row1.z, solid.X_PO.row2.z);
  vec3 middle = vec3(solid.X_PO.row0.w, solid.X_PO.row1.w, solid.X_PO.row2.w);
  if (axis.z < 0.0) axis = -axis;
  const float kUprightLevel = 1e-4;
  float per_level = 1.0 / max(length(axis.xy), kUprightLevel);
  vec2 ahead = axis.xy * per_level;
  return Tube(middle, axis, solid.parameters.x, solid.kind == kKindSphere ? 0.0 : solid.parameters.y, ahead, per_level);
}

void extend(inout vec2 piece, float y) { piece = vec2(min(piece.x, y), max(piece.y, y)); }

// The tube's section with the level.
void extendBySection(Tube tube, float dx, inout vec2 piece) {
  vec3 a = tube.axis;
  float along = dx * a.x - tube.middle.z * a.z, square = 1.0 - a.y * a.y;
  // |d|^2 - (d . a)^2 <= radius^2 for d = (dx, y, -middle.z), and |d . a| <= half_length.
  float half_b = -a.y * along, c = dx * dx + tube.middle.z * tube.middle.z - along * along - tube.radius * tube.radius;
  float q = half_b * half_b - square * c;
  if (square > 1e-9 ? q < 0.0 : c > 0.0) return;
  vec2 inside = square > 1e-9 ? (vec2(-1, 1) * sqrt(max(q, 0.0)) - half_b) / square : vec2(kBottomless, kMiss);
  inside = both(inside, slab(along, a.y, -tube.half_length, tube.half_length));
  if (inside.x > inside.y) return;
  extend(piece, tube.middle.y + inside.x);
  extend(piece, tube.middle.y + inside.y);
}

// The two lines along the tube whose normals are horizontal.
void extendBySilhouettes(Tube tube, float dx, inout vec2 piece) {
  vec3 a = tube.axis;
  float level = length(a.xy);
  if (level < 1e-6 || abs(a.x) < 1e-9) return;
  vec2 normal = vec2(a.y, -a.x) * (tube.radius / level);
  for (float side = -1.0; side < 2.0; side += 2.0) {
    float t = (dx - side * normal.x) / a.x;
    if (abs(t) <= tube.half_length && tube.middle.z + t * a.z < 0.0) extend(piece, tube.middle.y + t * a.y + side * normal.y);
  }
}

// A rim of a cylinder. Returns its piece of the line, empty where the rim does not reach the line.
vec2 extendByRim(Tube tube, vec3 end, float x, inout vec2 piece) {
  vec3 a = tube.axis;
  float square = a.y * a.y + a.z * a.z, per_root = inversesqrt(max(square, 1e-12));
  // The rim's plane is spanned by w in x and u along the plane x = const.
  float s = (x - end.x) * per_root, q = tube.radius * tube.radius - s * s;
  if (q < 0.0 || square < 1e-9) return vec2(kMiss, kBottomless);
  vec2 t = vec2(-1, 1) * sqrt(q) * per_root, across = end.yz - s * per_root * a.x * a.yz;
  vec2 y = across.x + t * a.z, z = across.y - t * a.y;
  if (z.x < 0.0) extend(piece, y.x);
  if (z.y < 0.0) extend(piece, y.y);
  return y;
}

void extendBySphere(vec3 end, float radius, float x, inout vec2 piece) {
  float dx = x - end.x, up = max(end.z, 0.0), q = radius * radius - dx * dx - up * up;
  if (q < 0.0) return;
  extend(piece, end.y - sqrt(q));
  extend(piece, end.y + sqrt(q));
}

// The piece of the line that the tube touches, x and w, and the part of it that the lower end of a cylinder has, y and z. Nothing where x >
// w.
vec4 chordOf(Tube tube, bool is_cylinder, float x) {
  vec2 piece = vec2(kMiss, kBottomless);
  vec3 low = tube.middle - tube.half_length * tube.axis, high = tube.middle + tube.half_length * tube.axis;
  extendBySection(tube, x - tube.middle.x, piece);
  extendBySilhouettes(tube, x - tube.middle.x, piece);
  vec2 flat_end = vec2(kMiss, kBottomless);
  if (is_cylinder) {
    flat_end = extendByRim(tube, low, x, piece);
    extendByRim(tube, high, x, piece);
  } else {
    extendBySphere(low, tube.radius, x, piece);
    extendBySphere(high, tube.radius, x, piece);
  }
  if (flat_end.x > flat_end.y) flat_end = mix(piece.xx, piece.yy, vec2(1.0, 2.0) / 3.0);
  return vec4(piece.x, flat_end, piece.y);
}
