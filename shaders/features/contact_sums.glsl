// Sums over the taxels of a part (features/contact_parts.glsl), in a fixed order. Forces in N, lengths in m. Twin: src/reference/contact_features.cpp.

const float kWindow = 1.15;  // standard deviation of the Gaussian window, pitches

const float kTaxelNumbers = 16777216.0;  // 2^24: floats hold all numbers of taxels below it

// What is summed over the taxels of a part.
const uint kSumsForce = 0u;   // the largest force; force, first moments (3), area, number of taxels that report
const uint kSumsPeak = 1u;    // of lists: kTaxelNumbers less the first taxel with the largest force
const uint kSumsSecond = 2u;  // first (3) and second (3) moments about a point; the sums over core taxels
const uint kSumsWindow = 3u;  // first (2) moments, force and second (3) moments about a point, weighted by a Gaussian window around it
const uint kSumsRidge = 4u;   // normal equations of a step of the fit of a ridge (features/ridge.glsl)

// With kSumsSecond, the sums over core taxels begin here: their number, first (2) and second (3) moments of their positions (pitches), forces less `force`,
// first moments (2) and squares of these.
const uint kCore = 6u;

uint numSums(uint kind) { return kind == kSumsForce ? 7u : kind == kSumsPeak ? 1u : kind == kSumsSecond ? kCore + 10u : kind == kSumsRidge ? kMostSums : 6u; }

// Whether the first value is the largest one instead of a sum.
bool hasLargest(uint kind) { return kind <= kSumsPeak; }

void addSums(uint kind, inout PartSums total, PartSums more) {
  float largest = max(total.s[0], more.s[0]);
  for (uint k = 0; k < numSums(kind); ++k) total.s[k] += more.s[k];
  if (hasLargest(kind)) total.s[0] = largest;
}

// Adds taxel `t`. `middle`: the point of the moments, in C; `force`: the largest force (kSumsPeak) or the mean force (kSumsSecond), N.
void addTaxel(uint kind, Part part, uint t, vec3 middle, float force, Ridge ridge, inout PartSums sums) {
  if (kind == kSumsRidge) {
    addToRidge(part, t, ridge, sums);
    return;
  }
  float weight = forces[part.first_taxel + t];
  bool is_in = isIn(part, t);
  if (!is_in) weight = 0.0;
  if (kind == kSumsPeak) {
    if (weight == force) sums.s[0] = max(sums.s[0], kTaxelNumbers - float(t));
    return;
  }
  vec3 p = positionOf(part, t) - middle;
  if (kind == kSumsForce) {
    bool counts = is_in && reportsForce(weight, CLEAN ? readoutOf(t).y : 0.0);
    sums.s[0] = max(sums.s[0], weight);
    sums.s[1] += weight;
    sums.s[2] += weight * p.x;
    sums.s[3] += weight * p.y;
    sums.s[4] += weight * p.z;
    sums.s[5] += counts ? (kOnePatch ? PITCH_X * PITCH_Y : chartOf(t).w) : 0.0;
    sums.s[6] += counts ? 1.0 : 0.0;
    return;
  }
  if (kind == kSumsWindow) {
    float width = kWindow * part.pitch.z;
    weight *= exp(-0.5 * dot(p.xy, p.xy) / (width * width));
  }
  sums.s[0] += weight * p.x;
  sums.s[1] += weight * p.y;
  sums.s[2] += kind == kSumsWindow ? weight : weight * p.z;
  sums.s[3] += weight * p.x * p.x;
  sums.s[4] += weight * p.x * p.y;
  sums.s[5] += weight * p.y * p.y;
  if (kList || kind != kSumsSecond) return;
  vec2 at = p.xy / part.pitch.xy;
  float one = (taxel_regions[part.first_taxel + t] & kCoreTaxel) != 0 && weight > 0.0 ? 1.0 : 0.0;
  float more = one * (weight - force);
  sums.s[kCore] += one;
  sums.s[kCore + 1] += one * at.x;
  sums.s[kCore + 2] += one * at.y;
  sums.s[kCore + 3] += one * at.x * at.x;
  sums.s[kCore + 4] += one * at.x * at.y;
  sums.s[kCore + 5] += one * at.y * at.y;
  sums.s[kCore + 6] += more;
  sums.s[kCore + 7] += more * at.x;
  sums.s[kCore + 8] += more * at.y;
  sums.s[kCore + 9] += more * more;
}

// Sums of one kind over all taxels of a part; every invocation of the team gets them.
PartSums sumPart(uint kind, Part part, vec3 middle, float force, Ridge ridge) {
  uint lane = gl_LocalInvocationIndex % TEAM;
  uint first_partial = gl_LocalInvocationIndex / TEAM * kMostSums * LANES;
  PartSums total = noSums();
  for (uint v = lane; v < LANES; v += TEAM) {
    PartSums sums = noSums();
    uint t = part.first + v;
    for (; t < part.end; t += LANES) addTaxel(kind, part, t, middle, force, ridge, sums);
    checkLoop(t < part.end);
    if (TEAM == 1) {
      addSums(kind, total, sums);
    } else {
      for (uint k = 0; k < numSums(kind); ++k) partial[first_partial + k * LANES + v] = sums.s[k];
    }
  }
  if (TEAM > 1) {
    barrier();
    for (uint v = 0; v < LANES; ++v) {
      PartSums sums = noSums();
      for (uint k = 0; k < numSums(kind); ++k) sums.s[k] = partial[first_partial + k * LANES + v];
      addSums(kind, total, sums);
    }
    barrier();
  }
  return total;
}

PartSums sumPart(uint kind, Part part, vec3 middle, float force) { return sumPart(kind, part, middle, force, noRidge()); }
