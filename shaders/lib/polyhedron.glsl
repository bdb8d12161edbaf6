// Height of a convex polyhedron over a sample: a ray is inside from where it has passed all faces that look down to where it meets the first that looks up.
// The faces' planes over the patch are computed once per body and stay in registers. Twin: src/reference/depth.cpp, which knows the triangles only.

// A plane over P as value = (x, y, 1) . plane. Of a face that looks down it is the height z, of one that looks up -z, so that both bounds are maxima.
vec3 face_planes[FACES];
bool face_looks_down[FACES];

// A face steeper than this shows its flank over less than a float resolves: it only cuts.
const float kSteepest = 1e-6;  // cosine to z

void loadFaces(uint first, Affine X_PO) {
  for (uint f = 0; f < FACES; ++f) {
    vec2 w0 = uintBitsToFloat(wordsOf(faces[2 * (first + f)])), w1 = uintBitsToFloat(wordsOf(faces[2 * (first + f) + 1]));
    vec3 n_O = vec3(w0, w1.x);
    vec3 n = vec3(dot(X_PO.row0.xyz, n_O), dot(X_PO.row1.xyz, n_O), dot(X_PO.row2.xyz, n_O));
    float offset = w1.y + n.x * X_PO.row0.w + n.y * X_PO.row1.w + n.z * X_PO.row2.w;
    face_looks_down[f] = n.z < 0.0;
    face_planes[f] = vec3(n.xy, -offset) / max(abs(n.z), kSteepest);
  }
}

float polyhedronHeight(vec2 xy) {
  float low = -kMiss, minus_high = -kMiss;
  for (uint f = 0; f < FACES; ++f) {
    float value = face_planes[f].x * xy.x + face_planes[f].y * xy.y + face_planes[f].z;
    low = face_looks_down[f] && value > low ? value : low;
    minus_high = !face_looks_down[f] && value > minus_high ? value : minus_high;
  }
  bool hit = low <= -minus_high;
  // As triangles have it: where the side that looks down is too deep to be seen, the other one is next.
  if (NUM_ROWS == 0 && hit && low < z_floor) {
    met_behind = true;
    low = -minus_high;
  }
  return hit ? low : kMiss;
}
