// Stage 6: from sums over taxels to features (paper section II.C and eq. 3, with the quadrant kept). Twin: src/reference/features.cpp.

const float kPi = 3.14159265358979;
// m^2: where the eigenvalues differ by less than (1 um)^2 the image has no direction.
const float kNoDirection = 1e-12;

// atan2 to 2e-7 rad by a polynomial of our own, since drivers only promise 4096 units in the last place. 0 for (0, 0); pi, not -pi, for y = +-0, x < 0.
float angleOf(float y, float x) {
  float large = max(abs(x), abs(y));
  if (large == 0.0) return 0.0;
  float t = min(abs(x), abs(y)) / large;
  // One halving, atan t = 2 atan(t / (1 + sqrt(1 + t^2))), leaves |s| <= 0.4142, where eleven terms of the series suffice.
  float s = t / (1.0 + sqrt(1.0 + t * t));
  float q = s * s;
  float sum = 0.0;
  for (int n = 8; n >= 0; --n) sum = 1.0 / float(2 * n + 1) - q * sum;
  float angle = 2.0 * s * sum;
  if (abs(y) > abs(x)) angle = 0.5 * kPi - angle;
  if (x < 0.0) angle = kPi - angle;
  return y < 0.0 ? -angle : angle;
}

struct Moments {
  float force;    // N
  vec3 first;     // N m, about the origin of the sums, in C
  vec3 second;    // N m^2: xx, xy, yy
  float peak;     // N
  float area;     // m^2
};

// Fills the 13 image features at shared_features[start].
void writeMoments(uint start, Moments m, vec3 origin) {
  for (uint k = 0; k < kNumImageFeatures; ++k) shared_features[start + k] = 0.0;
  shared_features[start + kFeatureTotalForce] = m.force;
  shared_features[start + kFeaturePeakForce] = m.peak;
  shared_features[start + kFeatureContactArea] = m.area;
  if (m.force <= 0.0) return;
  vec3 mean = m.first / m.force;
  vec3 second = m.second / m.force - vec3(mean.x * mean.x, mean.x * mean.y, mean.y * mean.y);
  second.x = max(second.x, 0.0);
  second.z = max(second.z, 0.0);
  vec4 c = vec4(origin + mean, 1.0);
  shared_features[start + kFeatureCenterOfPressure] = dot(sensor.X_SC_row0, c);
  shared_features[start + kFeatureCenterOfPressure + 1] = dot(sensor.X_SC_row1, c);
  shared_features[start + kFeatureCenterOfPressure + 2] = dot(sensor.X_SC_row2, c);
  for (uint k = 0; k < 3; ++k) shared_features[start + kFeatureSecondMoments + k] = second[k];
  float middle = 0.5 * (second.x + second.z);
  float radius = length(vec2(0.5 * (second.x - second.z), second.y));
  float large = middle + radius, small = max(middle - radius, 0.0);
  shared_features[start + kFeatureEigenvalues] = large;
  shared_features[start + kFeatureEigenvalues + 1] = small;
  if (large - small <= kNoDirection) return;
  shared_features[start + kFeatureEdgeAngle] = 0.5 * angleOf(2.0 * second.y, second.x - second.z);
  shared_features[start + kFeatureEdgeConfidence] = (large - small) / (large + small);
}
