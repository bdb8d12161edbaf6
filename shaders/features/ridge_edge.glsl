// The fit of a ridge to a part (features/ridge.glsl), and its angle. Twin: src/reference/ridge_edge.cpp.

// Solves the normal equations, with the prior, by Cholesky's decomposition. They are positive definite: a part with force has a taxel that reports.
void solveRidge(PartSums sums, inout Ridge ridge) {
  const uvec2 kPowers[kRidgeUnknowns] = uvec2[](uvec2(0, 0), uvec2(1, 0), uvec2(0, 1), uvec2(2, 0), uvec2(1, 1), uvec2(0, 2));
  float lower[kRidgeUnknowns][kRidgeUnknowns];
  float y[kRidgeUnknowns];
  for (uint i = 0; i < kRidgeUnknowns; ++i) {
    for (uint j = 0; j <= i; ++j) {
      uvec2 powers = kPowers[i] + kPowers[j];
      float sum = sums.s[momentOf(powers.x, powers.y)] + (i == j && i > 0 ? kRidgePrior : 0.0);
      for (uint k = 0; k < j; ++k) sum -= lower[i][k] * lower[j][k];
      lower[i][j] = i == j ? sqrt(max(sum, 1e-6)) : sum / lower[j][j];
    }
    y[i] = sums.s[kRidgeMoments + i] - (i == 3 || i == 5 ? 0.5 * kRidgePrior : 0.0);
    for (uint k = 0; k < i; ++k) y[i] -= lower[i][k] * y[k];
    y[i] /= lower[i][i];
  }
  for (uint n = 0; n < kRidgeUnknowns; ++n) {
    uint i = kRidgeUnknowns - 1 - n;
    for (uint k = i + 1; k < kRidgeUnknowns; ++k) y[i] -= lower[k][i] * y[k];
    y[i] /= lower[i][i];
  }
  ridge.b = y;
}

// Cosine and sine of twice the angle of the major axis of second moments; without an axis that of x.
vec2 doubledAxis(vec3 second) {
  vec2 axis = vec2(second.x - second.z, 2.0 * second.y);
  float size = length(axis);
  return size > kNoDirection ? axis / size : vec2(1, 0);
}

// Direction whose doubled angle has this cosine and sine, without a cancellation.
vec2 halved(vec2 doubled) {
  float larger = sqrt(0.5 * (1.0 + abs(doubled.x))), smaller = 0.5 * doubled.y / larger;
  return doubled.x >= 0.0 ? vec2(larger, smaller) : vec2(smaller, larger);
}

// Angle of the ridge in C, in (-pi/2, pi/2], and how much its curvatures differ; both 0 where undefined.
// `second`: moments of all forces about `middle`, their centre, in C, m; `peak`, `noise`: N.
Axes ridgeEdge(Part part, vec3 second, vec3 middle, float peak, float noise) {
  Axes start = axesOf(second);
  vec2 doubled = doubledAxis(second);
  Ridge ridge = noRidge();
  ridge.middle = middle;
  ridge.along = halved(doubled);
  ridge.unit = sqrt(max(vec2(start.large, start.small), vec2(kLeastWidth * kLeastWidth * part.pitch.z * part.pitch.z)));
  ridge.peak = peak > 0.0 ? peak : 1.0;
  ridge.noise = noise;
  for (uint n = 0; n < kRidgeIterations; ++n) {
    PartSums sums = sumPart(kSumsRidge, part, middle, 0.0, ridge);
    solveRidge(sums, ridge);
    ridge.is_first = false;
  }
  // Curvatures of the logarithm, times unit.x unit.y.
  float uu = ridge.b[3] * ridge.unit.y / ridge.unit.x, vv = ridge.b[5] * ridge.unit.x / ridge.unit.y;
  vec2 difference = vec2(uu - vv, ridge.b[4]);
  float radius = 0.5 * length(difference), across = radius - 0.5 * (uu + vv), along = max(across - 2.0 * radius, 0.0);
  Axes axes = Axes(0.0, 0.0, 0.0, 0.0);
  if (peak <= 0.0 || across <= 0.0 || radius <= kLeastAnisotropy * across) return axes;
  axes.confidence = (across - along) / (across + along);
  axes.angle = 0.5 * angleOf(difference.x * doubled.y + difference.y * doubled.x, difference.x * doubled.x - difference.y * doubled.y);
  return axes;
}
