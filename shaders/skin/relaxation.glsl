// Relaxation of the skin: a standard linear solid with RELAXATION terms under every sample; include/taxelsim/sensor.h, RelaxationTerm. Stresses and strains in
// Pa. Twin: src/reference/relaxation.cpp, which integrates over the whole past.
//
// Strain is measured by the pressure that the law gives for an instantaneous press, P(d). A sample keeps its strain w and an overstress h per term. A
// step of dt in which the strain goes straight from w to w' leaves h' = e h + c (w' - w) and
//   pressure = settled w' + sum h' = held + gain (w' - w),   held = settled w + sum e h,   gain = settled + sum c,
// with e = exp(-dt / time), c = fraction (time / dt) (1 - e), settled = 1 - sum fraction; exact for such a path (R. L. Taylor, K. S. Pister and
// G. L. Goudreau, Int. J. Numer. Methods Eng. 2, 45-59, 1970). An object that withdraws faster than the skin recovers would have to pull: it loses contact,
// and the skin recovers to the strain without pressure, w' = w - held / gain, which is never negative.
//
// States of a sample: w, then one h after the other. A step rounds h by about 2^-24 of itself, so that a term whose time is more than some ten million steps
// does not change.

#include "skin/skin_step.glsl"

// A search over tiles evaluates offsets that it may reject; only its last pass, kSearchEnded, updates the state.
const bool kUpdatesSkin = SEARCH != kSearchOverTiles;

struct SkinState {
  float strain;     // w
  vec4 overstress;  // e h
  float held;
};

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
SkinState skinAt(TileSkin tile_skin, SampleStates states, uint i, bool reached) {
  vec4 h = vec4(0);
  for (uint term = 0; term < RELAXATION; ++term) h[term] = reached ? uintBitsToFloat(states.words[1u + term][i]) : 0.0;
  SkinState skin;
  skin.strain = reached ? uintBitsToFloat(states.words[0][i]) : 0.0;
  skin.overstress = tile_skin.step.fade * h + tile_skin.step.fade_rest * h;
  skin.held = tile_skin.step.settled * skin.strain + (skin.overstress.x + skin.overstress.y + skin.overstress.z + skin.overstress.w);
  return skin;
}

// Pressure, Pa, where the law gives `elastic` for an instantaneous press.
float relaxedPressure(TileSkin tile_skin, SkinState skin, float elastic) {
  return elastic > 0.0 ? max(skin.held + tile_skin.step.gain * (elastic - skin.strain), 0.0) : 0.0;
}

void updateSkin(TileSkin tile_skin, inout SampleStates states, uint i, SkinState skin, float elastic) {
  float strain = max(elastic, skin.strain - skin.held / tile_skin.step.gain);
  vec4 h = skin.overstress + tile_skin.step.growth * (strain - skin.strain);
  states.words[0][i] = floatBitsToUint(strain);
  for (uint term = 0; term < RELAXATION; ++term) states.words[1u + term][i] = floatBitsToUint(h[term]);
}

// Updates the skin that earlier steps have reached and this one has not, outside the `count` taxels from `first` on; and the rectangle of reached taxels.
void updateRestOfSkin(Tile tile, TileSkin tile_skin, uvec2 first, uvec2 count) {
  uvec4 reached = tile_skin.reached;
  if (reached.y == 0) reached = uvec4(first, first).xzyw;
  if (count.x > 0) reached = uvec4(min(reached.xz, first), max(reached.yw, first + count)).xzyw;
  uvec2 size = reached.yw - reached.xz;
  const uint kGroups = SAMPLES * kFoursOfRow;  // of a taxel
  uint k = gl_LocalInvocationIndex;
  for (; k < size.x * size.y * kGroups; k += WORKGROUP) {
    uint group = k % kGroups;
    uvec2 taxel = reached.xz + cellNumbered(k / kGroups, size.y);
    if (all(greaterThanEqual(taxel, first)) && all(lessThan(taxel, first + count))) continue;
    uint at = statesOf(tile, tile_skin.state, taxel, group / kFoursOfRow, group % kFoursOfRow);
    SampleStates states = readStates(at);
    bool is_reached = isReached(tile_skin, taxel);
    for (uint i = 0; i < 4u; ++i) updateSkin(tile_skin, states, i, skinAt(tile_skin, states, i, is_reached), 0.0);
    writeStates(at, states);
  }
  checkLoop(k < size.x * size.y * kGroups);
  writeRectangle(tile_skin.state, kReachedTaxels, reached);
}
