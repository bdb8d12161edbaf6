// Stage 2 of the contact pass: from the heights over the samples of a tile to one force per taxel (N) and a wrench, by the law
// (skin/law.glsl), relaxation and friction.
//
// In:  heights of the tile or of one solid (depth/heights.glsl).
// Out: contact_normal, contact_depth, contact_shear, contact_cells, tile_changes; partial sums of the wrench; num_deep and any_behind.
// Shared memory: 4 bytes.
// References: src/reference/contact.cpp, relaxation.cpp, friction.cpp, lugre.cpp.

#include "skin/tile_outputs.glsl"

// ---- touched taxels ----
//
// Taxels under the bounds of a polyhedron or a round solid that the object may touch; the others carry no force and are skipped. A lane
// keeps its taxels, every LANES-th, as bits of a word and processes them in the order of all taxels, so that the sums are the same. Reads
// the planes of depth/solids.glsl.

shared uint most_touched;  // taxels of any lane that kSkipsTaxels leaves

const uint kRounds = (NUM_ROWS * NUM_COLS + LANES - 1u) / LANES;
const bool kHasBounds = EITHER(kOnlyPolyhedra, kOnlyRound);
const bool kSkipsTaxels = EARLY_EXIT && kHasBounds && NUM_ROWS > 0 && NUM_TILES == 1 && kRounds <= 32 && !MANY_SLOTS &&
                          SEARCH != kSearchInTile && SEARCH != kSearchEnded && RELAXATION == 0;

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
        float low = -kNoHeight, minus_high = -kNoHeight;
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

// Rounds that all lanes take together: the most that a lane needs for its part of the `num_active` taxels. `touched`: taxels of this lane,
// with kSkipsTaxels.
uint numRounds(uint touched, uint num_active) {
  if (!kSkipsTaxels) return (num_active + LANES - 1u) / LANES;
  if (kInRegisters) return largestOverVector(uint(bitCount(touched)));
  atomicMax(most_touched, uint(bitCount(touched)));
  workgroupBarrier();
  uint most = most_touched;
  if (WORKGROUP < LANES) workgroupBarrier();
  return most;
}

// ---- pressures ----

// Per-tile values shared by all taxels while their samples are summed.
struct TileStep {
  uint instance;
  uint result;         // index of the tile over all instances
  uint first_taxel;    // first taxel of the patch, over all instances
  bool load_driven;    // the load search has ended in this pass
  bool at_rest;        // no depth rate: the first step, or an instance driven by its load
  float per_dt;        // 1 / the step's time, 1/s, for laws that need it
  Search found;        // result of that search
  float surface;       // depth where the tile's height is 0, m
  uint state;          // where the states of the tile's samples begin, skin/sample_states.glsl
  uvec4 touched;       // taxels whose samples have states of shear and depth
  TileSkin skin;       // that relaxes
  Motion only_motion;  // motion of the object in the only slot
  float friction;      // the instance's factor on friction
  OnlyObject only;     // the object of a pass without a tile
  RoundPart part;      // its part within reach, with kOnlyRound
};

// Runs the load search of this tile and loads the states of relaxation and friction.
TileStep beginPressures(Tile tile, uint instance, uint tile_number, uint num_slots, Reach reach, ActiveTaxels taxels, bool load_driven,
                        bool search_here) {
  TileStep step;
  step.instance = instance;
  step.result = instance * NUM_TILES + tile_number;
  step.first_taxel = instance * NUM_TAXELS + tile.grid.z;
  step.load_driven = search_here;
  bool is_first = (instanceRecord(instance).keys.w & kFlagFirstStep) != 0;
  step.at_rest = is_first || load_driven;
  step.state = stateStart(step.result);
  step.touched = kStoresTouched ? readRectangle(step.state, kTouchedTaxels, is_first) : uvec4(0);
  if (RELAXATION > 0) step.skin = loadTileSkin(step.state, is_first);
  step.found = Search(0.0, 0.0, 0.0, search_here && !hasAllHeights(tile) ? kLoadSearching : kLoadOutOfReach);
  if (SEARCH == kSearchInTile && search_here) {
    if (taxels.count.x * taxels.count.y > 0) {
      step.found = searchLoad(tile, step.skin, instanceRecord(instance).drive.x, taxels.first * SAMPLES, taxels.count * SAMPLES);
    }
    if (gl_LocalInvocationIndex == 0) loads[instance] = LoadRecord(vec4(step.found.offset, 0, 0, step.found.status), vec4(0));
  }
  step.surface = search_here ? step.found.depth + step.found.lowest : THICKNESS;
  step.friction = RANDOM_SKIN ? instanceRecord(instance).skin.y : 1.0;
  if (FRICTION) step.only_motion = loadMotions(instance, num_slots, search_here ? step.found.offset : tile.offset_z, tile.X_PS);
  step.only = onlyObject(reach, instance * num_slots, kSkipsTaxels);
  if (kSkipsTaxels && kOnlyRound) {
    step.part = roundPartBelow(tile.z_limit, step.only.body.kind_groups.x, step.only.parameters, step.only.body.X_PO);
  }
  step.per_dt = HAS_STATE || BRISTLES ? step_record.time.y : 0.0;
  return step;
}

const bool kHasStates = kStoresTouched || RELAXATION > 0;
const bool kUnrollsRows = EITHER(kHasStates, OUTPUT_JACOBIAN);
const uint kSamplesAtOnce = kUnrollsRows ? 4u : 1u;  // samples of a row
// The code of four samples exceeds a processor's cache for instructions.
const uint kUnrolledSamples = kUnrollsRows ? 2u : 1u;
const uint kUnrolledRows = kUnrollsRows ? 1u : 2u;  // four take more time, driver/README.md

// A taxel while its samples are summed.
struct Taxel {
  uvec2 in_tile;      // row and column in the tile
  uvec2 base;         // row and column of its first sample in the tile
  vec2 first_sample;  // the same in the patch
  bvec4 rim;          // which sides are at the patch's rim: low x, high x, low y, high y
  bool is_reached;    // its samples have states of relaxation
  bool is_touched;    // its samples have states of shear and depth
};

Taxel taxelAt(Tile tile, TileStep step, uvec2 in_tile) {
  Taxel taxel;
  taxel.in_tile = in_tile;
  taxel.base = in_tile * SAMPLES;
  taxel.first_sample = vec2(taxel.base + tile.first_taxel * SAMPLES);
  uvec2 in_patch = in_tile + tile.first_taxel;
  taxel.rim = bvec4(equal(in_patch, uvec2(0)), equal(in_patch + 1u, tile.grid.xy)).xzyw;
  taxel.is_reached = RELAXATION > 0 && isReached(step.skin, in_tile);
  taxel.is_touched = kStoresTouched && isInside(in_tile, step.touched) && hasStates(tile, step.state, in_tile);
  return taxel;
}

// Words of a row of samples; kEmpty where there is no sample or no surface.
uvec4 wordsOfRow(Tile tile, TileStep step, Taxel taxel, uint row, inout Found found) {
  uvec4 words = uvec4(kEmpty);
  float x = samplePosition(tile, taxel.first_sample + vec2(row, 0)).x;
  if (!usesTile() && kOnlyPolyhedra) startRow(x);
  uint address = (taxel.base.x + row) * tile.stride + taxel.base.y;
  [[unroll]] for (uint b = 0; b < 4u; ++b) {
    if (b < SAMPLES && row < SAMPLES) {
      uint word;
      vec2 position = vec2(x, samplePosition(tile, taxel.first_sample + vec2(0, b)).y);
      float height = sampleHeight(tile, step.only, address + b, position, found, word);
      words[b] = height >= kNoHeight ? kEmpty : word;
    }
  }
  return words;
}

// Rate of the depth since the step before, m/s; stores the depth as the state of sample `i`.
float depthRate(TileStep step, inout uvec4 depths, uint i, float d) {
  float rate = step.at_rest ? 0.0 : (d - uintBitsToFloat(component(depths, i))) * step.per_dt;
  depths = withComponent(depths, i, floatBitsToUint(d));
  return rate;
}

// Shear of a sample: its traction (Pa) and the moment of that about P's origin (Pa m).
struct SampleShear {
  vec2 traction;
  vec3 moment;
};

// Adds the traction at a point p of P, which has a part `weight` of the cell, under `pressure` (Pa). `x`, `y`: states of four samples, of
// which this is the `i`th.
void addPoint(inout SampleShear sum, TileStep step, inout uvec4 x, inout uvec4 y, uint i, bool touches, uint slot, vec3 p, float weight,
              float pressure) {
  uvec2 words = uvec2(component(x, i), component(y, i));
  vec2 q = shearTraction(words, touches, slot, step.only_motion, p, weight, pressure, step.per_dt);
  x = withComponent(x, i, words.x);
  y = withComponent(y, i, words.y);
  sum.traction += q;
  sum.moment += cross(p, vec3(q, 0));
}

// Adds the shear of sample `i` of `states` under the pressure f (Pa). `word`: the tile's word.
void addShear(inout TaxelSums sums, TileStep step, inout ShearStates states, uint i, CellPoints points, uint word, vec2 position, float d,
              float share, float f) {
  SampleShear sum = SampleShear(vec2(0), vec3(0));
  bool touches = d > 0.0;
  uint slot = slotOf(word);
  if (VARIATION) {
    // The pressure of a cell is divided between its points as it would be at rest.
    float at_rest = cellPressure(points, 1.0, 0.0), per_rest = at_rest > 0.0 ? 1.0 / at_rest : 0.0;
    vec2 pressures = vec2(pressureAt(points, 0, 1.0, 0.0), pressureAt(points, 1, 1.0, 0.0)) * per_rest * f * step.friction;
    vec3 p = vec3(position + points.from_middle[0], -points.depth[0]);
    addPoint(sum, step, states.x_0, states.y_0, i, touches, slot, p, points.weight[0] * abs(share), pressures.x);
    p = vec3(position + points.from_middle[1], -points.depth[1]);
    addPoint(sum, step, states.x_1, states.y_1, i, touches, slot, p, points.weight[1] * abs(share), pressures.y);
  } else {
    addPoint(sum, step, states.x_0, states.y_0, i, touches, slot, vec3(position, -d), abs(share), f * step.friction);
  }
  sums.shear += sum.traction;
  sums.shear_moment += sum.moment;
}

// Adds the sample in row `a` and column `b` of the taxel, at x (m, in P), sample `i` of `states`, to `sums` and to `row` of the tactile
// Jacobian.
void pressSample(Tile tile, TileStep step, Taxel taxel, RowWords rows, uint a, uint b, float x, uint i, inout SampleStates states,
                 inout CellRow row, inout TaxelSums sums, inout Found found) {
  uint address = (taxel.base.x + a) * tile.stride + taxel.base.y + b;
  vec2 position = vec2(x, samplePosition(tile, taxel.first_sample + vec2(0, b)).y);
  uint word = component(rows.here, b);
  float height = withoutSlot(word);
  if (!keepsRows()) height = sampleHeight(tile, step.only, address, position, found, word);
  float d = clamp(step.load_driven ? step.found.depth - (height - step.found.lowest) : THICKNESS - height, 0.0, THICKNESS);
  if (AREA) d = depthOfWord(word);
  float d_rate = HAS_STATE ? depthRate(step, states.depths, i, d) : 0.0;
  float share = keepsShares() ? uintBitsToFloat(cell_shares[address]) : 1.0;
  sums.deep += d >= THICKNESS || share < 0.0 ? 1u : 0u;
  CellPoints points;
  if (VARIATION) points = cellPoints(tile, d / abs(share), abs(share), cell_variations[address]);
  bool is_uneven = VARIATION && EXPONENT != 1.0;
  float f = is_uneven ? cellPressure(points, abs(share), d_rate) : lawPressure(d, d_rate);
  if (RELAXATION > 0) f = relax(step.skin, states.skin, i, taxel.is_reached, f);
  sums.force += f;
  sums.moment += f * position;
  if (kSumsSlopes && f > 0.0) sums.slope += stiffnessOf(points, d, share, f).slope;
  sums.depth += d;
  if (OUTPUT_JACOBIAN) {
    Stiffness stiffness = AREA ? stiffnessOf(points, d, share, f)
                               : stiffnessAmong(tile, step.surface, wordsAround(tile, rows, uvec2(a, b), address), height, f);
    addSample(row, b, taxel.rim, position.y, f, stiffness);
  }
  if (FRICTION) addShear(sums, step, states.shear, i, points, word, position, d, share, f);
}

// Adds row `a` of the taxel to `sums` and to `cell` of the tactile Jacobian. `rows`: words of the row before.
void pressRow(Tile tile, TileStep step, Taxel taxel, uint a, inout RowWords rows, inout TaxelSums sums, inout Cell cell,
              inout Found found) {
  float x = samplePosition(tile, taxel.first_sample + vec2(a, 0)).x;
  if (!usesTile() && !keepsRows() && kOnlyPolyhedra) startRow(x);
  rows.before = rows.here;
  rows.here = rows.after;
  if (keepsRows()) rows.after = wordsOfRow(tile, step, taxel, a + 1u, found);
  CellRow row = noCellRow();
  for (uint first = 0; first < SAMPLES; first += kSamplesAtOnce) {
    uint states_start = statesOf(tile, step.state, taxel.in_tile, a, first / 4u);
    SampleStates states = readStates(states_start, taxel.is_touched);
    for (uint part = 0; part < kSamplesAtOnce; part += kUnrolledSamples) [[unroll]] for (uint k = 0; k < kUnrolledSamples; ++k) {
        uint i = part + k, b = first + i;
        if (kUnrollsRows && b >= SAMPLES) break;
        pressSample(tile, step, taxel, rows, a, b, x, i, states, row, sums, found);
      }
    writeStates(states_start, states);
  }
  if (OUTPUT_JACOBIAN) addRow(cell, row, a, taxel.rim, x);
}

// Sums over the samples of the taxel at `in_tile`; adds it to `cell` and `change` of the tactile Jacobian.
TaxelSums pressTaxel(Tile tile, TileStep step, uvec2 in_tile, inout Found found, inout Cell cell, inout vec3 change[6]) {
  Taxel taxel = taxelAt(tile, step, in_tile);
  TaxelSums sums = TaxelSums(0.0, 0.0, vec2(0), vec2(0), vec3(0), 0u, 0.0);
  RowWords rows = RowWords(uvec4(kEmpty), uvec4(kEmpty), uvec4(kEmpty));
  if (keepsRows()) rows.after = wordsOfRow(tile, step, taxel, 0, found);
  uint first_row = 0;
  do {
    [[unroll]] for (uint n = 0; n < kUnrolledRows; ++n) {
      uint a = first_row + n;
      if (kUnrolledRows > 1u && a >= SAMPLES) break;
      pressRow(tile, step, taxel, a, rows, sums, cell, found);
    }
    first_row += kUnrolledRows;
  } while (first_row < SAMPLES);
  if (OUTPUT_WRENCH_CHANGE) addToChange(tile, change, cell, taxel.rim, taxel.first_sample);
  return sums;
}

// Computes all active taxels, each by one of LANES lanes, which leave partial sums of the wrench.
void pressTaxels(Tile tile, TileStep step, ActiveTaxels taxels, inout Found found) {
  uint num_active = taxels.count.x * taxels.count.y;
  uint deep = found.full_cells;
  uint v = gl_LocalInvocationIndex;
  do {
    bool owns = WORKGROUP <= LANES || v < LANES;
    vec4 wrench = vec4(0);
    vec2 lane_shear = vec2(0);
    vec3 change[6] = vec3[6](vec3(0), vec3(0), vec3(0), vec3(0), vec3(0), vec3(0));
    uint touched = owns && kSkipsTaxels ? touchedTaxels(tile, step.state, v, taxels.first, taxels.count, step.first_taxel, step.part) : 0;
    uint num_rounds = numRounds(touched, num_active), round = 0;
    uint k = kSkipsTaxels ? nextTouched(touched, v) : owns ? v : num_active;
    if (num_rounds > 0) do {
        if (k < num_active) {
          uvec2 in_tile = taxels.first + cellNumbered(k, taxels.count.y);
          Cell cell = noCell();
          TaxelSums sums = pressTaxel(tile, step, in_tile, found, cell, change);
          deep += sums.deep;
          writeTaxel(tile, step.instance, in_tile + tile.first_taxel, sums, cell, wrench, lane_shear);
          k = kSkipsTaxels ? nextTouched(touched, v) : k + LANES;
        }
      } while (++round < num_rounds);
    checkLoop(k < num_active);
    if (owns) {
      setPartial(v, wrench);
      if (FRICTION) setPartialShear(v, lane_shear);
      if (OUTPUT_WRENCH_CHANGE) writeChange(tile, step.result * LANES + v, change);
    }
    v += WORKGROUP;
  } while (WORKGROUP < LANES && v < LANES);
  if (deep > 0) atomicAdd(num_deep, deep);
  if (NUM_ROWS == 0 && found.below_floor && tile.X_PS.row2.z > kLooksUp) atomicOr(any_behind, 1u);
}
