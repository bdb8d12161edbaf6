// Direction of an edge as the ridge of a Gaussian, exp of a quadratic in u and v, fitted to the forces of a part by iteratively reweighted
// least squares: a regression with a log link whose deviations grow with the force, as gains that differ between taxels make them
// (McCullagh and Nelder, Generalized Linear Models, 1989, chapter 8). Reference: src/reference/ridge_edge.cpp.
//
//   log(force / peak) = b0 + b1 u + b2 v + b3 u^2 + b4 u v + b5 v^2,    weight 1 / (1 + (noise / (scatter force))^2)
//
// u and v run along the principal axes of the forces, in units of their standard deviations. The fit starts from the Gaussian with these
// moments, so that two rounds suffice; from a regression of the logarithms of the forces, which silent taxels do not have, it took four.
// The position of a taxel is the mean position of the force that it receives (TaxelRecord::reception), which near a border is not its
// middle. A silent taxel counts where the fit expects more than its trigger.

const uint kRidgeIterations = 2u;
const uint kRidgeUnknowns = 6u, kRidgeMoments = 15u;  // moments of u and v up to the fourth
const float kGainScatter = 0.2;                       // relative standard deviation of a force, for the weights
const float kProfileError = 0.03;                     // share of the peak force by which a contact differs from a Gaussian
const float kRidgePrior = 0.1;                        // weight, in taxels, of the Gaussian with the second moments of the forces
const float kLeastWeight = 1e-6;                      // taxels; a sensor may be calibrated to have no taxel that counts
const float kLeastWidth = 0.5;                        // pitches, of the unit of u and v
const float kLeastLog = -20.0, kMostLog = 1.0;        // logarithm of a fitted force over the peak
const float kLeastAnisotropy = 1e-6;                  // share of the curvature across the ridge

struct Ridge {
  vec3 middle;    // origin of u and v, in C, m
  vec2 doubled;   // cosine and sine of twice the angle of u
  vec2 along;     // direction of u
  vec2 unit;      // unit of u and v, m
  vec2 per_unit;  // 1 / unit
  float peak;     // N
  float noise;    // noise of a taxel, N
  float b[kRidgeUnknowns];
};

Ridge noRidge() {
  Ridge ridge = Ridge(vec3(0), vec2(1, 0), vec2(1, 0), vec2(1), vec2(1), 1.0, 0.0, float[kRidgeUnknowns](0.0, 0.0, 0.0, -0.5, 0.0, -0.5));
  return ridge;
}

// Adds a taxel to the normal equations, from sum `first`: 15 moments of the weights, 6 right sides. `measured`: its force, N;
// `is_in_range`: it is in the part's range; `is_in`: it is one of the part. No branches (driver/README.md).
void addToRidge(Part part, uint t, float measured, bool is_in_range, bool is_in, Ridge ridge, uint first, inout PartSums sums) {
  vec4 reception = receptionOf(t);
  float trigger = reception.z;
  bool is_silent = !reportsForce(measured, trigger);
  bool counts = is_in_range && reception.w > 0.0 && (is_silent || is_in);
  vec2 p = (receptionPosition(part, t, reception) - ridge.middle).xy;
  float u = dot(ridge.along, p) * ridge.per_unit.x, v = dot(vec2(-ridge.along.y, ridge.along.x), p) * ridge.per_unit.y;
  float uu = u * u, uv = u * v, vv = v * v;
  // By degree; written out, because drivers do not unroll loops with such bounds.
  float monomials[kRidgeMoments] =
      float[](1.0, u, v, uu, uv, vv, uu * u, uu * v, u * vv, v * vv, uu * uu, uu * uv, uu * vv, uv * vv, vv * vv);
  float logarithm = 0.0;
  for (uint k = 0; k < kRidgeUnknowns; ++k) logarithm += ridge.b[k] * monomials[k];
  logarithm = clamp(logarithm, kLeastLog, kMostLog);
  float expected = ridge.peak * exp(logarithm);
  // Few divisions (driver/README.md): forces are compared as the taxel measures them.
  float measurable = reception.w * expected, per_measurable = 1.0 / measurable;
  float excess = is_silent ? -1.0 : clamp(measured * per_measurable - 1.0, -1.0, 1.0);
  vec2 errors = vec2(ridge.noise, reception.w * kProfileError * ridge.peak) * (1.0 / kGainScatter);
  float weight = measurable * measurable / (measurable * measurable + dot(errors, errors));
  if (is_silent) weight *= max(1.0 - trigger * per_measurable, 0.0);
  weight = counts ? weight : 0.0;
  float right = counts ? weight * (logarithm + excess) : 0.0;
  for (uint k = 0; k < kRidgeMoments; ++k) sums.s[first + k] += weight * monomials[k];
  for (uint k = 0; k < kRidgeUnknowns; ++k) sums.s[first + kRidgeMoments + k] += right * monomials[k];
}
