// Coulomb's cone: q, shortened to the length `cap` where it is longer. Without branches, and scaled so that the squares of all lengths from
// 1e-6 to 1e31 are normal floats.
vec2 onCone(vec2 q, float cap) {
  const float kScale = 9.094947e-13;  // 2^-40
  vec2 scaled_q = q * kScale;
  float square = dot(scaled_q, scaled_q), scaled_cap = cap * kScale;
  return mix(q, q * (scaled_cap * inversesqrt(square)), bvec2(square > scaled_cap * scaled_cap));
}
