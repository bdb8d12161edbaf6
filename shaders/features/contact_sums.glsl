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

// Adds taxel `t`. `weight`: its force, N; `trigger`: that of its clean force, N; `word`: its word in taxel_regions. `middle`: the point of the moments, in C;
// `force`: the largest force (kSumsPeak) or the mean force (kSumsSecond), N.
void addTaxel(uint kind, Part part, uint t, float weight, float trigger, uint word, vec3 middle, float force, Ridge ridge, inout PartSums sums) {
  bool is_in_range = t >= part.first && t < part.end, is_in = is_in_range && isOfRegion(part, word);
  t = min(t, NUM_TAXELS - 1u);
  if (kind == kSumsRidge) {
    addToRidge(part, t, weight, is_in_range, is_in, ridge, sums);
    return;
  }
  if (!is_in) weight = 0.0;
  if (kind == kSumsPeak) {
    if (weight == force) sums.s[0] = max(sums.s[0], kTaxelNumbers - float(t));
    return;
  }
  vec3 p = positionOf(part, t) - middle;
  if (kind == kSumsForce) {
    bool counts = is_in && reportsForce(weight, trigger);
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
    float per_width = part.per_pitch.z * (1.0 / kWindow);
    weight *= exp(-0.5 * dot(p.xy, p.xy) * (per_width * per_width));
  }
  sums.s[0] += weight * p.x;
  sums.s[1] += weight * p.y;
  sums.s[2] += kind == kSumsWindow ? weight : weight * p.z;
  sums.s[3] += weight * p.x * p.x;
  sums.s[4] += weight * p.x * p.y;
  sums.s[5] += weight * p.y * p.y;
  if (kList || kind != kSumsSecond) return;
  vec2 at = p.xy * part.per_pitch.xy;
  float one = (word & kCoreTaxel) != 0 && weight > 0.0 ? 1.0 : 0.0;
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

// Adds the taxels 4 four to 4 four + 3.
void addFour(uint kind, Part part, uint four, vec3 middle, float force, Ridge ridge, inout PartSums sums) {
  vec4 weights = floatsOfFour(Forces, part.first_four + four);
  vec4 triggers = kind == kSumsForce ? floatsOfFour(Triggers, four) : vec4(0);
  uvec4 words = uvec4(0);
  if (REGIONS > 0 || kind == kSumsSecond) words = fourOf(TaxelRegions, part.first_four + four);
  [[unroll]] for (uint k = 0; k < 4u; ++k) addTaxel(kind, part, 4u * four + k, weights[k], triggers[k], words[k], middle, force, ridge, sums);
}

// Sums of one kind over all taxels of a part; every invocation of the team gets them. A partial sum has every LANES-th four of taxels.
PartSums sumPart(uint kind, Part part, vec3 middle, float force, Ridge ridge) {
  uint lane = gl_LocalInvocationIndex % TEAM;
  uint first_partial = gl_LocalInvocationIndex / TEAM * kMostSums * LANES;
  PartSums total = noSums();
  for (uint v = lane; v < LANES; v += TEAM) {
    PartSums sums = noSums();
    uint four = part.first / 4u + v;
    for (; 4u * four < part.end; four += LANES) addFour(kind, part, four, middle, force, ridge, sums);
    checkLoop(4u * four < part.end);
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
