// Area sampling of solids: half-spaces, cones and upright cylinders by facets; spheres, capsules and lying cylinders cell by cell.
//
// Over a cell the lowest surface is a quadratic to the accuracy of kSmooth, but next to an end of a tube and where the surface is steep.
// The integral of a quadratic depth has a closed form inside of the contact, and along each of kLines lines through a cell on the contact's
// edge. A convex solid lies above its tangent plane, which discards cells that nothing touches. Through each of the other cells go
// kScanLines lines along y; Gauss's rule with two nodes in each of three pieces of the chord (chordOf()) integrates along a line.
// Reference: src/reference/mean_depth.cpp.
//
// Cells on the edge and cells with scan lines are listed first: a vector processor takes a branch with all its lanes.
// Shared memory: 8 bytes.

#include "depth/area/facets.glsl"

// ---- facets of solids ----
//
// Area sampling replaces a half-space by two quads, and a cone, or a cylinder whose ends look up and down, by a pyramid or prism with
// kSides sides. Its sections have the areas of the solid's, so that the outlines of flat ends are exact integrals; it deviates by at
// most 2.1e-4 radii.

const uint kSides = 128u;
const float kSideAngle = 6.2831853072 / float(kSides);
const float kSameArea = 1.00020083;  // radius of a polygon over that of a circle of the same area: sqrt(angle / sin(angle))
const float kUpright = 0.7;          // cosine of the axis to z of P, from which a cylinder has facets

bool hasFacets(Solid solid) {
  return isKind(solid.kind, kKindCone) || isKind(solid.kind, kKindCylinder) && abs(solid.X_PO.row2.z) > kUpright;
}

// A point of P in cells of the tile and depth.
vec3 inCells(Tile tile, vec3 p_P) { return vec3((p_P.xy - tile.corner) / tile.spacing - tile.first + 0.5, -p_P.z); }
vec3 inCells(Tile tile, Solid solid, vec3 p) { return inCells(tile, apply(solid.X_PO, p)); }

// All invocations share the facets.
void addRound(Tile tile, Solid solid, inout Found found) {
  bool is_cone = isKind(solid.kind, kKindCone);
  float radius = solid.parameters.x * kSameArea, low_radius = is_cone ? 0.0 : radius;
  float low_z = is_cone ? 0.0 : -solid.parameters.y, high_z = solid.parameters.y;
  vec3 low = inCells(tile, solid, vec3(0, 0, low_z)), high = inCells(tile, solid, vec3(0, 0, high_z));
  uint i = gl_LocalInvocationIndex;
  for (; i < 4u * kSides; i += WORKGROUP) {
    uint which = i / kSides;  // two triangles of the flank, one of each end
    float angle = float(i) * kSideAngle, next = float(i + 1) * kSideAngle;
    vec2 from = vec2(cos(angle), sin(angle)), to = vec2(cos(next), sin(next));
    vec3 p = inCells(tile, solid, vec3(low_radius * from, low_z)), q = inCells(tile, solid, vec3(low_radius * to, low_z));
    vec3 r = inCells(tile, solid, vec3(radius * from, high_z)), s = inCells(tile, solid, vec3(radius * to, high_z));
    // Counter-clockwise: (p, q, s), (p, s, r) of the flank; (high, r, s), (low, q, p) of the ends.
    vec3 a = which == 2u ? high : p, b = which == 1u ? s : r, c = which == 1u ? r : s;
    if (which == 3u) a = low, c = p;
    if (which == 0u || which == 3u) b = q;
    Facet facet;
    if (facetOf(a, b, c, facet)) addFacet(tile, facet, found);
  }
  checkLoop(i < 4u * kSides);
}

// A half-space under the tile, by two quads that lie one behind the other along the plane's gradient: a ramp from the skin's surface to
// full depth, then what is deeper, down to where the tile sees no further. So no depth exceeds the thickness, however steep the plane is.
// All invocations call it.
void addHalfSpace(inout Tile tile, Solid solid, inout Found found) {
  const float kLeastAcross = 1e-9;
  vec3 normal = vec3(solid.X_PO.row0.z, solid.X_PO.row1.z, solid.X_PO.row2.z),
       at = vec3(solid.X_PO.row0.w, solid.X_PO.row1.w, solid.X_PO.row2.w);
  vec2 half_size = 0.5 * (tile.end - tile.first) * tile.spacing, middle = samplePosition(tile, 0.5 * (tile.first + tile.end - 1.0));
  float slope = length(normal.xy), across = max(slope, kLeastAcross), descent = max(normal.z, kLeastDescent);
  vec2 ahead = slope > kLeastAcross ? normal.xy / slope : vec2(1, 0);
  float inside = dot(middle - at.xy, normal.xy) - normal.z * at.z;  // m, how far the middle of the tile is inside
  // Where along `ahead` the plane is at these depths, within the tile.
  float extent = dot(abs(ahead), half_size);
  vec3 ends = clamp((descent * vec3(0, THICKNESS, -tile.z_floor) - inside) / across, -extent, extent);
  if (NUM_ROWS > 0) ends.z = extent;
  found.below_floor = found.below_floor || ends.z < extent;
  vec2 depths = clamp((inside + across * ends.xy) / descent, 0.0, THICKNESS);
  tile.deepest = THICKNESS;
  vec2 aside = vec2(-ahead.y, ahead.x) * length(half_size);
  for (uint k = 0; k < 4; ++k) {  // two triangles of the ramp, two of full depth
    bool is_ramp = k < 2;
    vec2 from = middle + ahead * (is_ramp ? ends.x : ends.y), to = middle + ahead * (is_ramp ? ends.y : ends.z);
    float from_depth = is_ramp ? depths.x : THICKNESS, to_depth = is_ramp ? depths.y : THICKNESS;
    vec3 p = inCells(tile, vec3(from - aside, -from_depth)), q = inCells(tile, vec3(to + aside, -to_depth));
    vec3 r = (k & 1u) == 0 ? inCells(tile, vec3(from + aside, -from_depth)) : inCells(tile, vec3(to - aside, -to_depth));
    Facet facet;
    if (facetOf(p, (k & 1u) == 0 ? r : q, (k & 1u) == 0 ? q : r, facet)) addLargeFacet(tile, facet, found);
  }
}

// ---- cells ----

const uint kLines = 4u;
const uint kScanLines = 8u;
const float kSmooth = 0.003;        // share of the largest depth: change by the quartic terms of a surface that counts as a quadratic
const float kGauss = 0.5773502692;  // nodes of Gauss's rule on [-1, 1]

// In listed_cells, cells on an edge come first, and cells with scan lines last.
LIST_LENGTH uint num_edge_cells;
LIST_LENGTH uint num_scan_cells;

// Height (m) of the solid's lowest surface over a position in P; kNoHeight without one.
float heightAt(Tile tile, Solid solid, vec2 xy, inout Found found) {
  float z = analyticHeight(solid.kind, solid.parameters, solid.X_PO, xy, tile.z_floor, found);
  bool below_floor = NUM_ROWS == 0 && z < tile.z_floor;
  found.below_floor = found.below_floor || below_floor;
  return below_floor ? kNoHeight : z;
}

float depthUnder(float z) { return clamp(-z, 0.0, THICKNESS); }

// The cells of the tile that the part of a solid below the skin may touch.
Box touchedCells(Tile tile, RoundPart part) {
  const float kRounding = 1e-3;  // samples
  vec2 half_size = halfSizeOf(part);
  vec2 first = (part.middle - half_size - tile.corner) / tile.spacing - tile.first + 0.5 - kRounding;
  vec2 last = (part.middle + half_size - tile.corner) / tile.spacing - tile.first + 0.5 + kRounding;
  vec2 end = tile.end - tile.first;
  return part.exists ? Box(wholeNumbers(floor(clamp(first, vec2(0), end))), wholeNumbers(floor(clamp(last, vec2(-1), end - 1.0))))
                     : noSamples();
}

// The cells of a box that lie in a band along the solid's axis: each row of the box has the same number of cells, from a first cell that
// depends on the row.
struct CellBand {
  Box box;
  uint width;            // cells of a row
  float start, per_row;  // the first cell in row 0, and how much farther it is in the next row
};

CellBand bandOf(Tile tile, RoundPart part) {
  const float kRounding = 1e-3;  // cells
  CellBand band;
  band.box = touchedCells(tile, part);
  vec2 aside = vec2(-part.ahead.y, part.ahead.x);
  if (abs(aside.y) < 1e-3) aside.y = 1e-3;  // the width is that of the box
  float reach = part.reach + 0.5 * dot(abs(aside), tile.spacing), per_col = abs(aside.y) * tile.spacing.y;
  vec2 off = samplePosition(tile, tile.first) - part.middle;
  band.start = -(dot(off, aside) / aside.y + reach / abs(aside.y)) / tile.spacing.y - kRounding;
  band.per_row = -aside.x * tile.spacing.x / (aside.y * tile.spacing.y);
  int num_cols = band.box.last.y - band.box.first.y + 1;
  band.width = isAny(band.box) ? uint(wholeNumber(min(floor(2.0 * (reach / per_col + kRounding)) + 2.0, float(num_cols)))) : 0u;
  return band;
}

uvec2 cellOf(CellBand band, uint number) {
  uvec2 at = cellNumbered(number, band.width);
  float start = clamp(floor(band.start + band.per_row * float(band.box.first.x + int(at.x))), float(band.box.first.y),
                      float(band.box.last.y + 1 - int(band.width)));
  return uvec2(uint(band.box.first.x) + at.x, uint(wholeNumber(start)) + at.y);
}

// Adds the integrals along one scan line of the cell at `at`, m along the line.
void addScanLine(Tile tile, Solid solid, Tube tube, vec2 at, uint line, inout CellSums sums, inout Found found) {
  float offset = (float(line) + 0.5) / float(kScanLines) - 0.5;  // from the middle of the cell, in its widths
  vec2 start = samplePosition(tile, at + vec2(offset, -0.5));
  float x = start.x, end = start.y + tile.spacing.y;
  vec4 chord = clamp(chordOf(tube, isKind(solid.kind, kKindCylinder), x), start.y, end);
  CellSums line_sums = CellSums(0.0, chord.w - chord.x, 0.0, vec2(0));
  for (uint k = 0; k < 6; ++k) {
    uint piece = k >> 1;
    float middle = 0.5 * (chord[piece] + chord[piece + 1]), half_length = 0.5 * (chord[piece + 1] - chord[piece]);
    float y = middle + ((k & 1u) != 0 ? kGauss : -kGauss) * half_length;
    float depth = depthUnder(heightAt(tile, solid, vec2(x, y), found));
    line_sums.volume += half_length * depth;
    if (VARIATION) {
      line_sums.square += half_length * depth * depth;
      line_sums.moment += half_length * depth * vec2(offset, (y - start.y) / tile.spacing.y - 0.5);
    }
  }
  if (chord.x < chord.w) addSums(sums, line_sums, 1.0);
}

// The depth of a surface over a cell, x and y from its middle: depth + slope . (x, y) - (bend.x x^2 + 2 bend.z x y + bend.y y^2) / 2, where
// end + end_slope . (x, y) is positive.
struct Quadratic {
  float depth;  // m
  vec2 slope;
  vec3 bend;  // 1/m; x and y are not negative
  float end;  // m, from the flat end of a cylinder; a lying cylinder ends upright
  vec2 end_slope;
};

// The lower side of a sphere.
Quadratic sphereUnder(vec3 middle, float radius, vec2 xy, out float height) {
  vec2 d = xy - middle.xy;
  height = sqrt(max(radius * radius - dot(d, d), 0.0));  // height of the middle over the surface
  float per_height = 1.0 / max(height, 1e-3 * radius);
  vec2 gradient = d * per_height;
  return Quadratic(height - middle.z, -gradient, vec3(1.0 + gradient * gradient, gradient.x * gradient.y) * per_height, kNoHeight, vec2(0));
}

// The lower side of a tube. `along`: how far along the axis the surface is, m, and how fast that changes.
Quadratic tubeUnder(Tube tube, vec2 xy, out float height, out float along, out vec2 rate) {
  vec2 d = xy - tube.middle.xy, aside = vec2(-tube.ahead.y, tube.ahead.x);
  float u = dot(d, tube.ahead), v = dot(d, aside);
  height = sqrt(max(tube.radius * tube.radius - v * v, 0.0));
  float per_height = 1.0 / max(height, 1e-3 * tube.radius), rise = tube.axis.z * tube.per_level;
  float z = rise * u - height * tube.per_level, slope = v * per_height * tube.per_level;
  along = u / tube.per_level + tube.axis.z * z;
  rate = tube.ahead * tube.per_level + aside * (tube.axis.z * slope);
  float bend = tube.radius * tube.radius * per_height * per_height * per_height * tube.per_level;
  return Quadratic(-tube.middle.z - z, -tube.ahead * rise - aside * slope, bend * vec3(aside * aside, aside.x * aside.y), kNoHeight,
                   vec2(0));
}

// The lowest surface over the cell in whose middle xy is. False where it is not a quadratic.
bool quadraticUnder(Tile tile, uint kind, Tube tube, vec2 xy, out Quadratic surface) {
  const float kSteep = 0.3;     // height over radius
  const float kUpright = 0.02;  // widths of a cell: how far the lower end of a cylinder may reach below its tube
  vec2 half_size = 0.5 * tile.spacing;
  float height, along = 0.0;
  vec2 rate = vec2(0);
  if (isKind(kind, kKindSphere)) {
    surface = sphereUnder(tube.middle, tube.radius, xy, height);
  } else {
    surface = tubeUnder(tube, xy, height, along, rate);
  }
  float bend = 0.5 * dot(surface.bend.xy, half_size * half_size), to_end = tube.half_length - abs(along),
        margin = dot(abs(rate), half_size) + bend;
  bool is_one = isKind(kind, kKindSphere) || to_end > margin;
  if (isKind(kind, kKindCapsule) && to_end < -margin) {
    surface = sphereUnder(tube.middle + sign(along) * tube.half_length * tube.axis, tube.radius, xy, height);
    bend = 0.5 * dot(surface.bend.xy, half_size * half_size);
    is_one = true;
  }
  if (isKind(kind, kKindCylinder) && to_end < margin) {
    surface.end = to_end;
    surface.end_slope = -sign(along) * rate;
    is_one = tile.deepest * tube.axis.z < kUpright * min(tile.spacing.x, tile.spacing.y);
  }
  return is_one && height > kSteep * tube.radius && bend * bend * bend < kSmooth * tile.deepest * tile.sample_area;
}

// The integrals over t from first to last of the depth max(a + b t - c t^2 / 2, 0), c >= 0: volume, covered length, square, and the moment
// about t = 0 in `x`.
CellSums positivePart(float a, float b, float c, float first, float last) {
  const float kLeastBend = 1e-3;  // 1/m: 1e-10 m over a cell of 1 mm
  c = max(c, kLeastBend);
  float q = b + (b < 0.0 ? -1.0 : 1.0) * sqrt(max(b * b + 2.0 * c * a, 0.0)), one = q / c, other = q == 0.0 ? 0.0 : -2.0 * a / q;
  first = max(min(one, other), first);
  last = min(max(one, other), last);
  float size = b * b + 2.0 * c * a > 0.0 ? max(last - first, 0.0) : 0.0;
  CellSums sums =
      CellSums(size * (a + 0.5 * b * (first + last) - c * (first * first + first * last + last * last) * (1.0 / 6.0)), size, 0.0, vec2(0));
  if (VARIATION) {
    // About the middle of the piece: the depth there, its slope, and the half length's square.
    float middle = 0.5 * (first + last), depth = a + middle * (b - 0.5 * c * middle), slope = b - c * middle, h2 = 0.25 * size * size;
    sums.square = size * (depth * depth + (slope * slope - depth * c) * h2 * (1.0 / 3.0) + c * c * h2 * h2 * (1.0 / 20.0));
    sums.moment.x = middle * sums.volume + size * slope * h2 * (1.0 / 3.0);
  }
  return sums;
}

// The integrals over a cell inside of the contact, of the cell's area.
CellSums integralInside(Quadratic surface, vec2 spacing) {
  CellSums sums = CellSums(surface.depth - dot(surface.bend.xy, spacing * spacing) * (1.0 / 24.0), 1.0, 0.0, vec2(0));
  if (VARIATION) {
    vec2 rise = surface.slope * spacing, bend = surface.bend.xy * spacing * spacing;
    float twist = surface.bend.z * spacing.x * spacing.y;
    sums.square =
        sums.volume * sums.volume + dot(rise, rise) * (1.0 / 12.0) + dot(bend, bend) * (1.0 / 720.0) + twist * twist * (1.0 / 144.0);
    sums.moment = rise * (1.0 / 12.0);
  }
  return sums;
}

// The integrals over a cell on the edge of the contact, on the end of a cylinder, or of the skin's full thickness, of the cell's area.
// `deepest`: in the cell.
CellSums integralOf(Quadratic surface, vec2 half_size, float deepest) {
  vec2 change = half_size * abs(surface.slope) + 0.5 * half_size * half_size * surface.bend.xy;
  if (surface.end < kNoHeight) change = abs(surface.end_slope);
  bool is_turned = change.x > change.y;  // lines along the steeper axis meet the edge
  if (is_turned) {
    surface.slope = surface.slope.yx;
    surface.bend = surface.bend.yxz;
    surface.end_slope = surface.end_slope.yx;
    half_size = half_size.yx;
  }
  CellSums sums = CellSums(0.0, 0.0, 0.0, vec2(0));
  // Depth beyond the thickness does not count.
  for (uint part = 0, num_parts = deepest > THICKNESS ? 2 : 1; part < num_parts; ++part) {
    for (uint k = 0; k < kLines; ++k) {
      float x = half_size.x * ((2.0 * float(k) + 1.0) / float(kLines) - 1.0);
      float first = -half_size.y, last = half_size.y, end = surface.end + surface.end_slope.x * x;
      if (surface.end_slope.y > 0.0) first = max(first, -end / surface.end_slope.y);
      if (surface.end_slope.y < 0.0) last = min(last, -end / surface.end_slope.y);
      float a = surface.depth - float(part) * THICKNESS + x * (surface.slope.x - 0.5 * surface.bend.x * x),
            b = surface.slope.y - surface.bend.z * x;
      CellSums line = positivePart(a, b, surface.bend.y, first, last);
      line.moment = 0.5 * vec2(line.volume * x / half_size.x, line.moment.x / half_size.y);
      if (part > 0) {
        line.square += 2.0 * THICKNESS * line.volume;  // d^2 - T^2 = (d - T)^2 + 2 T (d - T)
        line.covered = 0.0;
      }
      addSums(sums, line, part > 0 ? -1.0 : 1.0);
    }
  }
  if (is_turned) sums.moment = sums.moment.yx;
  divideSums(sums, float(2u * kLines) * half_size.y);
  return sums;
}

// Class of a cell: nothing touches it, or it is inside of the contact, on an edge, or needs scan lines.
const uint kOutside = 0u, kInside = 1u, kEdge = 2u, kScanned = 3u;

uint classOf(Tile tile, Quadratic surface, bool is_quadratic, out float deepest) {
  vec2 half_size = 0.5 * tile.spacing;
  float change = dot(half_size, abs(surface.slope));
  float bend = 0.5 * dot(surface.bend.xy, half_size * half_size) + abs(surface.bend.z) * half_size.x * half_size.y;
  deepest = surface.depth + change;
  if (!is_quadratic || NUM_ROWS == 0 && deepest > -tile.z_floor) return kScanned;
  if (deepest <= 0.0) return kOutside;
  return surface.depth - change - bend < 0.0 || deepest > THICKNESS || surface.end < kNoHeight ? kEdge : kInside;
}

// Gives the cells inside of the contact, from `start` to `end` of the band, to the solid; lists cells on an edge and cells that need
// scan lines.
void sortCells(Tile tile, Solid solid, Tube tube, CellBand band, uint start, uint end, uint slot, inout Found found) {
  uint i = start + gl_LocalInvocationIndex;
  do {
    uint cell_class = kOutside, packed = 0;
    if (i < end) {
      uvec2 at = cellOf(band, i);
      Quadratic surface;
      float deepest;
      bool is_quadratic = quadraticUnder(tile, solid.kind, tube, samplePosition(tile, tile.first + vec2(at)), surface);
      cell_class = classOf(tile, surface, is_quadratic, deepest);
      packed = at.x << 16 | at.y;
      if (cell_class == kInside) giveCell(tile, at.x * tile.stride + at.y, slot, integralInside(surface, tile.spacing), found);
    }
    uint edge_index = appended(num_edge_cells, cell_class == kEdge), scan_index = appended(num_scan_cells, cell_class == kScanned);
    if (cell_class >= kEdge) listed_cells[cell_class == kEdge ? edge_index : kMostListed - 1u - scan_index] = packed;
    i += WORKGROUP;
  } while (i - gl_LocalInvocationIndex < end);
  checkLoop(i < end);
}

void giveEdgeCells(Tile tile, Solid solid, Tube tube, uint slot, inout Found found) {
  uint i = gl_LocalInvocationIndex;
  do {
    if (i < num_edge_cells) {
      uvec2 at = uvec2(listed_cells[i] >> 16, listed_cells[i] & 0xFFFFu);
      Quadratic surface;
      float deepest;
      bool is_quadratic = quadraticUnder(tile, solid.kind, tube, samplePosition(tile, tile.first + vec2(at)), surface);
      classOf(tile, surface, is_quadratic, deepest);
      giveCell(tile, at.x * tile.stride + at.y, slot, integralOf(surface, 0.5 * tile.spacing, deepest), found);
    }
    i += WORKGROUP;
  } while (i - gl_LocalInvocationIndex < num_edge_cells);
  checkLoop(i < num_edge_cells);
}

void giveScannedCells(Tile tile, Solid solid, Tube tube, uint slot, inout Found found) {
  uint i = gl_LocalInvocationIndex;
  for (; i < num_scan_cells; i += WORKGROUP) {
    uint cell = listed_cells[kMostListed - 1u - i];
    uvec2 at = uvec2(cell >> 16, cell & 0xFFFFu);
    CellSums sums = CellSums(0.0, 0.0, 0.0, vec2(0));
    for (uint line = 0; line < kScanLines; ++line) addScanLine(tile, solid, tube, tile.first + vec2(at), line, sums, found);
    divideSums(sums, float(kScanLines) * tile.spacing.y);
    giveCell(tile, at.x * tile.stride + at.y, slot, sums, found);
  }
  checkLoop(i < num_scan_cells);
}

// Gives the cells that a solid may touch to it.
void addSolid(Tile tile, Solid solid, uint slot, inout Found found) {
  CellBand band = bandOf(tile, roundPartBelow(0.0, solid.kind, solid.parameters, solid.X_PO));
  if (!isAny(band.box)) return;
  Tube tube = tubeOf(solid);
  uint count = uint(band.box.last.x - band.box.first.x + 1) * band.width;
  uint start = 0;
  do {
    num_edge_cells = num_scan_cells = 0;
    workgroupBarrier();
    sortCells(tile, solid, tube, band, start, min(start + kMostListed, count), slot, found);
    workgroupBarrier();
    giveEdgeCells(tile, solid, tube, slot, found);
    giveScannedCells(tile, solid, tube, slot, found);
    workgroupBarrier();
    start += kMostListed;
  } while (start < count);
  grow(found.samples, band.box);
}
