// Stage 6: from sums over taxels to features (paper section II.C and eq. 3, with the quadrant kept). Twin: src/reference/features.cpp.

const float kPi = 3.14159265358979;
// m^2: where the eigenvalues differ by less than (1 um)^2 the image has no direction.
const float kNoDirection = 1e-12;

// atan2 to 2e-7 rad by a series of our own, since drivers only promise 4096 units in the last place. 0 for (0, 0); pi, not -pi, for y = +-0, x < 0.
float angleOf(float y, float x) {
  float large = max(abs(x), abs(y));
  if (large == 0.0) return 0.0;
  float t = min(abs(x), abs(y)) / large;
  // One halving, atan t = 2 atan(t / (1 + sqrt(1 + t^2))), leaves at most 0.4142, where nine terms of the series suffice.
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
  float force;  // N
  vec3 first;   // N m, about the origin of the sums, in C
  vec3 second;  // N m^2: xx, xy, yy
  float peak;   // N
  float area;   // m^2
};

// The 13 image features of one instance; those of a block of components lie side by side, the blocks of all instances one after another.
void writeMoments(uint start, uint instance, uint num_instances, Moments m, vec3 origin, vec4 X_SC_row0, vec4 X_SC_row1, vec4 X_SC_row2) {
  vec3 center = vec3(0), second = vec3(0);
  float large = 0.0, small = 0.0, angle = 0.0, confidence = 0.0;
  if (m.force > 0.0) {
    vec3 mean = m.first / m.force;
    second = m.second / m.force - vec3(mean.x * mean.x, mean.x * mean.y, mean.y * mean.y);
    second.x = max(second.x, 0.0);
    second.z = max(second.z, 0.0);
    vec4 c = vec4(origin + mean, 1.0);
    center = vec3(dot(X_SC_row0, c), dot(X_SC_row1, c), dot(X_SC_row2, c));
    float middle = 0.5 * (second.x + second.z);
    float radius = length(vec2(0.5 * (second.x - second.z), second.y));
    large = middle + radius;
    small = max(middle - radius, 0.0);
    if (large - small > kNoDirection) {
      angle = 0.5 * angleOf(2.0 * second.y, second.x - second.z);
      confidence = (large - small) / (large + small);
    }
  }
  uint base = start * num_instances;
  features[base + kFeatureTotalForce * num_instances + instance] = m.force;
  features[base + kFeaturePeakForce * num_instances + instance] = m.peak;
  uint at = base + kFeatureCenterOfPressure * num_instances + 3 * instance;
  features[at] = center.x;
  features[at + 1] = center.y;
  features[at + 2] = center.z;
  at = base + kFeatureSecondMoments * num_instances + 3 * instance;
  features[at] = second.x;
  features[at + 1] = second.y;
  features[at + 2] = second.z;
  at = base + kFeatureEigenvalues * num_instances + 2 * instance;
  features[at] = large;
  features[at + 1] = small;
  features[base + kFeatureEdgeAngle * num_instances + instance] = angle;
  features[base + kFeatureEdgeConfidence * num_instances + instance] = confidence;
  features[base + kFeatureContactArea * num_instances + instance] = m.area;
}
