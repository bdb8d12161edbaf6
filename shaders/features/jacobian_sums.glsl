// Sums over the taxels of a part (features/jacobian_parts.glsl) or the tiles of its instance, in a fixed order. `middle`: the point of the moments, in C, m;
// `k`: a coordinate of the sensor's twist. Twin: src/reference/tactile_jacobian.cpp.

// What is summed over the taxels of a part.
const uint kSumsFirst = 0u;   // force, first moments (3)
const uint kSumsSecond = 1u;  // second moments (3) about a point
const uint kSumsChange = 2u;  // derivatives of force, first (3) and second (3) moments about a point by one coordinate of the twist
const uint kSumsWrench = 3u;  // derivatives of the wrench (6), over tiles

void addTaxel(uint kind, Part part, uint t, vec3 middle, uint k, inout PartSums sums) {
  vec2 reading = vec2(0, 1);
  if (!CLEAN || kind != kSumsChange) reading = readingOf(part, t);
  vec3 p = positionOf(part, t) - middle;
  if (kind == kSumsSecond) {
    sums.s[0] += reading.x * p.x * p.x;
    sums.s[1] += reading.x * p.x * p.y;
    sums.s[2] += reading.x * p.y * p.y;
    return;
  }
  float weight = kind == kSumsFirst ? reading.x : reading.y * spreadChange(part.instance, t, k);
  sums.s[0] += weight;
  sums.s[1] += weight * p.x;
  sums.s[2] += weight * p.y;
  sums.s[3] += weight * p.z;
  if (kind == kSumsFirst) return;
  sums.s[4] += weight * p.x * p.x;
  sums.s[5] += weight * p.x * p.y;
  sums.s[6] += weight * p.y * p.y;
}

void addTile(Part part, uint tile, uint k, inout PartSums sums) {
  uint first = (part.instance * NUM_TILES + tile) * kNumWrenchJacobian + k;
  for (uint c = 0; c < 6; ++c) sums.s[c] += wrench_jacobian[first + 6 * c];
}

// Sums of one kind over all taxels of the part, or all tiles of the instance; every invocation of the team gets them.
PartSums sumPart(uint kind, Part part, vec3 middle, uint k) {
  uint lane = gl_LocalInvocationIndex % TEAM;
  uint first_partial = gl_LocalInvocationIndex / TEAM * kMostSums * LANES;
  uint first = kind == kSumsWrench ? 0 : part.first, end = kind == kSumsWrench ? NUM_TILES : part.end;
  PartSums total = noSums();
  for (uint v = lane; v < LANES; v += TEAM) {
    PartSums sums = noSums();
    uint t = first + v;
    for (; t < end; t += LANES) {
      if (kind == kSumsWrench) {
        addTile(part, t, k, sums);
      } else {
        addTaxel(kind, part, t, middle, k, sums);
      }
    }
    checkLoop(t < end);
    for (uint s = 0; s < kMostSums; ++s) {
      if (TEAM == 1) {
        total.s[s] += sums.s[s];
      } else {
        partial[first_partial + s * LANES + v] = sums.s[s];
      }
    }
  }
  if (TEAM > 1) {
    barrier();
    for (uint v = 0; v < LANES; ++v) {
      for (uint s = 0; s < kMostSums; ++s) total.s[s] += partial[first_partial + s * LANES + v];
    }
    barrier();
  }
  return total;
}
