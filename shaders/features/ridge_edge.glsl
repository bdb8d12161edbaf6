// The fit of a ridge to a part (features/ridge.glsl), and its angle. Reference: src/reference/ridge_edge.cpp.

// Solves the normal equations, with the prior, by the Schur complement of the linear part: matrices of three rows, because drivers do not
// unroll loops over six.
void solveRidge(PartSums sums, inout Ridge ridge) {
  float m[kRidgeMoments + kRidgeUnknowns];
  for (uint k = 0; k < kRidgeMoments + kRidgeUnknowns; ++k) m[k] = sums.s[kAfterWindow + k];
  mat3 linear = mat3(m[0] + kLeastWeight, m[1], m[2], m[1], m[3] + kRidgePrior, m[4], m[2], m[4], m[5] + kRidgePrior);
  mat3 mixed = mat3(m[3], m[6], m[7], m[4], m[7], m[8], m[5], m[8], m[9]);  // a column per quadratic monomial
  mat3 quadratic = mat3(m[10], m[11], m[12], m[11], m[12], m[13], m[12], m[13], m[14]) + mat3(kRidgePrior);
  vec3 right = vec3(m[15], m[16], m[17]), quadratic_right = vec3(m[18], m[19], m[20]) - 0.5 * kRidgePrior * vec3(1, 0, 1);
  mat3 inverse_linear = inverse(linear);
  mat3 reduced = transpose(mixed) * inverse_linear;
  vec3 curvature = inverse(quadratic - reduced * mixed) * (quadratic_right - reduced * right);
  vec3 slope = inverse_linear * (right - mixed * curvature);
  ridge.b = float[](slope.x, slope.y, slope.z, curvature.x, curvature.y, curvature.z);
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

// The ridge that the fit starts from. `second`: moments of all forces about `middle`, their centre, in C, m; `peak`, `noise`: N.
Ridge ridgeOf(Part part, vec3 second, vec3 middle, float peak, float noise) {
  Axes start = axesOf(second);
  Ridge ridge = noRidge();
  ridge.middle = middle;
  ridge.doubled = doubledAxis(second);
  ridge.along = halved(ridge.doubled);
  ridge.unit = sqrt(max(vec2(start.large, start.small), vec2(kLeastWidth * kLeastWidth * part.pitch.z * part.pitch.z)));
  ridge.per_unit = 1.0 / ridge.unit;
  ridge.peak = peak > 0.0 ? peak : 1.0;
  ridge.noise = noise;
  return ridge;
}

// Angle of a fitted ridge in C, in (-pi/2, pi/2], and how much its curvatures differ; both 0 where undefined. `peak`: N.
Axes axesOf(Ridge ridge, float peak) {
  // Curvatures of the logarithm, times unit.x unit.y.
  float uu = ridge.b[3] * ridge.unit.y / ridge.unit.x, vv = ridge.b[5] * ridge.unit.x / ridge.unit.y;
  vec2 difference = vec2(uu - vv, ridge.b[4]), doubled = ridge.doubled;
  float radius = 0.5 * length(difference), across = radius - 0.5 * (uu + vv), along = max(across - 2.0 * radius, 0.0);
  Axes axes = Axes(0.0, 0.0, 0.0, 0.0);
  if (peak <= 0.0 || across <= 0.0 || radius <= kLeastAnisotropy * across) return axes;
  axes.confidence = (across - along) / (across + along);
  axes.angle = 0.5 * angleOf(difference.x * doubled.y + difference.y * doubled.x, difference.x * doubled.x - difference.y * doubled.y);
  return axes;
}

// Fits the ridge and moves the window of a part, which has moved once before. All invocations of a team call it.
void fitRidge(Part part, float force, inout ForceWindow window, inout Ridge ridge) {
  uint n = 0;
  do {
    PartSums sums = sumPart(kSumsWindow | kSumsRidge, part, window.middle, 0.0, ridge);
    moveWindow(sums, force, window);
    solveRidge(sums, ridge);
  } while (++n < kRidgeIterations);
  n += 1;
  do {
    moveWindow(sumPart(kSumsWindow, part, window.middle, 0.0), force, window);
  } while (++n < kWindowIterations);
}
