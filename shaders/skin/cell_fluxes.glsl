// Derivatives of a taxel's force and of a tile's wrench by the motion of the object, summed over samples for the tactile Jacobian.
// Reference: src/reference/pressure_transport.cpp.
//
// The object's surface lies at z = -d(x, y) of P. Its point p = (x, y, -d) moves with u = v + w x p, so that d_t = -u_z - u_x d_x - u_y
// d_y, and the force of a cell is the integral of the pressure f(d) over it. With f' = df/dd and G = d f - (integral of f from 0 to d), so
// that dG/dd = d f',
//
//   f' d_t = -d(f v_x)/dx - d(f v_y)/dy - f' v_z - (f' y + dG/dy) w_x + (f' x + dG/dx) w_y + (d(f y)/dx - d(f x)/dy) w_z,
//
// a flux through the cell's sides except for the terms in f'. Unlike a sum of f' d_t over samples, it includes vertical walls, where d
// jumps between two samples, and the flux out of one cell enters the next. f at a side is the mean of the samples on both sides of it; at
// the patch's rim f is extrapolated linearly.
//
// f' jumps at the border of the contact and at the skin's full thickness. Its mean over a sample's cell is used, with depths uniform about
// d over a width that follows from the slope and the cell's size. This needs surfaces up to cellReach() over the skin. With area sampling
// the covered share of a cell is known, and f is the mean over the cell.

#include "depth/tile_heights.glsl"
#include "skin/law.glsl"

// Sums over the samples of a taxel, without the factor of a sample's area. A side has those of the samples next to it, by sideWeight(),
// where c is the coordinate along the side.
struct Cell {
  vec3 pressure;          // f times 1, x, y: Pa, Pa m, Pa m
  float G;                // Pa m
  vec3 slope;             // f' times 1, x, y: Pa/m, Pa, Pa
  vec3 slope_moment;      // f' times x^2, x y, y^2: Pa m
  vec3 side_pressure[4];  // at the lower and upper end along x, along y: f times 1, c, c^2
  vec2 side_G[4];         // G times 1, c
};

Cell noCell() {
  return Cell(vec3(0), 0.0, vec3(0), vec3(0), vec3[4](vec3(0), vec3(0), vec3(0), vec3(0)), vec2[4](vec2(0), vec2(0), vec2(0), vec2(0)));
}

// Sums over the samples of a taxel with the same x.
struct CellRow {
  vec3 pressure, slope;  // f, f' times 1, y, y^2
  vec2 G;                // times 1, y
  vec2 low_y, high_y;    // f, G at the sides along y
};

CellRow noCellRow() { return CellRow(vec3(0), vec3(0), vec2(0), vec2(0), vec2(0)); }

// The smaller step from the depth of a sample to those of its neighbours in the taxel along an axis, m; 0 for a wall, a step of more than
// 63 degrees. -kNoHeight: no such neighbour.
float stepOfDepth(Tile tile, float d, float before, float after) {
  float least = kNoHeight;
  if (before > -cellReach(tile)) least = abs(d - before);
  if (after > -cellReach(tile)) least = min(least, abs(d - after));
  return least < 2.0 * cellReach(tile) ? least : 0.0;
}

// Mean of f' at rest over depths within half of `width` of d, 0 outside the skin.
float meanSlope(float d, float width) {
  const float kFlat = 1e-9;  // m
  float low = d - 0.5 * width, high = d + 0.5 * width;
  if (width < kFlat) return d > 0.0 && d < THICKNESS ? lawSlope(d) : 0.0;
  if (low <= 0.0) return lawPressure(clamp(high, 0.0, THICKNESS), 0.0) / width;
  if (high <= THICKNESS) return lawSlope(d);
  return low < THICKNESS ? lawSlope(0.5 * (low + THICKNESS)) * (THICKNESS - low) / width : 0.0;
}

// Weight at a side of the sample row that lies `k` rows from it. Both cells at a side add to it.
float sideWeight(bool is_rim, uint k) {
  if (k == 0) return is_rim ? (SAMPLES > 1 ? 1.5 : 1.0) : 0.5;
  return k == 1 && is_rim ? -0.5 : 0.0;
}

// A sample under the pressure f: f' and G.
struct Stiffness {
  float slope, G;  // Pa/m, Pa m
};

// At depth d (m, < 0 over the skin), which changes by `width` (m) over the sample's cell.
Stiffness stiffnessAt(Tile tile, float d, float width, float f) {
  float pressed = clamp(d, 0.0, THICKNESS);
  float elastic = lawPressure(pressed, 0.0);
  // A skin that relaxes keeps a share of its stiffness, sample by sample; that of samples without pressure is unknown.
  float share = RELAXATION > 0 && elastic > 0.0 ? f / elastic : 1.0;
  bool lifted = pressed > 0.0 && f <= 0.0;  // no pressure because of a damper or a dent
  float slope = lifted || d <= (RELAXATION > 0 ? 0.0 : -cellReach(tile)) ? 0.0 : share * meanSlope(d, RELAXATION > 0 ? 0.0 : width);
  return Stiffness(slope, lifted ? 0.0 : share * elastic * pressed * (EXPONENT / (EXPONENT + 1.0)));
}

// With area sampling, for a cell of mean depth d. `covered`: its covered share, negative at the skin's full thickness. Without
// VARIATION pressure is proportional to depth.
Stiffness stiffnessOf(CellPoints points, float d, float covered, float f) {
  if (d <= 0.0 || f <= 0.0) return Stiffness(0.0, 0.0);
  if (VARIATION && EXPONENT != 1.0) {
    float share = RELAXATION > 0 ? f / cellPressure(points, abs(covered), 0.0) : 1.0;
    Stiffness sum = Stiffness(0.0, 0.0);
    for (uint k = 0; k < kCellPoints; ++k) {
      sum.slope += share * max(covered, 0.0) * points.weight[k] * lawSlope(points.depth[k]);
      sum.G += share * pressureAt(points, k, abs(covered), 0.0) * points.depth[k] * (1.0 / (EXPONENT + 1.0));
    }
    return sum;
  }
  float elastic = lawPressure(d, 0.0), share = RELAXATION > 0 ? f / elastic : 1.0;
  return Stiffness(share * max(covered, 0.0) * lawSlope(d), share * elastic * 0.5 * d / abs(covered));
}

// Words of the samples of a taxel's row and of the rows before and after it, as in the tile; kEmpty where there is no sample or no surface.
struct RowWords {
  uvec4 before, here, after;
};
bool keepsRows() { return OUTPUT_JACOBIAN && !AREA && SAMPLES <= 4u; }

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

// Adds the `b`th sample of a row, at `y`, under the pressure f (Pa). `rim`: which sides of the taxel are at the patch's rim.
void addSample(inout CellRow row, uint b, bvec4 rim, float y, float f, Stiffness stiffness) {
  vec3 powers = vec3(1, y, y * y);
  row.pressure += f * powers;
  row.slope += stiffness.slope * powers;
  row.G += stiffness.G * powers.xy;
  vec2 across = vec2(f, stiffness.G);
  row.low_y += sideWeight(rim.z, b) * across;
  row.high_y += sideWeight(rim.w, SAMPLES - 1 - b) * across;
}

// Adds the `a`th row of a taxel, at `x`.
void addRow(inout Cell cell, CellRow row, uint a, bvec4 rim, float x) {
  vec3 powers = vec3(1, x, x * x);
  cell.pressure += row.pressure.xxy * vec3(1, x, 1);
  cell.G += row.G.x;
  cell.slope += row.slope.xxy * vec3(1, x, 1);
  cell.slope_moment += row.slope * powers.zyx;
  float low = sideWeight(rim.x, a), high = sideWeight(rim.y, SAMPLES - 1 - a);
  cell.side_pressure[0] += low * row.pressure;
  cell.side_pressure[1] += high * row.pressure;
  cell.side_pressure[2] += row.low_y.x * powers;
  cell.side_pressure[3] += row.high_y.x * powers;
  cell.side_G[0] += low * row.G;
  cell.side_G[1] += high * row.G;
  cell.side_G[2] += row.low_y.y * powers.xy;
  cell.side_G[3] += row.high_y.y * powers.xy;
}

// Sums of a side times (1, x, y), from those times (1, c); the side is at `at` (m) of axis x (0) or y (1).
vec3 momentsOfSide(uint axis, float at, vec2 sums) {
  return axis == 0 ? vec3(sums.x, at * sums.x, sums.y) : vec3(sums.x, sums.y, at * sums.x);
}

// Through a side at the patch's rim a share of `flux` (1/m) of its sums of f and G; the share is negative at the lower end of the axis.
void addThroughRim(inout vec3 change[6], uint axis, float flux, float at, vec3 f, vec2 G) {
  float turn = axis == 0 ? flux : -flux;
  change[axis] -= flux * momentsOfSide(axis, at, f.xy);
  change[axis == 0 ? 4 : 3] += turn * momentsOfSide(axis, at, G);
  change[5] += turn * momentsOfSide(axis, at, f.yz);
}

// Adds a taxel to the derivatives of force and first moments of its tile by the object's twist, without the factor of a sample's area.
// `first_sample`: index of its first sample in the patch.
void addToChange(Tile tile, inout vec3 change[6], Cell cell, bvec4 rim, vec2 first_sample) {
  change[0].y += cell.pressure.x;
  change[1].z += cell.pressure.x;
  change[2] -= cell.slope;
  change[3] -= vec3(cell.slope.z, cell.slope_moment.y, cell.slope_moment.z - cell.G);
  change[4] += vec3(cell.slope.y, cell.slope_moment.x - cell.G, cell.slope_moment.y);
  change[5] += vec3(0, -cell.pressure.z, cell.pressure.y);
  vec2 low = samplePosition(tile, first_sample - 0.5), high = samplePosition(tile, first_sample + float(SAMPLES) - 0.5);
  vec2 per_spacing = 1.0 / tile.spacing;
  if (rim.x) addThroughRim(change, 0, -per_spacing.x, low.x, cell.side_pressure[0], cell.side_G[0]);
  if (rim.y) addThroughRim(change, 0, per_spacing.x, high.x, cell.side_pressure[1], cell.side_G[1]);
  if (rim.z) addThroughRim(change, 1, -per_spacing.y, low.y, cell.side_pressure[2], cell.side_G[2]);
  if (rim.w) addThroughRim(change, 1, per_spacing.y, high.y, cell.side_pressure[3], cell.side_G[3]);
}

vec3 sideOf(Cell cell, uint side) { return vec3(cell.side_pressure[side].x, cell.side_G[side].x, cell.side_pressure[side].y); }

void writeCell(Tile tile, uint taxel, Cell cell) {
  vec3 slope = cell.slope * tile.force_area;
  contact_cells[taxel].low_x = vec4(sideOf(cell, 0) * tile.spacing.y, slope.x);
  contact_cells[taxel].high_x = vec4(sideOf(cell, 1) * tile.spacing.y, slope.y);
  contact_cells[taxel].low_y = vec4(sideOf(cell, 2) * tile.spacing.x, slope.z);
  contact_cells[taxel].high_y = vec4(sideOf(cell, 3) * tile.spacing.x, 1);
}

// Outputs of a taxel and of a tile without a near object.
void clearCell(uint taxel) { contact_cells[taxel].high_y.w = 0.0; }
void clearChange(uint tile_index) { tile_changes[tile_index * LANES * kTileChanges] = kNoHeight; }

void writeChange(Tile tile, uint sum, vec3 change[6]) {
  for (uint k = 0; k < 6; ++k) {
    tile_changes[sum * kTileChanges + 3 * k] = change[k].x * tile.force_area;
    tile_changes[sum * kTileChanges + 3 * k + 1] = change[k].y * tile.force_area;
    tile_changes[sum * kTileChanges + 3 * k + 2] = change[k].z * tile.force_area;
  }
}
