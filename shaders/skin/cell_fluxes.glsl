// Derivatives of a taxel's force and of a tile's wrench by the motion of the object, summed over samples for the tactile Jacobian. Twin:
// src/reference/pressure_transport.cpp.
//
// The object's surface lies at z = -d(x, y) of P. Its point p = (x, y, -d) moves with u = v + w x p, so that d_t = -u_z - u_x d_x - u_y d_y, and the force
// of a cell is the integral of the pressure f(d) over it. With f' = df/dd and G = d f - (integral of f from 0 to d), so that dG/dd = d f',
//
//   f' d_t = -d(f v_x)/dx - d(f v_y)/dy - f' v_z - (f' y + dG/dy) w_x + (f' x + dG/dx) w_y + (d(f y)/dx - d(f x)/dy) w_z,
//
// a flux through the cell's sides except for the terms in f'. Unlike a sum of f' d_t over samples, it includes vertical walls, where d jumps between two
// samples, and the flux out of one cell enters the next. f at a side is the mean of the samples on both sides of it; at the patch's rim f is extrapolated
// linearly.
//
// f' jumps at the border of the contact and at the skin's full thickness. Its mean over a sample's cell is used, with depths uniform about d over a width that
// follows from the slope and the cell's size. This needs surfaces up to cellReach() over the skin. With area sampling the covered share of a cell is known, and
// f is the mean over the cell.

struct Cell {
  vec3 side[4];  // at the lower and upper end along x, along y: sums of f, G, f times the coordinate along the side, Pa, Pa m, Pa m
  vec3 slope;    // sums of f', f' x, f' y, Pa/m, Pa, Pa
};

Cell noCell() { return Cell(vec3[4](vec3(0), vec3(0), vec3(0), vec3(0)), vec3(0)); }

// The smaller step of depth from a sample, the `k`th of its taxel along an axis, to its neighbours in the taxel, m; 0 for a wall, a step of more than 63
// degrees. `surface`: depth where the tile's height is 0, m.
float stepOfDepth(Tile tile, float d, uint k, uint address, uint stride, float surface) {
  float least = kMiss;
  if (k > 0) {
    float before = surface - withoutSlot(tile_heights[address - stride]);
    if (before > -cellReach(tile)) least = abs(d - before);
  }
  if (k + 1 < SAMPLES) {
    float after = surface - withoutSlot(tile_heights[address + stride]);
    if (after > -cellReach(tile)) least = min(least, abs(d - after));
  }
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

// Through the patch's rim, across x (axis 0) or y (axis 1): `phi` is (1, x, y) there.
void addThroughRim(inout vec3 change[6], uint axis, float flux, float f, float G, vec3 phi) {
  change[axis] -= flux * f * phi;
  change[axis == 0 ? 4 : 3] += (axis == 0 ? flux : -flux) * G * phi;
  change[5] += (axis == 0 ? flux * phi.z : -flux * phi.y) * f * phi;
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
  return Stiffness(slope, lifted ? 0.0 : share * elastic * pressed * (LAW_1 / (LAW_1 + 1.0)));
}

// With area sampling, of a cell of mean depth d, a share of which is covered; the share is negative at the skin's full thickness. Without VARIATION pressure is
// proportional to depth.
Stiffness stiffnessOf(CellPoints points, float d, float covered, float f) {
  if (d <= 0.0 || f <= 0.0) return Stiffness(0.0, 0.0);
  if (VARIATION && LAW_1 != 1.0) {
    float share = RELAXATION > 0 ? f / cellPressure(points, abs(covered), 0.0) : 1.0;
    Stiffness sum = Stiffness(0.0, 0.0);
    for (uint k = 0; k < kCellPoints; ++k) {
      sum.slope += share * max(covered, 0.0) * points.weight[k] * lawSlope(points.depth[k]);
      sum.G += share * pressureAt(points, k, abs(covered), 0.0) * points.depth[k] * (1.0 / (LAW_1 + 1.0));
    }
    return sum;
  }
  float elastic = lawPressure(d, 0.0), share = RELAXATION > 0 ? f / elastic : 1.0;
  return Stiffness(share * max(covered, 0.0) * lawSlope(d), share * elastic * 0.5 * d / abs(covered));
}

// Adds sample `at` of a taxel, at `position`, under the pressure f (Pa). `rim`: which sides of the taxel are at the patch's rim. `change`: derivatives of force
// and first moments of the tile by the object's twist, without the factor of a sample's area.
void addToCell(Tile tile, inout Cell cell, inout vec3 change[6], uvec2 at, bvec4 rim, vec2 position, float f, Stiffness stiffness) {
  float slope = stiffness.slope, G = stiffness.G, x = position.x, y = position.y;
  vec3 phi = vec3(1, x, y);
  cell.slope += slope * phi;
  uvec4 rows = uvec4(at.x, SAMPLES - 1 - at.x, at.y, SAMPLES - 1 - at.y);
  vec3 across_x = vec3(f, G, f * y), across_y = vec3(f, G, f * x);
  for (uint side = 0; side < 4; ++side) cell.side[side] += sideWeight(rim[side], rows[side]) * (side < 2 ? across_x : across_y);

  change[0].y += f;
  change[1].z += f;
  change[2] -= slope * phi;
  change[3] -= slope * y * phi;
  change[3].z += G;
  change[4] += slope * x * phi;
  change[4].y -= G;
  change[5] += f * vec3(0, -y, x);
  if (!any(rim)) return;
  for (uint side = 0; side < 4; ++side) {
    uint axis = side / 2;
    float outward = (side & 1u) == 0 ? -1.0 : 1.0;
    vec3 there = phi;
    there[axis + 1] += outward * (float(rows[side]) + 0.5) * tile.spacing[axis];
    if (rim[side]) addThroughRim(change, axis, outward * sideWeight(true, rows[side]) / tile.spacing[axis], f, G, there);
  }
}

void writeCell(Tile tile, uint taxel, Cell cell) {
  vec3 slope = cell.slope * tile.force_area;
  contact_cells[taxel].low_x = vec4(cell.side[0] * tile.spacing.y, slope.x);
  contact_cells[taxel].high_x = vec4(cell.side[1] * tile.spacing.y, slope.y);
  contact_cells[taxel].low_y = vec4(cell.side[2] * tile.spacing.x, slope.z);
  contact_cells[taxel].high_y = vec4(cell.side[3] * tile.spacing.x, 1);
}

// Outputs of a taxel that nothing is near; of such a tile.
void clearCell(uint taxel) { contact_cells[taxel].high_y.w = 0.0; }
void clearChange(uint tile_index) { tile_changes[tile_index * LANES * kTileChanges] = kNoHeight; }

void writeChange(Tile tile, uint sum, vec3 change[6]) {
  for (uint k = 0; k < 6; ++k) {
    tile_changes[sum * kTileChanges + 3 * k] = change[k].x * tile.force_area;
    tile_changes[sum * kTileChanges + 3 * k + 1] = change[k].y * tile.force_area;
    tile_changes[sum * kTileChanges + 3 * k + 2] = change[k].z * tile.force_area;
  }
}
