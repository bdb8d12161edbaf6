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
// State of a tile: kRelaxationHeader words, the rectangle of its taxels that objects have reached since reset (first row, end row, first col, end col, as
// floats), outside of which all is 0; then planes of TILE_SAMPLES words, w and one h after the other. A step rounds h by about 2^-24 of itself, so that a
// term whose time is more than some ten million steps does not change.

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
  uint first;     // index of the tile's state
  uvec4 reached;  // the rectangle of the state, before this step
};

// `tile_index`: over all instances.
TileSkin loadTileSkin(uint tile_index, bool is_new) {
  TileSkin tile_skin;
  tile_skin.first = tile_index * (kRelaxationHeader + (1u + RELAXATION) * TILE_SAMPLES);
  tile_skin.reached = uvec4(0);
  if (!is_new) {
    uint first = tile_skin.first;
    tile_skin.reached = uvec4(state[first], state[first + 1], state[first + 2], state[first + 3]);
  }
  tile_skin.step = skinStep(is_new);
  return tile_skin;
}

bool isReached(TileSkin tile_skin, uvec2 taxel) {
  return all(greaterThanEqual(taxel, tile_skin.reached.xz)) && all(lessThan(taxel, tile_skin.reached.yw));
}

// State of a sample. `reached`: the sample's taxel was.
SkinState skinAt(TileSkin tile_skin, uint address, bool reached) {
  SkinState skin = SkinState(0.0, vec4(0), 0.0);
  if (!reached) return skin;
  uint at = tile_skin.first + kRelaxationHeader + address;
  vec4 h = vec4(0);
  skin.strain = state[at];
  h.x = state[at + TILE_SAMPLES];
  if (RELAXATION > 1) h.y = state[at + 2 * TILE_SAMPLES];
  if (RELAXATION > 2) h.z = state[at + 3 * TILE_SAMPLES];
  if (RELAXATION > 3) h.w = state[at + 4 * TILE_SAMPLES];
  skin.overstress = tile_skin.step.fade * h + tile_skin.step.fade_rest * h;
  skin.held = tile_skin.step.settled * skin.strain + (skin.overstress.x + skin.overstress.y + skin.overstress.z + skin.overstress.w);
  return skin;
}

// Pressure, Pa, where the law gives `elastic` for an instantaneous press.
float relaxedPressure(TileSkin tile_skin, SkinState skin, float elastic) {
  return elastic > 0.0 ? max(skin.held + tile_skin.step.gain * (elastic - skin.strain), 0.0) : 0.0;
}

void updateSkin(TileSkin tile_skin, uint address, SkinState skin, float elastic) {
  float strain = max(elastic, skin.strain - skin.held / tile_skin.step.gain);
  vec4 h = skin.overstress + tile_skin.step.growth * (strain - skin.strain);
  uint at = tile_skin.first + kRelaxationHeader + address;
  state[at] = strain;
  state[at + TILE_SAMPLES] = h.x;
  if (RELAXATION > 1) state[at + 2 * TILE_SAMPLES] = h.y;
  if (RELAXATION > 2) state[at + 3 * TILE_SAMPLES] = h.z;
  if (RELAXATION > 3) state[at + 4 * TILE_SAMPLES] = h.w;
}

// Updates the skin that earlier steps have reached and this one has not, outside the `count` taxels from `first` on; and the rectangle of reached taxels.
void updateRestOfSkin(Tile tile, TileSkin tile_skin, uvec2 first, uvec2 count) {
  uvec4 reached = tile_skin.reached;
  if (reached.y == 0) reached = uvec4(first, first).xzyw;
  if (count.x > 0) reached = uvec4(min(reached.xz, first), max(reached.yw, first + count)).xzyw;
  uvec2 size = (reached.yw - reached.xz) * SAMPLES;
  uint k = gl_LocalInvocationIndex;
  for (; k < size.x * size.y; k += WORKGROUP) {
    uvec2 at = reached.xz * SAMPLES + cellNumbered(k, size.y);
    uvec2 taxel = at / SAMPLES;
    if (all(greaterThanEqual(taxel, first)) && all(lessThan(taxel, first + count))) continue;
    uint address = at.x * tile.stride + at.y;
    updateSkin(tile_skin, address, skinAt(tile_skin, address, isReached(tile_skin, taxel)), 0.0);
  }
  checkLoop(k < size.x * size.y);
  for (uint word = gl_LocalInvocationIndex; word < kRelaxationHeader; word += WORKGROUP) state[tile_skin.first + word] = float(reached[word]);
}
