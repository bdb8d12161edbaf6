// Taxels that a polyhedron may touch, of those under its bounds: the others carry nothing and are passed over. Included by contact.comp, whose names it uses.
// A lane has its taxels, every LANES-th, as bits of a word, and takes them in the order in which it would take all: the sums are the same.

const uint kRounds = (NUM_ROWS * NUM_COLS + LANES - 1u) / LANES;
// No "||": Mesa 22.3 builds no pipeline with one in a constant expression.
const bool kPassesOver = LEAVE_UNTOUCHED && kOnlyPolyhedra && NUM_ROWS > 0 && NUM_TILES == 1 && kRounds <= 32 && !OUTPUT_JACOBIAN &&
                         !MANY_SLOTS && SEARCH != kSearchInTile && RELAXATION == 0 && !HAS_STATE && !kShears && !kLawSolvedApart;

// Those of `lane` in a rectangle of taxels, by lower bounds of both sides' heights over a taxel's samples, less what a sample's own height is rounded by;
// leaves all of them at 0.
uint touchedTaxels(uint lane, uvec2 first, uvec2 count, uint first_taxel) {
  const float kRounding = 1e-6;
  vec2 half_size = 0.5 * float(SAMPLES - 1u) * spacing;
  vec2 slack = half_size + kRounding * (abs(patch_corner) + spacing);
  float lows[FACES], highs[FACES];
  for (uint f = 0; f < FACES; ++f) {
    float fall = dot(abs(face_slopes[f]), slack);
    lows[f] = face_lows[f] - fall - kRounding * abs(face_lows[f]);
    highs[f] = face_highs[f] - fall - kRounding * abs(face_highs[f]);
  }
  uint touched = 0, bit = 1;
  for (uint k = lane; k < count.x * count.y; k += LANES) {
    uvec2 at = first + cellNumbered(k, count.y);
    uint taxel = first_taxel + at.x * grid.y + at.y;
    contact_normal[taxel] = 0.0;
    if (OUTPUT_DEPTH) contact_depth[taxel] = 0.0;
    vec2 middle = samplePosition(at * SAMPLES) + half_size;
    float low = -kMiss, minus_high = -kMiss;
    for (uint f = 0; f < FACES; ++f) {
      float rise = dot(face_slopes[f], middle);
      low = max(low, rise + lows[f]);
      minus_high = max(minus_high, rise + highs[f]);
    }
    if (low < z_limit && low <= -minus_high) touched |= bit;
    bit <<= 1;
  }
  return touched;
}

// Takes the next of a lane's taxels; past all of them where none is left.
uint nextTouched(inout uint touched, uint lane) {
  if (touched == 0) return 0x7FFFFFFFu;
  uint round = uint(findLSB(touched));
  touched &= touched - 1u;
  return lane + LANES * round;
}
