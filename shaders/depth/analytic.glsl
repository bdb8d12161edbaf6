// Height of analytic solids over a sample: the lowest z in P (m) at which the ray p = (x, y, z), z rising, is inside the solid; kMiss where it never is,
// kBottomless where the solid extends down to infinity. Solids as in include/taxelsim/object.h. Twin: src/reference/analytic.cpp.

// The constant OBJECT_KINDS removes the code of solids that the model does not have, and the test of a solid that is the only one.
bool isKind(uint kind, uint wanted) { return OBJECT_KINDS == (1u << wanted) || ((OBJECT_KINDS & (1u << wanted)) != 0 && kind == wanted); }

const float kBottomless = -1e30;

// Parts of the ray o + t d inside a convex set are intervals [near, far]; an empty one has near > far.
vec2 slab(float o, float d, float low, float high) {
  if (abs(d) < 1e-9) return o >= low && o <= high ? vec2(kBottomless, kMiss) : vec2(kMiss, kBottomless);
  vec2 t = (vec2(low, high) - o) / d;
  return vec2(min(t.x, t.y), max(t.x, t.y));
}

vec2 both(vec2 a, vec2 b) { return vec2(max(a.x, b.x), min(a.y, b.y)); }

// Distance of the ray's line from the middle decides, not a difference of squares of large numbers.
vec2 insideSphere(vec3 o, vec3 d, float radius) {
  float middle = -dot(o, d);
  vec3 closest = o + middle * d;
  float q = radius * radius - dot(closest, closest);
  if (q < 0.0) return vec2(kMiss, kBottomless);
  float reach = sqrt(q);
  return vec2(middle - reach, middle + reach);
}

vec2 insideInfiniteCylinder(vec3 o, vec3 d, float radius) {
  float d2 = dot(d.xy, d.xy);
  if (d2 < 1e-12) return dot(o.xy, o.xy) <= radius * radius ? vec2(kBottomless, kMiss) : vec2(kMiss, kBottomless);
  float middle = -dot(o.xy, d.xy) / d2;
  vec2 closest = o.xy + middle * d.xy;
  float q = radius * radius - dot(closest, closest);
  if (q < 0.0) return vec2(kMiss, kBottomless);
  float reach = sqrt(q / d2);
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
      if (c > 0.0) inside = vec2(kMiss, kBottomless);
    } else if (b > 0.0) {
      inside.y = min(inside.y, t);
    } else {
      inside.x = max(inside.x, t);
    }
    return inside + middle;
  }
  float square = b * b - a * c;
  if (square < 0.0 && a > 0.0) return vec2(kMiss, kBottomless);
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

// Sphere tracing on the exact distance, from the near side of the torus's bounding sphere. A ray that passes the tube at a small gap takes about
// pi sqrt(minor_radius / gap) steps; one that takes more than kSteps counts as a hit, so that the tube seems thicker by 1e-5 of its radius at most.
float torusHeight(vec3 o, vec3 d, float major_radius, float minor_radius) {
  const int kSteps = 1024;
  // m; a ray that stays farther away all along misses. Nearer than the rounding of t, a step would not advance.
  float touch = max(2e-8, 2.4e-7 * (major_radius + minor_radius));
  vec2 span = insideSphere(o, d, major_radius + minor_radius);
  float t = span.x;
  if (span.x > span.y) return kMiss;
  for (int i = 0; i < kSteps; ++i) {
    float distance = torusDistance(o + t * d, major_radius, minor_radius);
    if (distance < touch) return t;
    t += distance;
    if (t > span.y) return kMiss;
  }
  return t;
}

// Height over the sample at `xy` of P. `X_PO`: pose of the solid in P; the faces of a polyhedron have been loaded (loadFaces()). `z_floor`: Tile.
float analyticHeight(uint kind, vec4 parameters, Affine X_PO, vec2 xy, float z_floor, inout Found found) {
  if (isKind(kind, kKindPolyhedron)) return polyhedronHeight(xy, z_floor, found);
  vec3 r0 = X_PO.row0.xyz, r1 = X_PO.row1.xyz, r2 = X_PO.row2.xyz;
  vec3 from = vec3(xy.x - X_PO.row0.w, xy.y - X_PO.row1.w, -X_PO.row2.w);
  vec3 o = r0 * from.x + r1 * from.y + r2 * from.z;
  vec3 d = r2;
  vec2 inside = vec2(kMiss, kBottomless);
  if (isKind(kind, kKindSphere)) {
    inside = insideSphere(o, d, parameters.x);
  } else if (isKind(kind, kKindCylinder)) {
    inside = both(insideInfiniteCylinder(o, d, parameters.x), slab(o.z, d.z, -parameters.y, parameters.y));
  } else if (isKind(kind, kKindCapsule)) {
    vec2 tube = both(insideInfiniteCylinder(o, d, parameters.x), slab(o.z, d.z, -parameters.y, parameters.y));
    vec2 low = insideSphere(o + vec3(0, 0, parameters.y), d, parameters.x);
    vec2 high = insideSphere(o - vec3(0, 0, parameters.y), d, parameters.x);
    float near = kMiss;
    if (tube.x <= tube.y) near = tube.x;
    if (low.x <= low.y) near = min(near, low.x);
    if (high.x <= high.y) near = min(near, high.x);
    return near;
  } else if (isKind(kind, kKindBox)) {
    inside = both(both(slab(o.x, d.x, -parameters.x, parameters.x), slab(o.y, d.y, -parameters.y, parameters.y)),
                  slab(o.z, d.z, -parameters.z, parameters.z));
  } else if (isKind(kind, kKindHalfSpace)) {
    if (d.z > 1e-9) return -o.z / d.z;
    return d.z < -1e-9 || o.z >= 0.0 ? kBottomless : kMiss;
  } else if (isKind(kind, kKindCone)) {
    inside = insideCone(o, d, parameters.x, parameters.y);
  } else if (isKind(kind, kKindTorus)) {
    return torusHeight(o, d, parameters.x, parameters.y);
  }
  return inside.x <= inside.y ? inside.x : kMiss;
}
