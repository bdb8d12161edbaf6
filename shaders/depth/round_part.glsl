// The part of a sphere, capsule or cylinder that is lower than a level lies within the solid's radius of its axis, which is cut where it is
// more than the radius above the level; the lowest point of what remains reaches farthest. Seen from above it is within `reach` of a
// segment.

const uint kRoundKinds = 1u << kKindSphere | 1u << kKindCapsule | 1u << kKindCylinder;
const bool kOnlyRound = (OBJECT_KINDS & ~kRoundKinds) == 0;

struct RoundPart {
  vec2 middle, ahead;        // of the segment, m, in P; ahead has unit length
  float half_length, reach;  // m
  bool exists;
};

RoundPart roundPartBelow(float level, uint kind, vec4 parameters, Affine X_PO) {
  const float kRounding = 1e-6;  // m, of poses
  float radius = parameters.x + kRounding;
  vec3 middle = vec3(X_PO.row0.w, X_PO.row1.w, X_PO.row2.w - level), half_axis = vec3(0);
  if (!isKind(kind, kKindSphere)) half_axis = parameters.y * vec3(X_PO.row0.z, X_PO.row1.z, X_PO.row2.z);
  if (half_axis.z < 0.0) half_axis = -half_axis;
  vec3 low = middle - half_axis, high = middle + half_axis;
  if (high.z > radius) high = mix(low, high, clamp((radius - low.z) / max(high.z - low.z, kRounding), 0.0, 1.0));
  float above = max(low.z, 0.0), size = length(high.xy - low.xy);
  RoundPart part;
  part.middle = 0.5 * (low.xy + high.xy);
  part.ahead = size > kRounding ? (high.xy - low.xy) / size : vec2(1, 0);
  part.half_length = 0.5 * size;
  part.reach = sqrt(max(radius * radius - above * above, 0.0)) + kRounding;
  part.exists = low.z < radius;
  return part;
}

// Half the size of the rectangle around it, m.
vec2 halfSizeOf(RoundPart part) { return abs(part.ahead) * part.half_length + part.reach; }

// Whether it may reach into a rectangle. `half_size`: m.
bool reachesInto(RoundPart part, vec2 middle, vec2 half_size) {
  vec2 off = middle - part.middle, aside = vec2(-part.ahead.y, part.ahead.x);
  vec2 distance = abs(vec2(dot(off, part.ahead), dot(off, aside))) - vec2(dot(abs(part.ahead), half_size), dot(abs(aside), half_size));
  return part.exists && distance.x <= part.half_length + part.reach && distance.y <= part.reach;
}
