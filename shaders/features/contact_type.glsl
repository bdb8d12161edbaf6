// Type of a contact (ContactType, shared/features.h), from length and width of the rectangle of uniform pressure that has its second
// moments, less what spread and taxel size add to them. A contact that is as wide as the array is no edge: the array ends there, not the
// contact. Reference: src/reference/contact_features.cpp.

const float kNoiseFactor = 5.0;     // standard deviations of the noise that a force must exceed
const float kMaxPointLength = 2.5;  // pitches
const float kMaxEdgeWidth = 0.5;    // share of its length
const float kArrayWidth = 0.9;      // share of the width of the array under even pressure

// Pitch along an axis of C, m.
float pitchAlong(PlaneRecord plane, vec2 axis) { return length(axis * plane.pitch.xy); }

// Second moment about the line through the centre that is perpendicular to `axis`, m^2.
float secondMomentAlong(vec3 second, vec2 axis) {
  return second.x * axis.x * axis.x + 2.0 * second.y * axis.x * axis.y + second.z * axis.y * axis.y;
}

// `across`: direction of the width, in C; `width`: m.
bool isAsWideAsTheArray(PlaneRecord plane, vec2 across, float width) {
  float array_width = sqrt(12.0 * max(secondMomentAlong(plane.even.xyz - plane.spread.xyz, across), 0.0));
  return width > kMaxPointLength * pitchAlong(plane, across) && width >= kArrayWidth * array_width;
}

// `second`: central second moments, m^2.
float typeOf(PlaneRecord plane, vec3 second, float force) {
  if (force <= 0.0) return kContactNone;
  Axes touched = axesOf(second - plane.spread.xyz);
  vec2 along = vec2(cos(touched.angle), sin(touched.angle));
  float size = sqrt(12.0 * max(touched.large, 0.0)), width = sqrt(12.0 * touched.small);
  if (size <= kMaxPointLength * pitchAlong(plane, along)) return kContactPoint;
  bool narrow = width <= kMaxEdgeWidth * size;
  return narrow && !isAsWideAsTheArray(plane, vec2(-along.y, along.x), width) ? kContactEdge : kContactArea;
}
