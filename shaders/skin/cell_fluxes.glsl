// What the tactile Jacobian takes from a taxel's samples: how the taxel's force changes as the object moves. Included by contact.comp, whose names it uses.
// Twin: src/reference/pressure_transport.cpp.
//
// The object's surface lies at z = -d(x, y) of P. Its point p = (x, y, -d) moves with u = v + w x p, so that d_t = -u_z - u_x d_x - u_y d_y, and the force
// of a cell is the integral of the pressure f(d) over it. With f' = df/dd and G = d f - (integral of f from 0 to d), so that dG/dd = d f',
//
//   f' d_t = -d(f v_x)/dx - d(f v_y)/dy - f' v_z - (f' y + dG/dy) w_x + (f' x + dG/dx) w_y + (d(f y)/dx - d(f x)/dy) w_z,
//
// a flux through the cell's sides but for f'. Unlike a sum of f' d_t over samples it sees vertical walls, where d jumps between two samples, and what leaves
// one cell enters the next. f at a side is the mean of the samples on both sides of it; at the patch's rim it goes on from inside as a straight line.
//
// f' jumps where contact ends, and where the skin does. So its mean over a sample's cell is taken, over which the depth is even about d and as wide as its
// slope and the cell's size make it. That asks for surfaces a little over the skin.

struct Cell {
  vec3 side[4];  // at the lower and upper end along x, along y: sums of f, G, f times the coordinate along the side, Pa, Pa m, Pa m
  vec3 slope;    // sums of f', f' x, f' y, Pa/m, Pa, Pa
};

Cell noCell() { return Cell(vec3[4](vec3(0), vec3(0), vec3(0), vec3(0)), vec3(0)); }

// The smaller step of depth from a sample, the `k`th of its taxel along an axis, to its neighbours in the taxel, m: the larger may be a wall, and one of more
// than 63 degrees is. `surface`: depth where the tile's height is 0.
float stepOfDepth(float d, uint k, uint address, uint stride, float surface) {
  float least = kMiss;
  if (k > 0) {
    float before = surface - withoutSlot(tile[address - stride]);
    if (before > -cellReach()) least = abs(d - before);
  }
  if (k + 1 < SAMPLES) {
    float after = surface - withoutSlot(tile[address + stride]);
    if (after > -cellReach()) least = min(least, abs(d - after));
  }
  return least < 2.0 * cellReach() ? least : 0.0;
}

// Mean of f' at rest over depths within half of `width` of d, as far as the skin is there.
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

// A sample (a, b) of a taxel at `position`, whose sides at the rim `rim` tells: of depth d (m, < 0 over the skin), which changes by `width` over the sample's
// cell, under the pressure f. `change`: of force and first moments of the tile by the object's twist, all over the area of a sample.
void addToCell(inout Cell cell, inout vec3 change[6], uvec2 at, bvec4 rim, vec2 position, float d, float width, float f) {
  float pressed = clamp(d, 0.0, THICKNESS);
  float elastic = lawPressure(pressed, 0.0);
  // A skin that relaxes has a share of its stiffness left, sample by sample, and no way to tell that of samples which nothing presses.
  float share = RELAXATION > 0 && elastic > 0.0 ? f / elastic : 1.0;
  bool lifted = pressed > 0.0 && f <= 0.0;  // by a damper, or a dent
  float slope = lifted || d <= (RELAXATION > 0 ? 0.0 : -cellReach()) ? 0.0 : share * meanSlope(d, RELAXATION > 0 ? 0.0 : width);
  float G = lifted ? 0.0 : share * elastic * pressed * (LAW_1 / (LAW_1 + 1.0));
  float x = position.x, y = position.y;
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
    there[axis + 1] += outward * (float(rows[side]) + 0.5) * spacing[axis];
    if (rim[side]) addThroughRim(change, axis, outward * sideWeight(true, rows[side]) / spacing[axis], f, G, there);
  }
}

void keepCell(uint taxel, Cell cell) {
  vec3 slope = cell.slope * sample_area;
  contact_cells[taxel].low_x = vec4(cell.side[0] * spacing.y, slope.x);
  contact_cells[taxel].high_x = vec4(cell.side[1] * spacing.y, slope.y);
  contact_cells[taxel].low_y = vec4(cell.side[2] * spacing.x, slope.z);
  contact_cells[taxel].high_y = vec4(cell.side[3] * spacing.x, 1);
}

// Nothing is near a taxel; a tile.
void leaveCell(uint taxel) { contact_cells[taxel].high_y.w = 0.0; }
void leaveChange(uint tile) { tile_changes[tile * LANES * kTileChanges] = kNoHeight; }

void keepChange(uint sum, vec3 change[6]) {
  for (uint k = 0; k < 6; ++k) {
    tile_changes[sum * kTileChanges + 3 * k] = change[k].x * sample_area;
    tile_changes[sum * kTileChanges + 3 * k + 1] = change[k].y * sample_area;
    tile_changes[sum * kTileChanges + 3 * k + 2] = change[k].z * sample_area;
  }
}
