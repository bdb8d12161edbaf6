// Type of a contact (ContactType, shared/features.h), from length and width of the rectangle of uniform pressure that has its second moments, less what spread
// and taxel size add to them. Twin: src/reference/contact_features.cpp.

const float kNoiseFactor = 5.0;     // standard deviations of the noise that a force must exceed
const float kMaxPointLength = 2.5;  // pitches
const float kMaxEdgeWidth = 0.5;    // of its length

// `second`: central second moments, m^2. `least_force`: N; with less there is no contact.
float typeOf(PlaneRecord plane, vec3 second, float force, float least_force) {
  if (force <= least_force) return kContactNone;
  Axes touched = axesOf(second - plane.spread.xyz);
  float pitch = length(vec2(cos(touched.angle), sin(touched.angle)) * plane.pitch.xy);
  float size = sqrt(12.0 * max(touched.large, 0.0)), width = sqrt(12.0 * touched.small);
  if (size <= kMaxPointLength * pitch) return kContactPoint;
  return width <= kMaxEdgeWidth * size ? kContactEdge : kContactArea;
}
