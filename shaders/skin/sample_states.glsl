// State of samples between steps, in NUM_STATES words each: strain and overstresses of a skin that relaxes (below), shear of each of their
// points (skin/friction.glsl), and the depth for a law with damping.
//
// Four samples of a row keep a word each in one element of four words: these are loaded at once (driver/texels.glsl). State of a tile: a
// rectangle of taxels whose shear and depth the step before has stored; one of taxels that objects have reached since reset (first row, end
// row, first col, end col, of the tile); then NUM_STATES elements per taxel, row of samples and four samples. Samples outside of these
// rectangles have no state. PastState is State. An invocation fetches the states of samples before it stores them, and no other invocation
// stores them.

#include "driver/loops.glsl"
#include "depth/tile.glsl"
#include "skin/skin_step.glsl"

const uint kNumRelaxationStates = RELAXATION > 0 ? 1u + RELAXATION : 0u;
const uint kShearStates = kNumRelaxationStates;  // first of them; x and y of each point
const uint kDepthState = NUM_STATES - 1u;
const uint kFoursOfRow = (SAMPLES + 3u) / 4u;
const bool kStoresTouched = FRICTION || HAS_STATE;  // states of the touched samples only

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
uint markIndex(Tile tile, uint tile_state, uvec2 taxel) {
  return statesOf(tile, tile_state, taxel, 0, 0) + (FRICTION ? kShearStates : kDepthState);
}
void markWithoutStates(Tile tile, uint tile_state, uvec2 taxel) { state[markIndex(tile, tile_state, taxel)].x = kWithoutStates; }
bool hasStates(Tile tile, uint tile_state, uvec2 taxel) {
  if (!kMarksStates) return true;
  return fourOf(PastState, markIndex(tile, tile_state, taxel)).x != kWithoutStates;
}

const uint kTouchedTaxels = 0u, kReachedTaxels = 1u;  // elements of the header

// `is_new`: in the first step since reset there are no states.
uvec4 readRectangle(uint tile_state, uint which, bool is_new) { return is_new ? uvec4(0) : fourOf(PastState, tile_state + which); }

// Called by all invocations.
void writeRectangle(uint tile_state, uint which, uvec4 rectangle) {
  for (uint k = gl_LocalInvocationIndex; k < 4u; k += WORKGROUP) state[tile_state + which][k] = rectangle[k];
}

// ---- shear ----

// States of shear of four samples, at the first and the second of their points.
struct ShearStates {
  uvec4 x_0, y_0, x_1, y_1;
};

// `first`: statesOf() the samples of a taxel that the step before has `touched`, or has not.
ShearStates readShears(uint first, bool touched) {
  ShearStates states =
      ShearStates(fourOf(PastState, first + kShearStates), fourOf(PastState, first + kShearStates + 1u), uvec4(0), uvec4(0));
  if (VARIATION) states.x_1 = fourOf(PastState, first + kShearStates + 2u);
  if (VARIATION) states.y_1 = fourOf(PastState, first + kShearStates + 3u);
  states.x_0 = mix(uvec4(kNoFrictionState), states.x_0, bvec4(touched));
  states.x_1 = mix(uvec4(kNoFrictionState), states.x_1, bvec4(touched));
  return states;
}

void writeShears(uint first, ShearStates states) {
  state[first + kShearStates] = states.x_0;
  state[first + kShearStates + 1u] = states.y_0;
  if (VARIATION) state[first + kShearStates + 2u] = states.x_1;
  if (VARIATION) state[first + kShearStates + 3u] = states.y_1;
}

// ---- relaxation ----
//
// Relaxation of the skin: a standard linear solid with RELAXATION terms under every sample; include/taxelsim/sensor.h, RelaxationTerm.
// Stresses and strains in Pa. Reference: src/reference/relaxation.cpp, which integrates over the whole past.
//
// Strain is measured by the pressure that the law gives for an instantaneous press, P(d). A sample keeps its strain w and an overstress h
// per term. A step of dt in which the strain goes straight from w to w' leaves h' = e h + c (w' - w) and
//   pressure = settled w' + sum h' = held + gain (w' - w),   held = settled w + sum e h,   gain = settled + sum c,
// with e = exp(-dt / time), c = fraction (time / dt) (1 - e), settled = 1 - sum fraction; exact for such a path (R. L. Taylor, K. S. Pister
// and G. L. Goudreau, Int. J. Numer. Methods Eng. 2, 45-59, 1970). An object that withdraws faster than the skin recovers would have to
// pull: it loses contact, and the skin recovers to the strain without pressure, w' = w - held / gain, which is never negative.
//
// States of a sample: w, then one h after the other. A step rounds h by about 2^-24 of itself, so that a term whose time is more than some
// ten million steps does not change.

// A search over tiles evaluates offsets that it may reject; only its last pass, kSearchEnded, updates the state.
const bool kUpdatesSkin = SEARCH != kSearchOverTiles;

struct SkinState {
  float strain;     // w
  vec4 overstress;  // e h
  float held;
};

// States of four samples, by members instead of an array, whose elements some compilers keep in memory.
struct SkinStates {
  uvec4 strain, overstress_0, overstress_1, overstress_2, overstress_3;
};

// `first`: statesOf().
SkinStates readSkin(uint first) {
  SkinStates states = SkinStates(fourOf(PastState, first), fourOf(PastState, first + 1u), uvec4(0), uvec4(0), uvec4(0));
  if (RELAXATION > 1) states.overstress_1 = fourOf(PastState, first + 2u);
  if (RELAXATION > 2) states.overstress_2 = fourOf(PastState, first + 3u);
  if (RELAXATION > 3) states.overstress_3 = fourOf(PastState, first + 4u);
  return states;
}

void writeSkin(uint first, SkinStates states) {
  state[first] = states.strain;
  state[first + 1u] = states.overstress_0;
  if (RELAXATION > 1) state[first + 2u] = states.overstress_1;
  if (RELAXATION > 2) state[first + 3u] = states.overstress_2;
  if (RELAXATION > 3) state[first + 4u] = states.overstress_3;
}

// The skin of a tile in one step.
struct TileSkin {
  SkinStep step;
  uint state;     // stateStart()
  uvec4 reached;  // the rectangle of the state, before this step
};

TileSkin loadTileSkin(uint tile_state, bool is_new) {
  TileSkin tile_skin;
  tile_skin.state = tile_state;
  tile_skin.reached = readRectangle(tile_state, kReachedTaxels, is_new);
  tile_skin.step = skinStep(is_new);
  return tile_skin;
}

bool isReached(TileSkin tile_skin, uvec2 taxel) { return isInside(taxel, tile_skin.reached); }

// Skin of sample `i` of `states`. `reached`: the sample's taxel was.
SkinState skinAt(TileSkin tile_skin, SkinStates states, uint i, bool reached) {
  uvec4 words = uvec4(component(states.overstress_0, i), component(states.overstress_1, i), component(states.overstress_2, i),
                      component(states.overstress_3, i));
  vec4 h = uintBitsToFloat(mix(uvec4(0), words, bvec4(reached)));
  SkinState skin;
  skin.strain = uintBitsToFloat(reached ? component(states.strain, i) : 0u);
  skin.overstress = tile_skin.step.fade * h + tile_skin.step.fade_rest * h;
  skin.held = tile_skin.step.settled * skin.strain + (skin.overstress.x + skin.overstress.y + skin.overstress.z + skin.overstress.w);
  return skin;
}

// Pressure, Pa, where the law gives `elastic` for an instantaneous press.
float relaxedPressure(TileSkin tile_skin, SkinState skin, float elastic) {
  return elastic > 0.0 ? max(skin.held + tile_skin.step.gain * (elastic - skin.strain), 0.0) : 0.0;
}

void updateSkin(TileSkin tile_skin, inout SkinStates states, uint i, SkinState skin, float elastic) {
  float strain = max(elastic, skin.strain - skin.held / tile_skin.step.gain);
  vec4 h = skin.overstress + tile_skin.step.growth * (strain - skin.strain);
  states.strain = withComponent(states.strain, i, floatBitsToUint(strain));
  states.overstress_0 = withComponent(states.overstress_0, i, floatBitsToUint(h.x));
  states.overstress_1 = withComponent(states.overstress_1, i, floatBitsToUint(h.y));
  states.overstress_2 = withComponent(states.overstress_2, i, floatBitsToUint(h.z));
  states.overstress_3 = withComponent(states.overstress_3, i, floatBitsToUint(h.w));
}

// Relaxed pressure (Pa) of sample `i`, and updates its skin.
float relax(TileSkin tile_skin, inout SkinStates states, uint i, bool reached, float elastic) {
  SkinState skin = skinAt(tile_skin, states, i, reached);
  if (kUpdatesSkin) updateSkin(tile_skin, states, i, skin, elastic);
  return relaxedPressure(tile_skin, skin, elastic);
}

// Taxel `k` of the rectangle `outer` without the `count` taxels from `first` on, which lie in it: whole rows first, then the rest.
uvec2 taxelOutside(uvec4 outer, uvec2 first, uvec2 count, uint k) {
  uvec2 size = outer.yw - outer.xz, before = first - outer.xz;
  uint in_rows = (size.x - count.x) * size.y;
  uvec2 of_rows = cellNumbered(k, size.y), of_rest = cellNumbered(k - in_rows, max(size.y - count.y, 1u));
  if (of_rows.x >= before.x) of_rows.x += count.x;
  of_rest.x += before.x;
  if (of_rest.y >= before.y) of_rest.y += count.y;
  return outer.xz + mix(of_rest, of_rows, bvec2(k < in_rows));
}

// Updates the skin that earlier steps have reached and this one has not, outside the `count` taxels from `first` on; and the rectangle of
// reached taxels.
void updateRestOfSkin(Tile tile, TileSkin tile_skin, uvec2 first, uvec2 count) {
  uvec4 reached = tile_skin.reached;
  if (reached.y == 0) reached = uvec4(first, first).xzyw;
  if (count.x > 0) reached = uvec4(min(reached.xz, first), max(reached.yw, first + count)).xzyw;
  uvec2 size = reached.yw - reached.xz;
  uint num_taxels = size.x * size.y - count.x * count.y;
  const uint kGroups = SAMPLES * kFoursOfRow;  // groups of four samples of a taxel
  uint k = gl_LocalInvocationIndex;
  for (; k < num_taxels * kGroups; k += WORKGROUP) {
    uint group = k % kGroups;
    uvec2 taxel = taxelOutside(reached, first, count, k / kGroups);
    uint at = statesOf(tile, tile_skin.state, taxel, group / kFoursOfRow, group % kFoursOfRow);
    SkinStates states = readSkin(at);
    bool is_reached = isReached(tile_skin, taxel);
    for (uint i = 0; i < 4u; ++i) updateSkin(tile_skin, states, i, skinAt(tile_skin, states, i, is_reached), 0.0);
    writeSkin(at, states);
  }
  checkLoop(k < num_taxels * kGroups);
  writeRectangle(tile_skin.state, kReachedTaxels, reached);
}

// All states of four samples.
struct SampleStates {
  SkinStates skin;
  ShearStates shear;
  uvec4 depths;
};

// `first`: statesOf(). `touched`: the step before has touched the taxel.
SampleStates readStates(uint first, bool touched) {
  SampleStates states;
  if (RELAXATION > 0) states.skin = readSkin(first);
  if (FRICTION) states.shear = readShears(first, touched);
  if (HAS_STATE) states.depths = mix(uvec4(0), fourOf(PastState, first + kDepthState), bvec4(touched));
  return states;
}

void writeStates(uint first, SampleStates states) {
  if (RELAXATION > 0 && kUpdatesSkin) writeSkin(first, states.skin);
  if (FRICTION) writeShears(first, states.shear);
  if (HAS_STATE) state[first + kDepthState] = states.depths;
}
