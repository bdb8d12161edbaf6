// What samples keep between steps, in NUM_STATES words each: strain and overstresses of a skin that relaxes (skin/relaxation.glsl), the
// shear of each of their points (skin/friction.glsl), and the depth for a law with damping.
//
// Four samples of a row keep a word each in one element of four words: these are loaded at once (driver/texels.glsl). State of a tile: a
// rectangle of taxels whose shear and depth the step before has stored; one of taxels that objects have reached since reset (first row, end
// row, first col, end col, of the tile); then NUM_STATES elements per taxel, row of samples and four samples. Samples outside of these
// rectangles have no state. PastState is State. An invocation fetches the states of samples before it stores them, and no other invocation
// stores them.

const uint kNumRelaxationStates = RELAXATION > 0 ? 1u + RELAXATION : 0u;
const uint kShearStates = kNumRelaxationStates;  // first of them; x and y of each point
const uint kDepthState = NUM_STATES - 1u;
const uint kFoursOfRow = (SAMPLES + 3u) / 4u;
const bool kStoresTouched = kShears || HAS_STATE;  // states of the touched samples only

// `four` with another component `i`; by selection, as component() in driver/texels.glsl.
uvec4 withComponent(uvec4 four, uint i, uint value) { return mix(four, uvec4(value), equal(uvec4(0, 1, 2, 3), uvec4(i))); }

uint stateStart(uint tile_index) { return tile_index * (kStateHeader + TILE_SAMPLES / SAMPLES * kFoursOfRow * NUM_STATES); }

// Where the states of the samples `4 four` to `4 four + 3` in the `row`th row of a taxel begin.
uint statesOf(Tile tile, uint tile_state, uvec2 taxel, uint row, uint four) {
  return tile_state + kStateHeader + (((taxel.x * tile.size.y + taxel.y) * SAMPLES + row) * kFoursOfRow + four) * NUM_STATES;
}

// A taxel of the touched rectangle that no object touched may have a mark instead of states, as the first word of its shear or else of its
// depths.
const bool kMarksStates = kStoresTouched && EARLY_EXIT && RELAXATION == 0 && NUM_ROWS > 0 && NUM_TILES == 1;
const uint kWithoutStates = 0x7FFFFFFFu;
uint placeOfMark(Tile tile, uint tile_state, uvec2 taxel) {
  return statesOf(tile, tile_state, taxel, 0, 0) + (kShears ? kShearStates : kDepthState);
}
void markWithoutStates(Tile tile, uint tile_state, uvec2 taxel) { state[placeOfMark(tile, tile_state, taxel)].x = kWithoutStates; }
bool hasStates(Tile tile, uint tile_state, uvec2 taxel) {
  if (!kMarksStates) return true;
  return fourOf(PastState, placeOfMark(tile, tile_state, taxel)).x != kWithoutStates;
}

const uint kTouchedTaxels = 0u, kReachedTaxels = 1u;  // elements of the header

// `is_new`: in the first step since reset there are no states.
uvec4 readRectangle(uint tile_state, uint which, bool is_new) { return is_new ? uvec4(0) : fourOf(PastState, tile_state + which); }

// Called by all invocations.
void writeRectangle(uint tile_state, uint which, uvec4 rectangle) {
  for (uint k = gl_LocalInvocationIndex; k < 4u; k += WORKGROUP) state[tile_state + which][k] = rectangle[k];
}
