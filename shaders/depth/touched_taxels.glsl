// The taxels under the bounds of a polyhedron or a round solid that it may touch; the others carry no force and are skipped. A lane keeps
// its taxels, every LANES-th, as bits of a word and processes them in the order of all taxels, so that the sums are the same. Reads the
// planes of depth/polyhedron.glsl.

const uint kRounds = (NUM_ROWS * NUM_COLS + LANES - 1u) / LANES;
const bool kHasBounds = EITHER(kOnlyPolyhedra, kOnlyRound);
const bool kSkipsTaxels = EARLY_EXIT && kHasBounds && NUM_ROWS > 0 && NUM_TILES == 1 && kRounds <= 32 && !MANY_SLOTS &&
                          SEARCH != kSearchInTile && SEARCH != kSearchEnded && RELAXATION == 0;

void writeShear(uint taxel, vec2 shear) {
  contact_shear[2 * taxel] = shear.x;
  contact_shear[2 * taxel + 1] = shear.y;
}

// Taxels of `lane` in a rectangle of taxels that the only object may touch: a polyhedron by lower bounds of the heights of both sides over
// a taxel's samples, less the rounding of a sample's height, a round solid by its `part`. Clears the outputs of all of them. `tile_state`:
// where the states of the tile's samples begin.
uint touchedTaxels(Tile tile, uint tile_state, uint lane, uvec2 first, uvec2 count, uint first_taxel, RoundPart part) {
  const float kRounding = 1e-6;
  vec2 half_size = 0.5 * float(SAMPLES - 1u) * tile.spacing;
  vec2 slack = half_size + kRounding * (abs(tile.corner) + tile.spacing);
  float lows[NUM_FACES], highs[NUM_FACES];
  for (uint f = 0; kOnlyPolyhedra && f < NUM_FACES; ++f) {
    float fall = dot(abs(face_slopes[f]), slack);
    lows[f] = face_lows[f] - fall - kRounding * abs(face_lows[f]);
    highs[f] = face_highs[f] - fall - kRounding * abs(face_highs[f]);
  }
  uint touched = 0, bit = 1;
  uint k = lane, num_taxels = count.x * count.y;
  if (num_taxels > 0) do {
      if (k < num_taxels) {
        uvec2 at = first + cellNumbered(k, count.y);
        uint taxel = first_taxel + at.x * tile.grid.y + at.y;
        contact_normal[taxel] = 0.0;
        if (OUTPUT_SHEAR) writeShear(taxel, vec2(0));
        if (OUTPUT_DEPTH) contact_depth[taxel] = 0.0;
        if (OUTPUT_JACOBIAN) clearCell(taxel);
        vec2 middle = samplePosition(tile, at * SAMPLES) + half_size;
        float low = -kMiss, minus_high = -kMiss;
        for (uint f = 0; kOnlyPolyhedra && f < NUM_FACES; ++f) {
          float rise = dot(face_slopes[f], middle);
          low = max(low, rise + lows[f]);
          minus_high = max(minus_high, rise + highs[f]);
        }
        bool near =
            kOnlyPolyhedra ? low < tile.z_limit && low <= -minus_high : reachesInto(part, middle, half_size + kSampleReach * tile.spacing);
        if (near) touched |= bit;
        if (kMarksStates && !near) markWithoutStates(tile, tile_state, at);
        bit <<= 1;
      }
      k += LANES;
    } while (k - lane < num_taxels);
  return touched;
}

// Removes and returns the next of a lane's taxels; a number past all of them where none is left.
uint nextTouched(inout uint touched, uint lane) {
  if (touched == 0) return 0x7FFFFFFFu;
  uint round = uint(findLSB(touched));
  touched &= touched - 1u;
  return lane + LANES * round;
}
