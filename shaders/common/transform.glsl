// Rigid and affine maps as three rows (A | b): the image of p is A p + b. Lengths of vectors.
#ifndef COMMON_TRANSFORM_GLSL
#define COMMON_TRANSFORM_GLSL
struct Affine {
  vec4 row0, row1, row2;
};

vec3 apply(Affine X, vec3 p) { return vec3(dot(X.row0.xyz, p) + X.row0.w, dot(X.row1.xyz, p) + X.row1.w, dot(X.row2.xyz, p) + X.row2.w); }

// X_AC from X_AB and X_BC.
Affine compose(Affine X_AB, Affine X_BC) {
  Affine X_AC;
  X_AC.row0 = X_AB.row0.x * X_BC.row0 + X_AB.row0.y * X_BC.row1 + X_AB.row0.z * X_BC.row2;
  X_AC.row1 = X_AB.row1.x * X_BC.row0 + X_AB.row1.y * X_BC.row1 + X_AB.row1.z * X_BC.row2;
  X_AC.row2 = X_AB.row2.x * X_BC.row0 + X_AB.row2.y * X_BC.row1 + X_AB.row2.z * X_BC.row2;
  X_AC.row0.w += X_AB.row0.w;
  X_AC.row1.w += X_AB.row1.w;
  X_AC.row2.w += X_AB.row2.w;
  return X_AC;
}

// X_BA from the rigid X_AB.
Affine inverseOf(Affine X_AB) {
  mat3 R_BA = mat3(X_AB.row0.xyz, X_AB.row1.xyz, X_AB.row2.xyz);  // by columns: the transpose of R_AB
  vec3 b = -(R_BA * vec3(X_AB.row0.w, X_AB.row1.w, X_AB.row2.w));
  return Affine(vec4(X_AB.row0.x, X_AB.row1.x, X_AB.row2.x, b.x), vec4(X_AB.row0.y, X_AB.row1.y, X_AB.row2.y, b.y),
                vec4(X_AB.row0.z, X_AB.row1.z, X_AB.row2.z, b.z));
}

// Center and half size of the exact bounds, per axis, of the image of the box (center, half_size).
void boundsOfImage(Affine X, vec3 center, vec3 half_size, out vec3 image_center, out vec3 image_half) {
  image_center = apply(X, center);
  image_half = vec3(dot(abs(X.row0.xyz), half_size), dot(abs(X.row1.xyz), half_size), dot(abs(X.row2.xyz), half_size));
}

// Coulomb's cone: q, shortened to the length `cap` where it is longer. Without branches, and scaled so that the squares of all lengths from
// 1e-6 to 1e31 are normal floats.
vec2 onCone(vec2 q, float cap) {
  const float kScale = 9.094947e-13;  // 2^-40
  vec2 scaled_q = q * kScale;
  float square = dot(scaled_q, scaled_q), scaled_cap = cap * kScale;
  return mix(q, q * (scaled_cap * inversesqrt(square)), bvec2(square > scaled_cap * scaled_cap));
}
#endif
