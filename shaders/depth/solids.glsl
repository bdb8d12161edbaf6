// Solids: height of analytic solids and convex polyhedra over a sample. It is the lowest z in P (m) at which the ray p = (x, y, z), z
// rising, is inside the solid; kNoHeight where it never is, kBottomless where the solid extends down to infinity. Kinds as in
// include/taxelsim/object.h.
//
// The planes of a polyhedron's faces over the patch are computed once per body.
// Mutable globals, because arrays passed as arguments would be copied per sample: face_slopes, face_lows, face_highs, row_planes.
// Shared memory: with ONE_VECTOR 16 NUM_FACES bytes.
// References: src/reference/analytic.cpp, depth.cpp.

#include "depth/tile_heights.glsl"

// The solid in a slot.
struct Solid {
  uint kind;
  vec4 parameters;
  Affine X_PO;
};

// ---- convex polyhedra: a ray is inside from where it has passed all faces that look down to where it meets the first that looks up ----

// Planes over P: the slope of z for a face that looks down, of -z for one that looks up, so that both bounds are maxima; and the value of
// each bound at (0, 0), -kNoHeight for a face that looks the other way.
vec2 face_slopes[NUM_FACES];
float face_lows[NUM_FACES], face_highs[NUM_FACES];

// Steeper faces span less than a float resolves and only bound the others.
const float kSteepest = 1e-6;  // cosine to z

// The plane over P of one of a body's faces: slopes, low, high.
vec4 planeOf(uint face, Affine X_PO) {
  vec4 face_O = floatsOfFour(Faces, face);
  vec3 n = vec3(dot(X_PO.row0.xyz, face_O.xyz), dot(X_PO.row1.xyz, face_O.xyz), dot(X_PO.row2.xyz, face_O.xyz));
  float offset = face_O.w + n.x * X_PO.row0.w + n.y * X_PO.row1.w + n.z * X_PO.row2.w;
  vec3 plane = vec3(n.xy, -offset) / max(abs(n.z), kSteepest);
  return vec4(plane.xy, n.z < 0.0 ? plane.z : -kNoHeight, n.z < 0.0 ? -kNoHeight : plane.z);
}

// Loads the planes of a body, the same for all invocations of a workgroup.
#ifdef ONE_VECTOR
shared vec4 planes[NUM_FACES];
void loadFaces(uint first, Affine X_PO) {
  for (uint f = gl_LocalInvocationIndex; f < NUM_FACES; f += WORKGROUP) planes[f] = planeOf(first + f, X_PO);
  workgroupBarrier();
  for (uint f = 0; f < NUM_FACES; ++f) {
    face_slopes[f] = planes[f].xy;
    face_lows[f] = planes[f].z;
    face_highs[f] = planes[f].w;
  }
  workgroupBarrier();
}
#else
void loadFaces(uint first, Affine X_PO) {
  for (uint f = 0; f < NUM_FACES; ++f) {
    vec4 plane = planeOf(first + f, X_PO);
    face_slopes[f] = plane.xy;
    face_lows[f] = plane.z;
    face_highs[f] = plane.w;
  }
}
#endif

// Rays of a row share x: values of the bounds at y = 0.
vec2 row_planes[NUM_FACES];
void startRow(float x) {
  for (uint f = 0; f < NUM_FACES; ++f) row_planes[f] = face_slopes[f].x * x + vec2(face_lows[f], face_highs[f]);
}

float heightInRow(float y, float z_floor, inout Found found) {
  vec2 inside = vec2(-kNoHeight);  // from the first to minus the second
  for (uint f = 0; f < NUM_FACES; ++f) inside = max(inside, row_planes[f] + face_slopes[f].y * y);
  float low = inside.x, minus_high = inside.y;
  bool hit = low <= -minus_high;
  // As with triangles: where the side that looks down is below the floor, the other side is next.
  if (NUM_ROWS == 0 && hit && low < z_floor) {
    found.below_floor = true;
    low = -minus_high;
  }
  return hit ? low : kNoHeight;
}

float polyhedronHeight(vec2 xy, float z_floor, inout Found found) {
  startRow(xy.x);
  return heightInRow(xy.y, z_floor, found);
}

// ---- analytic solids ----

// The constant OBJECT_KINDS removes the code of solids that the model does not have, and the test of a solid that is the only one.
bool isKind(uint kind, uint wanted) { return OBJECT_KINDS == (1u << wanted) || ((OBJECT_KINDS & (1u << wanted)) != 0 && kind == wanted); }

const float kBottomless = -1e30;

// Smallest z of the unit normal of a half-space that looks down on a sample. Any other half-space has full depth at the samples inside it
// and does not press on the rest: neither a floor behind the sensor nor a wall beside it presses.
const float kLeastDescent = 1e-6;

// Rays go along z of P. Their points are o + t d in O, where t = 0 is at the height of O's origin; `from`: the ray from O's origin, across,
// in P. Compilers move terms that do not depend on the ray, such as reciprocals, out of loops over samples.
//
// Parts of a ray inside a convex set are intervals [near, far] of t; an empty one has near > far.
vec2 slab(float o, float d, float low, float high) {
  if (abs(d) < 1e-9) return o >= low && o <= high ? vec2(kBottomless, kNoHeight) : vec2(kNoHeight, kBottomless);
  return (d > 0.0 ? vec2(low, high) - o : vec2(high, low) - o) * (1.0 / d);
}

vec2 both(vec2 a, vec2 b) { return vec2(max(a.x, b.x), min(a.y, b.y)); }

vec2 insideSphere(vec2 from, float radius) {
  float q = radius * radius - dot(from, from);
  if (q < 0.0) return vec2(kNoHeight, kBottomless);
  float reach = sqrt(q);
  return vec2(-reach, reach);
}

// `axis`: its unit vector in P. A ray passes the axis at a distance that is linear in `from`, and comes closest at a height that is linear
// in it, too.
vec2 insideInfiniteCylinder(vec2 from, vec3 axis, float radius) {
  float across = dot(axis.xy, axis.xy);
  if (across < 1e-12) return dot(from, from) <= radius * radius ? vec2(kBottomless, kNoHeight) : vec2(kNoHeight, kBottomless);
  float per_length = inversesqrt(across);
  float distance = dot(from, vec2(-axis.y, axis.x) * per_length);
  float q = radius * radius - distance * distance;
  if (q < 0.0) return vec2(kNoHeight, kBottomless);
  float middle = dot(from, axis.xy * (axis.z / across)), reach = sqrt(q) * per_length;
  return vec2(middle - reach, middle + reach);
}

// x^2 + y^2 <= (k z)^2, 0 <= z <= height. Counted from the point of the ray closest to the apex, where the squares are smallest.
vec2 insideCone(vec3 o, vec3 d, float radius, float height) {
  float k2 = (radius / height) * (radius / height);
  float middle = -dot(o, d);
  vec3 closest = o + middle * d;
  vec2 within = slab(closest.z, d.z, 0.0, height);
  if (within.x > within.y) return within;
  float a = dot(d.xy, d.xy) - k2 * d.z * d.z;
  float b = dot(closest.xy, d.xy) - k2 * closest.z * d.z;
  float c = dot(closest.xy, closest.xy) - k2 * closest.z * closest.z;
  vec2 inside = within;
  if (abs(a) < 1e-7) {  // parallel to a generator: 2 b t + c <= 0
    float t = -c / (2.0 * b);
    if (abs(b) < 1e-12) {
      if (c > 0.0) inside = vec2(kNoHeight, kBottomless);
    } else if (b > 0.0) {
      inside.y = min(inside.y, t);
    } else {
      inside.x = max(inside.x, t);
    }
    return inside + middle;
  }
  float square = b * b - a * c;
  if (square < 0.0 && a > 0.0) return vec2(kNoHeight, kBottomless);
  // Below 0 with a < 0 only by rounding: a line through the apex. The root that does not cancel, and the other from their product.
  float root = sqrt(max(square, 0.0));
  float sum = b >= 0.0 ? -(b + root) : root - b;
  float t1 = sum / a;
  float t2 = sum != 0.0 ? c / sum : t1;
  float first = min(t1, t2), second = max(t1, t2);
  if (a > 0.0) {
    inside = both(within, vec2(first, second));
  } else if (d.z > 0.0) {  // steeper than the flank: inside before the first root (one nappe) and after the second (the other)
    inside.x = max(inside.x, second);
  } else {
    inside.y = min(inside.y, first);
  }
  return inside + middle;
}

float torusDistance(vec3 p, float major_radius, float minor_radius) {
  return length(vec2(length(p.xy) - major_radius, p.z)) - minor_radius;
}

// Sphere tracing on the exact distance, from the near side of the torus's bounding sphere. A ray that passes the tube at a small gap takes
// about pi sqrt(minor_radius / gap) steps; one that takes more than kSteps counts as a hit, so that the tube seems thicker by 1e-5 of its
// radius at most.
float torusHeight(vec2 from, vec3 o, vec3 d, float major_radius, float minor_radius) {
  const int kSteps = 1024;
  // m; a ray that stays farther away all along misses. Nearer than the rounding of t, a step would not advance.
  float touch = max(2e-8, 2.4e-7 * (major_radius + minor_radius));
  vec2 span = insideSphere(from, major_radius + minor_radius);
  float t = span.x;
  if (span.x > span.y) return kNoHeight;
  for (int i = 0; i < kSteps; ++i) {
    float distance = torusDistance(o + t * d, major_radius, minor_radius);
    if (distance < touch) return t;
    t += distance;
    if (t > span.y) return kNoHeight;
  }
  return t;
}

// Where the ray `from` is first inside of the solid: t, or kNoHeight.
float analyticEntry(uint kind, vec4 parameters, Affine X_PO, vec2 from) {
  vec3 o = X_PO.row0.xyz * from.x + X_PO.row1.xyz * from.y, d = X_PO.row2.xyz;
  vec3 axis = vec3(X_PO.row0.z, X_PO.row1.z, X_PO.row2.z);
  vec2 inside = vec2(kNoHeight, kBottomless);
  if (isKind(kind, kKindSphere)) {
    inside = insideSphere(from, parameters.x);
  } else if (isKind(kind, kKindCylinder)) {
    inside = both(insideInfiniteCylinder(from, axis, parameters.x), slab(o.z, d.z, -parameters.y, parameters.y));
  } else if (isKind(kind, kKindCapsule)) {
    vec2 tube = both(insideInfiniteCylinder(from, axis, parameters.x), slab(o.z, d.z, -parameters.y, parameters.y));
    vec3 end = parameters.y * axis;
    vec2 low = insideSphere(from + end.xy, parameters.x) - end.z, high = insideSphere(from - end.xy, parameters.x) + end.z;
    float near = kNoHeight;
    if (tube.x <= tube.y) near = tube.x;
    if (low.x <= low.y) near = min(near, low.x);
    if (high.x <= high.y) near = min(near, high.x);
    return near;
  } else if (isKind(kind, kKindBox)) {
    inside = both(both(slab(o.x, d.x, -parameters.x, parameters.x), slab(o.y, d.y, -parameters.y, parameters.y)),
                  slab(o.z, d.z, -parameters.z, parameters.z));
  } else if (isKind(kind, kKindHalfSpace)) {
    if (d.z > kLeastDescent) return -o.z / d.z;
    return o.z >= d.z * X_PO.row2.w ? kBottomless : kNoHeight;
  } else if (isKind(kind, kKindCone)) {
    inside = insideCone(o, d, parameters.x, parameters.y);
  } else if (isKind(kind, kKindTorus)) {
    return torusHeight(from, o, d, parameters.x, parameters.y);
  }
  return inside.x <= inside.y ? inside.x : kNoHeight;
}

// Height over the sample at `xy` of P. `X_PO`: pose of the solid in P; the faces of a polyhedron have been loaded (loadFaces()). `z_floor`:
// Tile.
float analyticHeight(uint kind, vec4 parameters, Affine X_PO, vec2 xy, float z_floor, inout Found found) {
  if (isKind(kind, kKindPolyhedron)) return polyhedronHeight(xy, z_floor, found);
  float t = analyticEntry(kind, parameters, X_PO, xy - vec2(X_PO.row0.w, X_PO.row1.w));
  return t >= kNoHeight ? kNoHeight : X_PO.row2.w + t;
}

// ---- part of a round solid below a level ----
//
// The part of a sphere, capsule or cylinder that is lower than a level lies within the solid's radius of its axis, which is cut where it is
// more than the radius above the level; the lowest point of what remains reaches farthest. Seen from above it is within `reach` of a
// segment.

const uint kRoundKinds = 1u << kKindSphere | 1u << kKindCapsule | 1u << kKindCylinder;
const bool kOnlyRound = (OBJECT_KINDS & ~kRoundKinds) == 0;

struct RoundPart {
  vec2 middle, ahead;        // middle and direction of the segment, m, in P; ahead has unit length
  float half_length, reach;  // m
  bool exists;
};

RoundPart roundPartBelow(float level, uint kind, vec4 parameters, Affine X_PO) {
  const float kRounding = 1e-6;  // m, of poses
  float radius = parameters.x + kRounding;
  vec3 middle = vec3(X_PO.row0.w, X_PO.row1.w, X_PO.row2.w - level), half_axis = vec3(0);
  if (!isKind(kind, kKindSphere)) half_axis = parameters.y * vec3(X_PO.row0.z, X_PO.row1.z, X_PO.row2.z);
  if (half_axis.z < 0.0) half_axis = -half_axis;
  vec3 low = middle - half_axis, high = middle + half_axis;
  if (high.z > radius) high = mix(low, high, clamp((radius - low.z) / max(high.z - low.z, kRounding), 0.0, 1.0));
  float above = max(low.z, 0.0), size = length(high.xy - low.xy);
  RoundPart part;
  part.middle = 0.5 * (low.xy + high.xy);
  part.ahead = size > kRounding ? (high.xy - low.xy) / size : vec2(1, 0);
  part.half_length = 0.5 * size;
  part.reach = sqrt(max(radius * radius - above * above, 0.0)) + kRounding;
  part.exists = low.z < radius;
  return part;
}

// Half the size of the rectangle around it, m.
vec2 halfSizeOf(RoundPart part) { return abs(part.ahead) * part.half_length + part.reach; }

// Whether it may reach into a rectangle. `half_size`: m.
bool reachesInto(RoundPart part, vec2 middle, vec2 half_size) {
  vec2 off = middle - part.middle, aside = vec2(-part.ahead.y, part.ahead.x);
  vec2 distance = abs(vec2(dot(off, part.ahead), dot(off, aside))) - vec2(dot(abs(part.ahead), half_size), dot(abs(aside), half_size));
  return part.exists && distance.x <= part.half_length + part.reach && distance.y <= part.reach;
}

// ---- chords ----
//
// Where a solid touches a line x = const of P: the part of the line over which the solid is below z = 0, in closed form for cylinder,
// capsule and sphere. Lengths in m, in P. The level is z = 0.
//
// The part of a convex solid below the level is convex, so that it touches the line in one piece. The ends of the piece are points of the
// level's section of the tube, of the silhouettes of the tube, or of its ends: rims of a cylinder, spheres of a capsule.

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
  vec2 inside = square > 1e-9 ? (vec2(-1, 1) * sqrt(max(q, 0.0)) - half_b) / square : vec2(kBottomless, kNoHeight);
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
  if (q < 0.0 || square < 1e-9) return vec2(kNoHeight, kBottomless);
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
  vec2 piece = vec2(kNoHeight, kBottomless);
  vec3 low = tube.middle - tube.half_length * tube.axis, high = tube.middle + tube.half_length * tube.axis;
  extendBySection(tube, x - tube.middle.x, piece);
  extendBySilhouettes(tube, x - tube.middle.x, piece);
  vec2 flat_end = vec2(kNoHeight, kBottomless);
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
