// Stage 6: features from sums over taxels (paper section II.C and eq. 3, with the quadrant kept). Reference: src/reference/features.cpp.

#include "features/axes.glsl"

struct Moments {
  float force;  // N
  vec3 first;   // N m, about the origin of the sums, in C
  vec3 second;  // N m^2: xx, xy, yy
  float peak;   // N
  float area;   // m^2
};

// Second moments about the mean, divided by the force, m^2.
vec3 centralMoments(float weight, vec2 first, vec3 second) {
  vec2 mean = first / weight;
  vec3 central = second / weight - vec3(mean.x * mean.x, mean.x * mean.y, mean.y * mean.y);
  central.x = max(central.x, 0.0);
  central.z = max(central.z, 0.0);
  return central;
}

// Writes the 13 image features of one of `num_rows` rows, an instance or a part of one. Layout: shared/features.h; `start`: features before
// this block. `origin`: of the sums, in C, m.
void writeMoments(uint start, uint row, uint num_rows, Moments m, vec3 origin, vec4 X_SC_row0, vec4 X_SC_row1, vec4 X_SC_row2) {
  vec3 center = vec3(0), second = vec3(0);
  Axes axes = Axes(0.0, 0.0, 0.0, 0.0);
  if (m.force > 0.0) {
    second = centralMoments(m.force, m.first.xy, m.second);
    vec4 c = vec4(origin + m.first / m.force, 1.0);
    center = vec3(dot(X_SC_row0, c), dot(X_SC_row1, c), dot(X_SC_row2, c));
    axes = axesOf(second);
  }
  uint base = start * num_rows;
  features[base + kFeatureTotalForce * num_rows + row] = m.force;
  features[base + kFeaturePeakForce * num_rows + row] = m.peak;
  uint at = base + kFeatureCenterOfPressure * num_rows + 3 * row;
  features[at] = center.x;
  features[at + 1] = center.y;
  features[at + 2] = center.z;
  at = base + kFeatureSecondMoments * num_rows + 3 * row;
  features[at] = second.x;
  features[at + 1] = second.y;
  features[at + 2] = second.z;
  at = base + kFeatureEigenvalues * num_rows + 2 * row;
  features[at] = axes.large;
  features[at + 1] = axes.small;
  features[base + kFeatureEdgeAngle * num_rows + row] = axes.angle;
  features[base + kFeatureEdgeConfidence * num_rows + row] = axes.confidence;
  features[base + kFeatureContactArea * num_rows + row] = m.area;
}
