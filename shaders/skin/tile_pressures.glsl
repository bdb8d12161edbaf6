// Stage 2 of the contact pass: from the heights over the samples of a tile to one force per taxel (N) and a wrench, by the law
// (skin/laws/), relaxation and friction.
//
// In:  heights of the tile or of one solid (depth/heights.glsl).
// Out: contact_normal, contact_depth, contact_shear, contact_cells, tile_changes; sums of the wrench; num_deep and any_behind.
// Shared memory: 12 bytes.
// Twins: src/reference/contact.cpp, relaxation.cpp, friction.cpp, lugre.cpp.

// Cosine to z of S. On a patch flatter than this, a surface below Tile::z_floor means that a load search has passed through the body.
const float kLooksUp = 0.7;

shared uint most_touched;  // taxels of any lane that kSkipsTaxels leaves
shared uint num_deep;      // samples at the skin's full thickness
shared uint any_behind;    // 1: a surface below Tile::z_floor, on a patch that looks along z of S

// Taxels of a tile that can carry force: a rectangle, in taxels of the tile, half-open.
struct ActiveTaxels {
  uvec2 first, count;
};

ActiveTaxels activeTaxels(Box samples) {
  ActiveTaxels taxels = ActiveTaxels(uvec2(0), uvec2(0));
  if (isAny(samples)) {
    taxels.first = uvec2(samples.first) / SAMPLES;
    taxels.count = uvec2(samples.last) / SAMPLES + 1u - taxels.first;
  }
  return taxels;
}

// What all taxels of a tile have in common while their samples are summed.
struct TileStep {
  uint instance;
  uint result;         // index of the tile over all instances
  uint first_taxel;    // of the patch, over all instances
  bool load_driven;    // the load search has ended in this pass
  bool at_rest;        // no depth rate: the first step, or an instance driven by its load
  float per_dt;        // 1 / the step's time, 1/s, for laws that need it
  Search found;        // result of that search
  float surface;       // depth where the tile's height is 0, m
  uint state;          // where the states of the tile's samples begin, skin/sample_states.glsl
  uvec4 touched;       // taxels whose samples have states of shear and depth
  TileSkin skin;       // that relaxes
  Motion only_motion;  // of the object in the only slot
  float friction;      // the instance's factor on friction
  OnlyObject only;     // the object of a pass without a tile
  RoundPart part;      // its part within reach, with kOnlyRound
};

// Sums over the samples of a taxel.
struct TaxelSums {
  float depth;        // m
  float force;        // Pa
  vec2 moment;        // Pa m
  vec2 shear;         // Pa
  vec3 shear_moment;  // Pa m
  uint deep;          // samples at the skin's full thickness
  float slope;        // of the force by the depth, Pa/m; kSumsSlopes
};

// For Newton's method over tiles, load.comp. A search has no shear, whose torque takes the same place.
const bool kSumsSlopes = AREA && SEARCH == kSearchOverTiles;

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
  step.found = Search(0.0, 0.0, 0.0, kLoadOutOfReach);
  if (SEARCH == kSearchInTile && search_here) {
    if (taxels.count.x * taxels.count.y > 0) {
      step.found = searchLoad(tile, step.skin, instanceRecord(instance).drive.x, taxels.first * SAMPLES, taxels.count * SAMPLES);
    }
    if (gl_LocalInvocationIndex == 0) loads[instance] = LoadRecord(vec4(step.found.offset, 0, 0, step.found.status), vec4(0));
  }
  step.surface = search_here ? step.found.depth + step.found.lowest : THICKNESS;
  step.friction = RANDOM_SKIN ? instanceRecord(instance).skin.y : 1.0;
  if (kShears) step.only_motion = loadMotions(instance, num_slots, search_here ? step.found.offset : tile.offset_z, tile.X_PS);
  step.only = onlyObject(reach, instance * num_slots, kSkipsTaxels);
  if (kSkipsTaxels && kOnlyRound) {
    step.part = roundPartBelow(tile.z_limit, step.only.body.kind_groups.x, step.only.parameters, step.only.body.X_PO);
  }
  step.per_dt = HAS_STATE || BRISTLES ? step_record.time.y : 0.0;
  return step;
}

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

const bool kHasStates = kStoresTouched || RELAXATION > 0;
const bool kUnrollsRows = EITHER(kHasStates, OUTPUT_JACOBIAN);
const uint kSamplesAtOnce = kUnrollsRows ? 4u : 1u;  // of a row
// The code of four samples exceeds a processor's cache for instructions.
const uint kUnrolledSamples = kUnrollsRows ? 2u : 1u;
const uint kUnrolledRows = kUnrollsRows ? 1u : 2u;  // four take more time, driver/README.md

// Words of the samples of a taxel's row and of the rows before and after it, as in the tile; kEmpty where there is no sample or no surface.
struct RowWords {
  uvec4 before, here, after;
};
bool keepsRows() { return OUTPUT_JACOBIAN && !AREA && SAMPLES <= 4u; }

// Words of the `row`th row of the taxel whose samples begin at `base` of the tile and at `first_sample` of the patch.
uvec4 wordsOfRow(Tile tile, TileStep step, uvec2 base, vec2 first_sample, uint row, inout Found found) {
  uvec4 words = uvec4(kEmpty);
  float x = samplePosition(tile, first_sample + vec2(row, 0)).x;
  if (!usesTile() && kOnlyPolyhedra) startRow(x);
  uint address = (base.x + row) * tile.stride + base.y;
  [[unroll]] for (uint b = 0; b < 4u; ++b) {
    if (b < SAMPLES && row < SAMPLES) {
      uint word;
      float height = sampleHeight(tile, step.only, address + b, vec2(x, samplePosition(tile, first_sample + vec2(0, b)).y), found, word);
      words[b] = height >= kMiss ? kEmpty : word;
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

// Of sample `i` under the pressure f (Pa). `height_word`: of the tile.
SampleShear sampleShear(TileStep step, inout ShearStates states, uint i, CellPoints points, uint height_word, vec2 position, float d,
                        float share, float f) {
  SampleShear sum = SampleShear(vec2(0), vec3(0));
  bool touches = d > 0.0;
  uint slot = slotOf(height_word);
  if (!VARIATION) {
    addPoint(sum, step, states.x_0, states.y_0, i, touches, slot, vec3(position, -d), abs(share), f * step.friction);
    return sum;
  }
  // The pressure of a cell is divided between its points as it would be at rest.
  float at_rest = cellPressure(points, 1.0, 0.0), per_rest = at_rest > 0.0 ? 1.0 / at_rest : 0.0;
  vec2 pressures = vec2(pressureAt(points, 0, 1.0, 0.0), pressureAt(points, 1, 1.0, 0.0)) * per_rest * f * step.friction;
  vec3 p = vec3(position + points.from_middle[0], -points.depth[0]);
  addPoint(sum, step, states.x_0, states.y_0, i, touches, slot, p, points.weight[0] * abs(share), pressures.x);
  p = vec3(position + points.from_middle[1], -points.depth[1]);
  addPoint(sum, step, states.x_1, states.y_1, i, touches, slot, p, points.weight[1] * abs(share), pressures.y);
  return sum;
}

// Words of the samples before and after the sample `at` of its taxel along x, then along y.
uvec4 wordsAround(Tile tile, RowWords rows, uvec2 at, uint address) {
  uvec4 words = uvec4(kEmpty);
  if (keepsRows()) {
    words.xy = uvec2(component(rows.before, at.y), component(rows.after, at.y));
    if (at.y > 0) words.z = component(rows.here, at.y - 1u);
    if (at.y + 1u < SAMPLES) words.w = component(rows.here, at.y + 1u);
  } else {
    if (at.x > 0) words.x = tile_heights[address - tile.stride];
    if (at.x + 1u < SAMPLES) words.y = tile_heights[address + tile.stride];
    if (at.y > 0) words.z = tile_heights[address - 1u];
    if (at.y + 1u < SAMPLES) words.w = tile_heights[address + 1u];
  }
  return words;
}

// f' and G of a sample under the pressure f (Pa), from the words around it. `surface`: depth where the tile's height is 0, m.
Stiffness stiffnessAmong(Tile tile, float surface, uvec4 around, float height, float f) {
  float d = surface - height;
  vec2 before = surface - vec2(withoutSlot(around.x), withoutSlot(around.z)),
       after = surface - vec2(withoutSlot(around.y), withoutSlot(around.w));
  vec2 steps = vec2(stepOfDepth(tile, d, before.x, after.x), stepOfDepth(tile, d, before.y, after.y));
  return stiffnessAt(tile, d, length(steps), f);
}

// Sums over the samples of the taxel at `in_tile`; adds it to `cell` and `change` of the tactile Jacobian. Long function: the sums share
// what a sample loads.
TaxelSums pressTaxel(Tile tile, TileStep step, uvec2 in_tile, inout Found found, inout Cell cell, inout vec3 change[6]) {
  uvec2 base = in_tile * SAMPLES;
  uvec2 in_patch = in_tile + tile.first_taxel;
  float depth_sum = 0.0;
  float force = 0.0;
  vec2 moment = vec2(0), shear = vec2(0);
  vec3 shear_moment = vec3(0);
  uint deep = 0;
  float slope = 0.0;
  bool is_reached = RELAXATION > 0 && isReached(step.skin, in_tile),
       touched = kStoresTouched && isInside(in_tile, step.touched) && hasStates(tile, step.state, in_tile);
  bvec4 rim = bvec4(equal(in_patch, uvec2(0)), equal(in_patch + 1u, tile.grid.xy)).xzyw;
  vec2 first_sample = vec2(base + tile.first_taxel * SAMPLES);
  RowWords rows = RowWords(uvec4(kEmpty), uvec4(kEmpty), uvec4(kEmpty));
  if (keepsRows()) rows.after = wordsOfRow(tile, step, base, first_sample, 0, found);
  uint first_row = 0;
  do {
    [[unroll]] for (uint n = 0; n < kUnrolledRows; ++n) {
      uint a = first_row + n;
      if (kUnrolledRows > 1u && a >= SAMPLES) break;
      float x = samplePosition(tile, first_sample + vec2(a, 0)).x;
      if (!usesTile() && !keepsRows() && kOnlyPolyhedra) startRow(x);
      rows.before = rows.here;
      rows.here = rows.after;
      if (keepsRows()) rows.after = wordsOfRow(tile, step, base, first_sample, a + 1u, found);
      CellRow row = noCellRow();
      for (uint first = 0; first < SAMPLES; first += kSamplesAtOnce) {
        uint states_at = statesOf(tile, step.state, in_tile, a, first / 4u);
        SkinStates skin_states;
        ShearStates shear_states;
        uvec4 depths;
        if (RELAXATION > 0) skin_states = readSkin(states_at);
        if (kShears) shear_states = readShears(states_at, touched);
        if (HAS_STATE) depths = mix(uvec4(0), fourOf(PastState, states_at + kDepthState), bvec4(touched));
        for (uint part = 0; part < kSamplesAtOnce; part += kUnrolledSamples) [[unroll]] for (uint k = 0; k < kUnrolledSamples; ++k) {
            uint i = part + k, b = first + i;
            if (kUnrollsRows && b >= SAMPLES) break;
            uint address = (base.x + a) * tile.stride + base.y + b;
            vec2 position = vec2(x, samplePosition(tile, first_sample + vec2(0, b)).y);
            uint word = component(rows.here, b);
            float height = withoutSlot(word);
            if (!keepsRows()) height = sampleHeight(tile, step.only, address, position, found, word);
            float d = clamp(step.load_driven ? step.found.depth - (height - step.found.lowest) : THICKNESS - height, 0.0, THICKNESS);
            if (AREA) d = depthOfWord(word);
            float d_rate = HAS_STATE ? depthRate(step, depths, i, d) : 0.0;
            float share = keepsShares() ? uintBitsToFloat(cell_shares[address]) : 1.0;
            deep += d >= THICKNESS || share < 0.0 ? 1u : 0u;
            CellPoints points;
            if (VARIATION) points = cellPoints(tile, d / abs(share), abs(share), cell_variations[address]);
            bool is_uneven = VARIATION && EXPONENT != 1.0;
            float f = is_uneven ? cellPressure(points, abs(share), d_rate) : lawPressure(d, d_rate);
            if (RELAXATION > 0) f = relax(step.skin, skin_states, i, is_reached, f);
            force += f;
            moment += f * position;
            if (kSumsSlopes && f > 0.0) slope += stiffnessOf(points, d, share, f).slope;
            depth_sum += d;
            if (OUTPUT_JACOBIAN) {
              Stiffness stiffness = AREA ? stiffnessOf(points, d, share, f)
                                         : stiffnessAmong(tile, step.surface, wordsAround(tile, rows, uvec2(a, b), address), height, f);
              addSample(row, b, rim, position.y, f, stiffness);
            }
            if (kShears) {
              SampleShear sample_shear = sampleShear(step, shear_states, i, points, word, position, d, share, f);
              shear += sample_shear.traction;
              shear_moment += sample_shear.moment;
            }
          }
        if (RELAXATION > 0 && kUpdatesSkin) writeSkin(states_at, skin_states);
        if (kShears) writeShears(states_at, shear_states);
        if (HAS_STATE) state[states_at + kDepthState] = depths;
      }
      if (OUTPUT_JACOBIAN) addRow(cell, row, a, rim, x);
    }
    first_row += kUnrolledRows;
  } while (first_row < SAMPLES);
  if (OUTPUT_WRENCH_CHANGE) addToChange(tile, change, cell, rim, first_sample);
  return TaxelSums(depth_sum, force, moment, shear, shear_moment, deep, slope);
}

// Writes one taxel and adds to the wrench (normal force, torque about x, y and z of P) and shear of its lane.
void writeTaxel(Tile tile, uint instance, uvec2 in_patch, TaxelSums sums, Cell cell, inout vec4 wrench, inout vec2 lane_shear) {
  const float kPerSample = 1.0 / float(SAMPLES * SAMPLES);
  float force = sums.force * tile.force_area;
  vec2 moment = sums.moment * tile.force_area;
  uint in_sensor = tile.grid.z + in_patch.x * tile.grid.y + in_patch.y;
  uint taxel = instance * NUM_TAXELS + in_sensor;
  float scale = SCALED ? floatOfFours(SpreadScale, in_sensor) : 1.0;
  contact_normal[taxel] = SCALED ? force * scale : force;
  if (OUTPUT_DEPTH) contact_depth[taxel] = sums.depth * kPerSample;
  if (OUTPUT_JACOBIAN) writeCell(tile, taxel, cell);
  // The skin is pressed along -z: torque (x, y, 0) x (0, 0, -f).
  wrench += vec4(force, -moment.y, moment.x, kSumsSlopes ? sums.slope * tile.force_area : 0.0);
  if (!kShears) return;
  vec2 shear = sums.shear * tile.force_area;
  if (OUTPUT_SHEAR) writeShear(taxel, SCALED ? shear * scale : shear);
  wrench.yzw += sums.shear_moment * tile.force_area;
  lane_shear += shear;
}

// Rounds that all lanes take together: as many as the lane with the most of the `num_active` taxels needs. `touched`: this lane's, if
// kSkipsTaxels.
uint numRounds(uint touched, uint num_active) {
  if (!kSkipsTaxels) return (num_active + LANES - 1u) / LANES;
  if (kInRegisters) return largestOverVector(uint(bitCount(touched)));
  atomicMax(most_touched, uint(bitCount(touched)));
  workgroupBarrier();
  uint most = most_touched;
  if (WORKGROUP < LANES) workgroupBarrier();
  return most;
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
      if (kShears) setPartialShear(v, lane_shear);
      if (OUTPUT_WRENCH_CHANGE) writeChange(tile, step.result * LANES + v, change);
    }
    v += WORKGROUP;
  } while (WORKGROUP < LANES && v < LANES);
  if (deep > 0) atomicAdd(num_deep, deep);
  if (NUM_ROWS == 0 && found.below_floor && tile.X_PS.row2.z > kLooksUp) atomicOr(any_behind, 1u);
}
