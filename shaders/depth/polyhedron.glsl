// Height of a convex polyhedron over a sample, m, in P: a ray is inside from where it has passed all faces that look down to where it meets
// the first that looks up. Twin: src/reference/depth.cpp, which rasterizes the triangles.
//
// The faces' planes over the patch are computed once per body.
// Mutable globals, because arrays passed as arguments would be copied per sample: face_slopes, face_lows, face_highs, row_planes.
// Shared memory: with ONE_VECTOR 16 NUM_FACES bytes.

// Planes over P: the slope of z for a face that looks down, of -z for one that looks up, so that both bounds are maxima; and the value of
// each bound at (0, 0), -kMiss for a face that looks the other way.
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
  return vec4(plane.xy, n.z < 0.0 ? plane.z : -kMiss, n.z < 0.0 ? -kMiss : plane.z);
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
  vec2 inside = vec2(-kMiss);  // from the first to minus the second
  for (uint f = 0; f < NUM_FACES; ++f) inside = max(inside, row_planes[f] + face_slopes[f].y * y);
  float low = inside.x, minus_high = inside.y;
  bool hit = low <= -minus_high;
  // As with triangles: where the side that looks down is below the floor, the other side is next.
  if (NUM_ROWS == 0 && hit && low < z_floor) {
    found.below_floor = true;
    low = -minus_high;
  }
  return hit ? low : kMiss;
}

float polyhedronHeight(vec2 xy, float z_floor, inout Found found) {
  startRow(xy.x);
  return heightInRow(xy.y, z_floor, found);
}
