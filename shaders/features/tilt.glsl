// Tilt of a flat face against the plane of its taxels, from a least-squares plane p + g . x through the forces of the core taxels. The
// slope is g over the skin's stiffness, d pressure / d depth = STIFFNESS pressure^(1 - 1 / EXPONENT). Reference:
// src/reference/contact_features.cpp.

// Core taxels in one row or column have no second moment across it, any others at least 3/4 of a pitch squared. The determinant is 0 but
// for rounding for taxels on a diagonal line, and 1.8e-4 times the product of the diagonal for two rows of 128.
const float kMinSpread = 3e-5;

struct Tilt {
  vec2 angles;  // rad, about x and y of C
  float confidence;
};

// `sums`: of kSumsSecond. `force`: mean force of the taxels that report, N.
Tilt tiltOf(PlaneRecord plane, PartSums sums, float force) {
  Tilt none = Tilt(vec2(0), 0.0);
  float n = sums.s[kCore];
  if (n < 4.0) return none;  // any three points fit a plane
  vec2 middle = vec2(sums.s[kCore + 1], sums.s[kCore + 2]) / n;
  float mean = sums.s[kCore + 6] / n;
  vec3 area = vec3(sums.s[kCore + 3], sums.s[kCore + 4], sums.s[kCore + 5]) -
              n * vec3(middle.x * middle.x, middle.x * middle.y, middle.y * middle.y);
  vec2 moment = vec2(sums.s[kCore + 7], sums.s[kCore + 8]) - n * mean * middle;
  float determinant = area.x * area.z - area.y * area.y;
  if (min(area.x, area.z) < 0.5 || determinant <= kMinSpread * area.x * area.z) return none;
  vec2 gradient = vec2(area.z * moment.x - area.y * moment.y, area.x * moment.y - area.y * moment.x) / determinant;  // N per pitch
  float squared_residual = max(sums.s[kCore + 9] - n * mean * mean - dot(gradient, moment), 0.0);
  float mean_force = force + mean;
  if (mean_force <= 0.0) return none;
  float stiffness = STIFFNESS * (EXPONENT == 1.0 ? 1.0 : pow(mean_force / plane.pitch.w, 1.0 - 1.0 / EXPONENT));
  vec2 slope = gradient / (plane.pitch.xy * plane.pitch.w * stiffness);
  return Tilt(vec2(angleOf(-slope.y, 1.0), angleOf(slope.x, 1.0)), max(1.0 - sqrt(squared_residual / (n - 3.0)) / mean_force, 0.0));
}
