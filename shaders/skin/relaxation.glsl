// Relaxation of the skin: a standard linear solid with RELAXATION terms under every sample; include/taxelsim/sensor.h, RelaxationTerm. Included by
// contact.comp, whose names it uses. Twin: src/reference/relaxation.cpp, which integrates over the whole past.
//
// Strain is measured by what the law gives an instantaneous press, P(d), Pa. A sample remembers its strain w and an overstress h of each term. A
// step of dt in which the strain goes straight from w to w' leaves h' = e h + c (w' - w) and
//   pressure = settled w' + sum h' = held + gain (w' - w),   held = settled w + sum e h,   gain = settled + sum c,
// with e = exp(-dt / time), c = fraction (time / dt) (1 - e), settled = 1 - sum fraction; exact for such a path (R. L. Taylor, K. S. Pister and
// G. L. Goudreau, Int. J. Numer. Methods Eng. 2, 45-59, 1970). An object that withdraws faster than the skin follows would have to pull: the skin
// leaves it and recovers to the strain without pressure, w' = w - held / gain, which is never negative.
//
// State of a tile: the rectangle of its taxels that objects have reached since reset (first row, end row, first col, end col, as floats); outside
// nothing is kept and all is 0. Then planes of TILE_SAMPLES words, w and one h after the other. A step rounds h by about 2^-24 of itself, so that a
// term whose time is more than some ten million steps stands still.

#include "skin/skin_step.glsl"

// A search over tiles tries offsets; its last pass, kSearchEnded, moves on.
const bool kAdvances = SEARCH != kSearchOverTiles;

struct SkinState {
  float strain;     // w, Pa
  vec4 overstress;  // e h, Pa
  float held;       // Pa
};

// Of this step and tile.
uint skin_first;     // word of its state
uvec4 skin_reached;  // before

void loadRelaxation(uint tile, bool is_new) {
  skin_first = tile * (kRelaxationHeader + (1u + RELAXATION) * TILE_SAMPLES);
  skin_reached = uvec4(0);
  if (!is_new) skin_reached = uvec4(state[skin_first], state[skin_first + 1], state[skin_first + 2], state[skin_first + 3]);
  loadSkinStep(is_new);
}

bool isReached(uvec2 taxel) { return all(greaterThanEqual(taxel, skin_reached.xz)) && all(lessThan(taxel, skin_reached.yw)); }

// `reached`: the sample's taxel was.
SkinState skinAt(uint address, bool reached) {
  SkinState skin = SkinState(0.0, vec4(0), 0.0);
  if (!reached) return skin;
  uint at = skin_first + kRelaxationHeader + address;
  vec4 h = vec4(0);
  skin.strain = state[at];
  h.x = state[at + TILE_SAMPLES];
  if (RELAXATION > 1) h.y = state[at + 2 * TILE_SAMPLES];
  if (RELAXATION > 2) h.z = state[at + 3 * TILE_SAMPLES];
  if (RELAXATION > 3) h.w = state[at + 4 * TILE_SAMPLES];
  skin.overstress = skin_fade * h + skin_fade_rest * h;
  skin.held = skin_settled * skin.strain + (skin.overstress.x + skin.overstress.y + skin.overstress.z + skin.overstress.w);
  return skin;
}

// Pa, where the law gives an instantaneous press `elastic`.
float relaxedPressure(SkinState skin, float elastic) {
  return elastic > 0.0 ? max(skin.held + skin_gain * (elastic - skin.strain), 0.0) : 0.0;
}

void keepSkin(uint address, SkinState skin, float elastic) {
  float strain = max(elastic, skin.strain - skin.held / skin_gain);
  vec4 h = skin.overstress + skin_growth * (strain - skin.strain);
  uint at = skin_first + kRelaxationHeader + address;
  state[at] = strain;
  state[at + TILE_SAMPLES] = h.x;
  if (RELAXATION > 1) state[at + 2 * TILE_SAMPLES] = h.y;
  if (RELAXATION > 2) state[at + 3 * TILE_SAMPLES] = h.z;
  if (RELAXATION > 3) state[at + 4 * TILE_SAMPLES] = h.w;
}

// Moves on the skin that was reached before but not in this step, whose taxels are `count` from `first` on.
void keepRestOfSkin(uvec2 first, uvec2 count) {
  uvec4 reached = skin_reached;
  if (reached.y == 0) reached = uvec4(first, first).xzyw;
  if (count.x > 0) reached = uvec4(min(reached.xz, first), max(reached.yw, first + count)).xzyw;
  uvec2 size = (reached.yw - reached.xz) * SAMPLES;
  uint k = gl_LocalInvocationIndex;
  for (; k < size.x * size.y; k += WORKGROUP) {
    uvec2 at = reached.xz * SAMPLES + cellNumbered(k, size.y);
    uvec2 taxel = at / SAMPLES;
    if (all(greaterThanEqual(taxel, first)) && all(lessThan(taxel, first + count))) continue;
    uint address = at.x * tile_stride + at.y;
    keepSkin(address, skinAt(address, isReached(taxel)), 0.0);
  }
  cut_short = cut_short || k < size.x * size.y;
  for (uint word = gl_LocalInvocationIndex; word < kRelaxationHeader; word += WORKGROUP) state[skin_first + word] = float(reached[word]);
}
