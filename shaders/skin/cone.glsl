// Coulomb's cone: q, shortened to the length `cap` where it is longer. Computed without squares, which may overflow.
vec2 onCone(vec2 q, float cap) {
  float largest = max(abs(q.x), abs(q.y));
  if (largest <= 0.0) return q;
  vec2 direction = q / largest;
  float size = length(direction);  // 1 to sqrt(2)
  return largest * size <= cap ? q : direction * (cap / size);
}
