// Load search over one tile: the depth of the lowest sample at which the tile carries a load, by Newton's method from above; and the trial
// offsets of a search over several tiles (load.comp).
//
// A tile has the heights of samples up to a band over the lowest point of the objects' bounds. The search ends if the load is carried
// within it, else the next band is drawn, at last all heights: a light load touches few samples.
// Shared memory: 4 bytes.
// Reference: src/reference/load.cpp.

#include "common/instances.glsl"
#include "depth/heights.glsl"
#include "skin/law.glsl"
#include "skin/sample_states.glsl"

shared uint lowest_bits;  // height of the lowest sample; kEmpty at the start of a tile

struct Search {
  float depth;   // depth of the lowest sample, m
  float lowest;  // height of the lowest sample before the move, over Tile::z_base, m
  float offset;  // offset of the objects along z, m
  float status;  // kLoadCarried, kLoadOutOfReach, or kLoadSearching: in a wider band
};

const uint kNumBands = 4;

// Returns the first band for an object of this kind; with MANY_SLOTS, for the kinds of the model. The bounds of some kinds do not shrink
// with a band, so that the last band draws no more samples than a thin one.
uint firstBand(uint kind) {
  const uint kUnshrunk = 1u << kKindBox | 1u << kKindHalfSpace | 1u << kKindCone | 1u << kKindTorus | 1u << kKindPolyhedron;
  uint kinds = MANY_SLOTS ? OBJECT_KINDS : 1u << kind;
  return (OBJECT_KINDS & kUnshrunk) != 0 && (kinds & kUnshrunk) != 0 ? kNumBands - 1u : 0u;
}

// Sets Tile::z_limit to a band and returns the number of the next one. Band 0 is thin and begins at `lowest_bound`, the lower bound of the
// objects. Bands 1 (thin) and 2 (thick) begin at the skin, because callers put the lowest point of a tilted object there, above its lower
// bound. Band 3 has all heights.
uint setBand(inout Tile tile, float lowest_bound, uint number) {
  const float kThin = THICKNESS / 8.0, kThick = THICKNESS / 2.0;
  float touch = number == 0 ? lowest_bound : max(lowest_bound, 0.0);
  tile.z_limit = number + 1u < kNumBands ? touch + (number + 2u < kNumBands ? kThin : kThick) : kNoHeight;
  if (OUTPUT_JACOBIAN && number + 1u < kNumBands) tile.z_limit += cellReach(tile);
  return number == 0 && lowest_bound > -0.5 * kThin ? 2u : number + 1u;
}

// Empties the tile for the next band. All invocations call it.
void clearForNextBand(Tile tile, Box samples) {
  workgroupBarrier();
  clearSamples(tile, samples);
  if (gl_LocalInvocationIndex == 0) {
    startBoxes();
    lowest_bits = kEmpty;
  }
  workgroupBarrier();
}

bool hasAllHeights(Tile tile) { return tile.z_limit >= kNoHeight; }

// Returns the largest depth of the lowest sample for which the tile has all samples that press. `lowest`: height of that sample over
// Tile::z_base.
float mostDepth(Tile tile, float lowest) {
  const float kRounding = 1e-7;  // m, of heights and of the limit
  if (hasAllHeights(tile)) return THICKNESS;
  return min(THICKNESS, tile.z_limit - (OUTPUT_JACOBIAN ? cellReach(tile) : 0.0) - tile.z_base - lowest - kRounding);
}

uint addressOf(Tile tile, uvec2 at) { return at.x * tile.stride + at.y; }

// Finds the lowest of the `count` samples from `first` on; kEmpty without any. All invocations call it.
uint lowestSample(Tile tile, uvec2 first, uvec2 count) {
  uint total = count.x * count.y;
  uint lane_lowest = kEmpty;
  for (uint i = gl_LocalInvocationIndex; i < total; i += WORKGROUP) {
    lane_lowest = min(lane_lowest, tile_heights[addressOf(tile, first + cellNumbered(i, count.y))]);
  }
  atomicMin(lowest_bits, lane_lowest);
  workgroupBarrier();
  return lowest_bits;
}

// Force (N) of the samples, and its derivative by the depth (N/m), when the lowest sample is at `depth`. Only z moves: the gaps between the
// samples stay.
vec2 forceAtDepth(Tile tile, TileSkin tile_skin, float depth, float lowest, uvec2 first, uvec2 count) {
  uint total = count.x * count.y;
  for (uint v = gl_LocalInvocationIndex; v < LANES; v += WORKGROUP) {
    float force = 0.0, slope = 0.0;
    uint i = v;
    for (; i < total; i += LANES) {
      uvec2 at = first + cellNumbered(i, count.y);
      uint address = addressOf(tile, at);
      float d = depth - (withoutSlot(tile_heights[address]) - lowest);
      float f = lawPressure(d, 0.0), f_slope = lawSlope(d);
      if (RELAXATION > 0) {
        uvec2 taxel = at / SAMPLES, in_taxel = at - taxel * SAMPLES;
        SkinStates states = readSkin(statesOf(tile, tile_skin.state, taxel, in_taxel.x, in_taxel.y / 4u));
        f = relaxedPressure(tile_skin, skinAt(tile_skin, states, in_taxel.y % 4u, isReached(tile_skin, taxel)), f);
        f_slope = f > 0.0 ? tile_skin.step.gain * f_slope : 0.0;
      }
      force += f;
      slope += f_slope;
    }
    checkLoop(i < total);
    setPartial(v, vec4(force, slope, 0, 0) * tile.force_area);
  }
  return sumOfPartials().xy;
}

// `load`: N. The samples are `count` from `first` on.
Search searchLoad(Tile tile, TileSkin tile_skin, float load, uvec2 first, uvec2 count) {
  const int kMaxIterations = 32;
  const float kTolerance = 2e-6;  // share of the load; some ten roundings of a float
  Search found = Search(0.0, 0.0, 0.0, hasAllHeights(tile) ? kLoadOutOfReach : kLoadSearching);
  uint lowest = lowestSample(tile, first, count);
  if (lowest == kEmpty) return found;
  found.lowest = withoutSlot(lowest);
  float most = mostDepth(tile, found.lowest);
  if (most <= 0.0) return found;
  found.depth = most;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    vec2 sums = forceAtDepth(tile, tile_skin, found.depth, found.lowest, first, count);
    float excess = sums.x - load;
    if (iteration == 0 && excess < -kTolerance * load) break;  // even this depth carries less
    found.status = kLoadCarried;
    if (RELAXATION > 0 && load > 0.0 && sums.y <= 0.0) found.status = kLoadOutOfReach;  // lost in the rounding of a much deeper dent
    if (abs(excess) <= kTolerance * load || sums.y <= 0.0) break;
    found.depth = clamp(found.depth - excess / sums.y, 0.0, most);
  }
  if (RELAXATION == 0 && load == 0.0) found.depth = 0.0;  // with relaxation: at the bottom of a dent
  found.offset = -found.depth - (tile.z_base + found.lowest);
  return found;
}

// ---- search over tiles: a trial needs stage 1 and the law like every frame, so it is a variant of the pass and no module of its own ----

// Loads a tile. False when the load search of its instance has ended, and for an instance that is held or of another dispatch: its results
// stay. An instance without an object is processed as if it had the first of the model.
bool beginTile(uint instance, uint tile_number, out Tile tile) {
  tile = loadTile(tile_number);
  tile.z_base = -THICKNESS;
  if (isHeld(instance)) return false;
  if (SELECTS_KINDS && (OBJECT_KINDS & (1u << objectOf(max(objectInSlot(instance), 0)).kind_groups.x)) == 0) return false;
  if (RANDOM_SKIN) tile.force_area *= instanceRecord(instance).skin.x;
  if (SEARCH == kSearchInTile && (instanceRecord(instance).keys.w & kFlagLoadDriven) != 0) tile.z_limit = kNoHeight;
  if (SEARCH == kSearchOverTiles) {
    float status = loads[instance].bracket.w;
    if (status == kLoadCarried || status == kLoadOutOfReach) return false;
  }
  if (SEARCH >= kSearchOverTiles && (instanceRecord(instance).keys.w & kFlagLoadDriven) != 0) {
    tile.offset_z = loads[instance].bracket.x;
    tile.level = -loads[instance].forces.z * tile.X_PS.row2.z;
    tile.z_base += tile.level;
    tile.z_limit += tile.level;
  }
  return true;
}
