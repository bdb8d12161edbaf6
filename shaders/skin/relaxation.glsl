// Relaxation of the skin: a standard linear solid with RELAXATION terms under every sample; include/taxelsim/sensor.h, RelaxationTerm.
// Stresses and strains in Pa. Twin: src/reference/relaxation.cpp, which integrates over the whole past.
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

#include "skin/skin_step.glsl"

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

// Taxel `k` of those in the rectangle `outer` that are not among the `count` taxels from `first` on, which lie in it: whole rows, then the
// rest of the others.
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
  const uint kGroups = SAMPLES * kFoursOfRow;  // of a taxel
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
