// Sums over the taxels of a part (features/contact_parts.glsl), in a fixed order. Forces in N, lengths in m. Reference:
// src/reference/contact_features.cpp.

const float kWindow = 1.15;  // standard deviation of the Gaussian window, pitches

const float kTaxelNumbers = 16777216.0;  // 2^24: floats hold all numbers of taxels below it

// Kind of sums of a scan over the taxels of a part: one of these, or kSumsWindow and one of the last two.
const uint kSumsForce = 1u;   // the largest force; force, first moments (3), area, number of taxels that report
const uint kSumsPeak = 2u;    // on lists of taxels: kTaxelNumbers less the first taxel with the largest force
const uint kSumsWindow = 4u;  // first (2) moments, force and second (3) moments about a point, weighted by a Gaussian window around it
const uint kSumsSecond = 8u;  // from kAfterWindow: first (3) and second (3) moments about the same point; the sums over core taxels
const uint kSumsRidge = 16u;  // from kAfterWindow: normal equations of a step of the fit of a ridge (features/ridge.glsl)

const uint kAfterWindow = 6u;

// With kSumsSecond, the sums over core taxels begin here: their number, first (2) and second (3) moments of their positions (pitches),
// forces less `force`, first moments (2) and squares of these.
const uint kCore = kAfterWindow + 6u;

bool has(uint kinds, uint kind) { return (kinds & kind) != 0u; }

uint numSums(uint kinds) {
  if (has(kinds, kSumsPeak)) return 1u;
  if (has(kinds, kSumsForce)) return 7u;
  return has(kinds, kSumsRidge) ? kMostSums : has(kinds, kSumsSecond) ? kCore + 10u : kAfterWindow;
}

// Whether the first value is the largest one instead of a sum.
bool hasLargest(uint kinds) { return has(kinds, kSumsForce | kSumsPeak); }

void addSums(uint kinds, inout PartSums total, PartSums more) {
  float largest = max(total.s[0], more.s[0]);
  for (uint k = 0; k < numSums(kinds); ++k) total.s[k] += more.s[k];
  if (hasLargest(kinds)) total.s[0] = largest;
}

// First two and second moments of a weight, from `first`; between them `between`.
void addMoments(uint first, float weight, float between, vec2 p, inout PartSums sums) {
  sums.s[first] += weight * p.x;
  sums.s[first + 1] += weight * p.y;
  sums.s[first + 2] += between;
  sums.s[first + 3] += weight * p.x * p.x;
  sums.s[first + 4] += weight * p.x * p.y;
  sums.s[first + 5] += weight * p.y * p.y;
}

// Adds a core taxel at `at` (pitches), whose force exceeds the mean force by `more`.
void addCore(float one, float more, vec2 at, inout PartSums sums) {
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

// Adds taxel `t`. `weight`: its force, N; `trigger`: that of its clean force, N; `word`: its word in taxel_regions. `middle`: the point of
// the moments, in C; `force`: the largest force (kSumsPeak) or the mean force (kSumsSecond), N.
void addTaxel(uint kinds, Part part, uint t, float weight, float trigger, uint word, vec3 middle, float force, Ridge ridge,
              inout PartSums sums) {
  bool is_in_range = t >= part.first && t < part.end, is_in = is_in_range && isOfRegion(part, word);
  t = min(t, NUM_TAXELS - 1u);
  if (has(kinds, kSumsRidge)) addToRidge(part, t, weight, is_in_range, is_in, ridge, kAfterWindow, sums);
  if (!is_in) weight = 0.0;
  if (has(kinds, kSumsPeak)) {
    if (weight == force) sums.s[0] = max(sums.s[0], kTaxelNumbers - float(t));
    return;
  }
  vec3 p = positionOf(part, t) - middle;
  if (has(kinds, kSumsForce)) {
    bool counts = is_in && reportsForce(weight, trigger);
    sums.s[0] = max(sums.s[0], weight);
    sums.s[1] += weight;
    sums.s[2] += weight * p.x;
    sums.s[3] += weight * p.y;
    sums.s[4] += weight * p.z;
    sums.s[5] += counts ? (kOnePatch ? PITCH_X * PITCH_Y : chartOf(t).w) : 0.0;
    sums.s[6] += counts ? 1.0 : 0.0;
  }
  if (has(kinds, kSumsWindow)) {
    float per_width = part.per_pitch.z * (1.0 / kWindow);
    float windowed = weight * exp(-0.5 * dot(p.xy, p.xy) * (per_width * per_width));
    addMoments(0, windowed, windowed, p.xy, sums);
  }
  if (!has(kinds, kSumsSecond)) return;
  addMoments(kAfterWindow, weight, weight * p.z, p.xy, sums);
  if (kList) return;
  float one = (word & kCoreTaxel) != 0 && weight > 0.0 ? 1.0 : 0.0;
  addCore(one, one * (weight - force), p.xy * part.per_pitch.xy, sums);
}

// Adds the taxels 4 four to 4 four + 3.
void addFour(uint kinds, Part part, uint four, vec3 middle, float force, Ridge ridge, inout PartSums sums) {
  vec4 weights = floatsOfFour(Forces, part.first_four + four);
  vec4 triggers = has(kinds, kSumsForce) ? floatsOfFour(Triggers, four) : vec4(0);
  uvec4 words = uvec4(0);
  if (REGIONS > 0 || has(kinds, kSumsSecond)) words = fourOf(TaxelRegions, part.first_four + four);
  [[unroll]] for (uint k = 0; k < 4u; ++k)
      addTaxel(kinds, part, 4u * four + k, weights[k], triggers[k], words[k], middle, force, ridge, sums);
}

// Sums of a scan over all taxels of a part; every invocation of the team gets them. A partial sum has every LANES-th four of taxels.
PartSums sumPart(uint kinds, Part part, vec3 middle, float force, Ridge ridge) {
  uint lane = gl_LocalInvocationIndex % TEAM;
  uint first_partial = gl_LocalInvocationIndex / TEAM * kMostSums * LANES;
  PartSums total = noSums();
  uint v = lane;
  do {
    PartSums sums = noSums();
    uint four = part.first / 4u + v;
    // The parts of one patch have the same range, so that the loop may test at its end (driver/loops.glsl).
    while (kOnePatch || 4u * four < part.end) {
      if (4u * four < part.end) addFour(kinds, part, four, middle, force, ridge, sums);
      four += LANES;
      if (kOnePatch && 4u * four >= NUM_TAXELS) break;
    }
    checkLoop(4u * four < part.end);
    if (TEAM == 1) {
      addSums(kinds, total, sums);
    } else {
      for (uint k = 0; k < numSums(kinds); ++k) partial[first_partial + k * LANES + v] = sums.s[k];
    }
    v += TEAM;
  } while (v < LANES);
  if (TEAM > 1) {
    barrier();
    for (uint v = 0; v < LANES; ++v) {
      PartSums sums = noSums();
      for (uint k = 0; k < numSums(kinds); ++k) sums.s[k] = partial[first_partial + k * LANES + v];
      addSums(kinds, total, sums);
    }
    barrier();
  }
  return total;
}

PartSums sumPart(uint kinds, Part part, vec3 middle, float force) { return sumPart(kinds, part, middle, force, noRidge()); }
