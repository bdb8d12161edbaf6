// Area sampling of closed meshes: the facets that look down are clipped at the level of the skin, and add their exact integrals to the
// cells that they cover (depth/area/cell_sums.glsl). Coordinates (u, v): cell (a, b) of the tile is [a, a + 1]
// x [b, b + 1].
//
// Facets that touch are listed first, so that all lanes of a vector have one: of small triangles an invocation adds one facet to all its
// cells; the cells of a large one are shared by all invocations, and only the cells on its outline need sums over edges.
// Shared memory: 4 kMostFacets + 8 bytes.
#ifndef DEPTH_AREA_FACETS_GLSL
#define DEPTH_AREA_FACETS_GLSL
#include "depth/mesh.glsl"
#include "depth/solids.glsl"
#include "depth/area/cell_sums.glsl"

// ---- exact integrals over the part of a polygon that lies in a cell ----
//
// The cell is the unit square. By Green's theorem the area, and the moments about the corner of the cell, are sums over the edges of the
// polygon in (u, v), which runs counter-clockwise.
//
//   v ^    1 +----------+      Between the ends of an edge, clamped to the cell along u, the cell holds the trapezoid under
//     |      |    /|    |      the edge; where the edge is above the cell, a whole column. Edges that go back along u
//     |      |  /  |    |      subtract. The sums of both polygons on an edge cancel.
//     |    0 +-----+----+
//     +------> u

struct EdgeSums {
  vec3 first;   // area, moments along u and v
  vec3 second;  // moments of uu, uv and vv; with VARIATION
};

// Rates dv/du and du/dv of the edge from p to q; finite.
vec2 ratesOf(vec2 p, vec2 q) {
  const float kLargest = 1e30;
  vec2 along = q - p;
  return vec2(along.x != 0.0 ? along.y / along.x : 0.0, along.y != 0.0 ? clamp(along.x / along.y, -kLargest, kLargest) : kLargest);
}

// Subtracts the part of the cell under the edge from p to q from the sums.
void addEdge(vec2 p, vec2 q, vec2 rates, inout EdgeSums sums) {
  float u0 = clamp(p.x, 0.0, 1.0), u1 = clamp(q.x, 0.0, 1.0);
  float v0 = p.y + (u0 - p.x) * rates.x, v1 = q.y + (u1 - q.x) * rates.x;
  float a = clamp(v0, 0.0, 1.0), b = clamp(v1, 0.0, 1.0);
  // Where the edge enters and leaves 0 <= v <= 1.
  float low = min(u0, u1), high = max(u0, u1);
  float ua = clamp(u0 + (a - v0) * rates.y, low, high), ub = clamp(u1 + (b - v1) * rates.y, low, high);
  float width = ub - ua;
  vec2 before = v0 > 1.0 ? vec2(ua - u0, 0.5 * (ua * ua - u0 * u0)) : vec2(0),
       after = v1 > 1.0 ? vec2(u1 - ub, 0.5 * (u1 * u1 - ub * ub)) : vec2(0);
  sums.first.x -= 0.5 * width * (a + b) + before.x + after.x;
  sums.first.y -= width * (ua * (2.0 * a + b) + ub * (a + 2.0 * b)) * (1.0 / 6.0) + before.y + after.y;
  sums.first.z -= width * (a * a + a * b + b * b) * (1.0 / 6.0) + 0.5 * (before.x + after.x);
  if (!VARIATION) return;
  float columns = (v0 > 1.0 ? ua * ua * ua - u0 * u0 * u0 : 0.0) + (v1 > 1.0 ? u1 * u1 * u1 - ub * ub * ub : 0.0);
  sums.second.x -=
      width * (ua * ua * (3.0 * a + b) + 2.0 * ua * ub * (a + b) + ub * ub * (a + 3.0 * b)) * (1.0 / 12.0) + columns * (1.0 / 3.0);
  sums.second.y -= width * (ua * (3.0 * a * a + 2.0 * a * b + b * b) + ub * (a * a + 2.0 * a * b + 3.0 * b * b)) * (1.0 / 24.0) +
                   0.5 * (before.y + after.y);
  sums.second.z -= width * (a + b) * (a * a + b * b) * (1.0 / 12.0) + (before.x + after.x) * (1.0 / 3.0);
}

// A triangle, or two in one plane, counter-clockwise in (u, v); z is the depth under the skin, m. A triangle has c twice.
struct Facet {
  vec3 a, b, c, d;
  vec2 slope;  // slope of the depth, m per cell
};

// Contribution of the part of a facet that is deeper than a level to the integral of clamp(depth, 0, THICKNESS).
const uint kPressed = 0u;  // deeper than 0: adds its depth
const uint kBeyond = 1u;   // deeper than THICKNESS: subtracts the depth beyond it
const uint kUnseen = 2u;   // deeper than the tile sees, Tile::z_floor: subtracts THICKNESS

const uint kQuadsPerChunk = 64u;
const uint kMostFacets = 2u * kQuadsPerChunk;
shared uint listed_facets[AREA && kHasMesh ? kMostFacets : 1u];  // 4 quad + which
shared uint num_listed_facets;
shared uint num_outline_cells;

const uint kFirstTriangle = 0u, kSecondTriangle = 1u, kWholeQuad = 2u;  // which of a quad

float deepestOf(Facet facet) { return max(max(facet.a.z, facet.b.z), max(facet.c.z, facet.d.z)); }

// Parts of the facet that do not vanish, as bits.
uint partsOf(Tile tile, Facet facet) {
  float deepest = deepestOf(facet);
  uint parts = deepest > 0.0 ? 1u << kPressed : 0u;
  if (deepest > THICKNESS) parts |= 1u << kBeyond;
  if (NUM_ROWS == 0 && deepest > -tile.z_floor) parts |= 1u << kUnseen;
  return parts;
}

vec3 atLevel(vec3 p, vec3 q, float level) { return mix(p, q, (level - p.z) / (q.z - p.z)); }

// The corners of the part of a facet that is deeper than a level. A facet of four corners is cut by no level.
void cornersOf(Tile tile, Facet facet, uint part, out vec3 corners[4]) {
  float level = part == kPressed ? 0.0 : part == kBeyond ? THICKNESS : -tile.z_floor;
  vec3 a = facet.a, b = facet.b, c = facet.c;
  bvec3 deeper = greaterThan(vec3(a.z, b.z, c.z), vec3(level));
  // Turns the facet until c is the odd vertex: the part is then c and its two neighbours on the level, or all but c.
  if (deeper.y == deeper.z) {
    a = facet.b;
    b = facet.c;
    c = facet.a;
    deeper = deeper.yzx;
  } else if (deeper.x == deeper.z) {
    a = facet.c;
    b = facet.a;
    c = facet.b;
    deeper = deeper.zxy;
  }
  vec3 ca = atLevel(c, a, level), bc = atLevel(b, c, level);
  corners = deeper.z ? vec3[4](bc, c, ca, ca) : vec3[4](a, b, bc, ca);
  if (all(deeper)) corners = vec3[4](facet.a, facet.b, facet.c, facet.d);
}

// The cells of the tile that corners lie around.
Box cellsAround(Tile tile, vec3 corners[4]) {
  vec2 low = min(min(corners[0].xy, corners[1].xy), min(corners[2].xy, corners[3].xy)),
       high = max(max(corners[0].xy, corners[1].xy), max(corners[2].xy, corners[3].xy));
  return Box(max(ivec2(floor(low)), 0), min(ivec2(floor(high)), ivec2(tile.size * SAMPLES) - 1));
}

// The part of a facet that is deeper than a level, and the box of `count` cells around it.
struct Part {
  uint which;
  vec3 corners[4];
  vec2 rates[4];
  ivec2 first;
  uint num_cols, count;
};

Part partOf(Tile tile, Facet facet, uint which, inout Found found) {
  Part part;
  part.which = which;
  cornersOf(tile, facet, which, part.corners);
  for (uint k = 0; k < 4; ++k) part.rates[k] = ratesOf(part.corners[k].xy, part.corners[(k + 1) & 3].xy);
  Box cells = cellsAround(tile, part.corners);
  if (isAny(cells)) grow(found.samples, cells);
  part.first = cells.first;
  part.num_cols = uint(max(cells.last.y - cells.first.y + 1, 0));
  part.count = uint(max(cells.last.x - cells.first.x + 1, 0)) * part.num_cols;
  return part;
}

ivec2 cellOf(Part part, uint number) { return part.first + ivec2(cellNumbered(number, part.num_cols)); }

// Contribution of `which` part of a facet over a part of a cell: its area, its centroid from the cell's middle, the covariance of
// positions (xx, xy, yy), the depth (m) at the centroid and the largest difference of depths on the part.
CellSums integralsOver(Facet facet, uint which, float area, vec2 center, vec3 covariance, float depth, float difference) {
  float added = which == kUnseen ? THICKNESS : which == kBeyond ? depth - THICKNESS : depth;
  CellSums sums = CellSums(area * added, which == kBeyond ? 0.0 : area, 0.0, vec2(0));
  if (VARIATION) {
    vec2 slope = which == kUnseen ? vec2(0) : facet.slope, rise = vec2(dot(covariance.xy, slope), dot(covariance.yz, slope));
    // The variance of a linear function over a convex region is at most (range)^2 / 12; this clamps the rounding error of a steep facet's
    // narrow part.
    float found = dot(rise, slope), variance = clamp(found, 0.0, difference * difference * (1.0 / 12.0));
    if (found != variance) rise = slope * (variance / dot(slope, slope));
    float beyond = which == kBeyond ? 2.0 * THICKNESS * added : 0.0;  // d^2 - T^2 = (d - T)^2 + 2 T (d - T)
    sums.square = area * (added * added + variance + beyond);
    sums.moment = area * (added * center + rise);
  }
  return sums;
}

// Notes a surface below Tile::z_floor over a cell. Only surfaces over a cell count: a load search takes it for an object that is behind
// the skin.
void noteUnseen(Part part, float area, inout Found found) {
  const float kLeastArea = 1e-3;  // share of a cell; less may be the rounding of an outline that passes by
  if (NUM_ROWS == 0) found.below_floor = found.below_floor || part.which == kUnseen && area > kLeastArea;
}

// Adds the part of a cell that the corners enclose.
void addOutlineCell(Tile tile, Facet facet, Part part, uint number, bool alone, inout Found found) {
  ivec2 cell = cellOf(part, number);
  vec2 corner = vec2(cell);
  EdgeSums sums = EdgeSums(vec3(0), vec3(0));
  for (uint k = 0; k < 4; ++k) addEdge(part.corners[k].xy - corner, part.corners[(k + 1) & 3].xy - corner, part.rates[k], sums);
  float area = sums.first.x;
  if (area <= 0.0) return;
  noteUnseen(part, area, found);
  // The integral of a plane is the area times its value at the centroid, which lies between those at the corners.
  vec2 at = sums.first.yz / area, middle = corner + at;
  float low = min(min(part.corners[0].z, part.corners[1].z), min(part.corners[2].z, part.corners[3].z)),
        high = max(max(part.corners[0].z, part.corners[1].z), max(part.corners[2].z, part.corners[3].z));
  float depth = clamp(facet.a.z + dot(facet.slope, middle - facet.a.xy), low, high);
  vec3 covariance = sums.second / area - vec3(at.x * at.x, at.x * at.y, at.y * at.y);
  addToSums(tile, uint(cell.x) * tile.stride + uint(cell.y),
            integralsOver(facet, part.which, area, at - 0.5, covariance, depth, high - low), part.which != kPressed, alone);
}

// Adds a facet to all its cells.
void addFacet(Tile tile, Facet facet, inout Found found) {
  uint parts = partsOf(tile, facet);
  if (parts != 0) do {
      Part part = partOf(tile, facet, uint(findLSB(parts)), found);
      uint i = 0;
      if (part.count > 0) do {
          addOutlineCell(tile, facet, part, i, false, found);
        } while (++i < part.count);
      checkLoop(i < part.count);
      parts &= parts - 1u;
    } while (parts != 0);
}

// Whether the corners enclose a cell.
bool enclose(vec3 corners[4], vec2 middle) {
  bool inside = true;
  for (uint k = 0; k < 4; ++k) {
    vec2 p = corners[k].xy, along = corners[(k + 1) & 3].xy - p, from = middle - p;
    inside = inside && along.x * from.y - along.y * from.x >= 0.5 * (abs(along.x) + abs(along.y));
  }
  return inside;
}

// Adds a facet; all invocations share its cells and call it together.
void addLargeFacet(Tile tile, Facet facet, inout Found found) {
  for (uint parts = partsOf(tile, facet); parts != 0; parts &= parts - 1u) {
    Part part = partOf(tile, facet, uint(findLSB(parts)), found);
    for (uint start = 0; start < part.count; start += kMostListed) {
      if (gl_LocalInvocationIndex == 0) num_outline_cells = 0;
      workgroupBarrier();
      uint end = min(start + kMostListed, part.count), i = start + gl_LocalInvocationIndex;
      for (; i < end; i += WORKGROUP) {
        ivec2 cell = cellOf(part, i);
        vec2 middle = vec2(cell) + 0.5;
        if (enclose(part.corners, middle)) {
          noteUnseen(part, 1.0, found);
          float depth = facet.a.z + dot(facet.slope, middle - facet.a.xy), difference = abs(facet.slope.x) + abs(facet.slope.y);
          CellSums sums = integralsOver(facet, part.which, 1.0, vec2(0), vec3(1, 0, 1) / 12.0, depth, difference);
          addToSums(tile, uint(cell.x) * tile.stride + uint(cell.y), sums, part.which != kPressed, true);
        } else {
          listed_cells[atomicAdd(num_outline_cells, 1u)] = i;
        }
      }
      checkLoop(i < end);
      workgroupBarrier();
      i = gl_LocalInvocationIndex;
      for (; i < num_outline_cells; i += WORKGROUP) addOutlineCell(tile, facet, part, listed_cells[i], true, found);
      checkLoop(i < num_outline_cells);
      workgroupBarrier();
    }
  }
}

// The triangle (p, q, r), counter-clockwise seen from outside of the body. False: it does not look down.
bool facetOf(vec3 p, vec3 q, vec3 r, out Facet facet) {
  const float kLeastArea = 1e-9;  // twice the share of a cell
  vec3 ab = r - p, ac = q - p;    // seen from above it turns the other way
  float area = ab.x * ac.y - ac.x * ab.y;
  facet = Facet(p, r, q, q, vec2(ab.z * ac.y - ac.z * ab.y, ab.x * ac.z - ac.x * ab.z) / area);
  return area >= kLeastArea;
}

vec3 inCells(MeshView view, Vertex v) { return vec3(vec2(v.at) / float(1 << view.subpixel_bits) + 0.5, -v.z); }

bool touches(Tile tile, Facet facet) {
  Box cells = cellsAround(tile, vec3[4](facet.a, facet.b, facet.c, facet.d));
  return deepestOf(facet) > 0.0 && isAny(cells);
}

// Lists the triangles of a quad that touch, or both as one facet where they lie in one plane that no level cuts.
void listFacets(Tile tile, MeshView view, uint quad) {
  const float kPlanar = 2e-9;  // m, the rounding of heights
  Vertex vertices[4];
  fetchQuad(view, quad, vertices[0], vertices[1], vertices[2], vertices[3]);
  vec3 p = inCells(view, vertices[0]), q = inCells(view, vertices[1]), r = inCells(view, vertices[2]), s = inCells(view, vertices[3]);
  Facet one, other;
  bool first = facetOf(p, q, r, one), second = facetOf(r, q, s, other);
  first = first && touches(tile, one);
  second = second && touches(tile, other);
  float least = min(min(p.z, q.z), min(r.z, s.z)), deepest = max(max(p.z, q.z), max(r.z, s.z));
  bool is_one = first && second && least > 0.0 && deepest <= THICKNESS && (NUM_ROWS > 0 || deepest <= -tile.z_floor) &&
                abs(one.a.z + dot(one.slope, s.xy - one.a.xy) - s.z) < kPlanar;
  uint count = (first ? 1u : 0u) + (second && !is_one ? 1u : 0u);
  if (count == 0) return;
  uint at = atomicAdd(num_listed_facets, count);
  if (first) listed_facets[at++] = 4u * quad + (is_one ? kWholeQuad : kFirstTriangle);
  if (second && !is_one) listed_facets[at] = 4u * quad + kSecondTriangle;
}

Facet listedFacet(Tile tile, MeshView view, uint number) {
  uint item = listed_facets[number], which = item & 3u;
  Vertex vertices[4];
  fetchQuad(view, item >> 2, vertices[0], vertices[1], vertices[2], vertices[3]);
  vec3 p = inCells(view, vertices[0]), q = inCells(view, vertices[1]), r = inCells(view, vertices[2]), s = inCells(view, vertices[3]);
  Facet facet;
  bool second = which == kSecondTriangle;
  facetOf(second ? r : p, q, second ? s : r, facet);
  if (which == kWholeQuad) facet = Facet(p, r, s, q, facet.slope);
  return facet;
}

// A quad that listQuads() or, from `first` on, find_candidates.comp has found.
uint quadNumbered(uint i, bool is_candidate, uint first) { return is_candidate ? wordOfFours(CandidateQuads, first + i) : listedQuad(i); }

// Adds quads that quadNumbered() gives, from 0 to `count`. All invocations call it.
void addQuads(Tile tile, MeshView view, bool is_candidate, uint first, uint count, inout Found found) {
  bool large = isDrawn(kByLargeSums, view.large);
  uint start = 0;
  if (start < count) do {
      if (gl_LocalInvocationIndex == 0) num_listed_facets = 0;
      workgroupBarrier();
      uint end = min(start + kQuadsPerChunk, count);
      uint i = start + gl_LocalInvocationIndex;
      do {
        if (i < end) listFacets(tile, view, quadNumbered(i, is_candidate, first));
        i += WORKGROUP;
      } while (i - gl_LocalInvocationIndex < end);
      workgroupBarrier();
      if ((TRIANGLE_SIZES & kBySums) != 0) {
        uint end_facet = large ? 0u : num_listed_facets, f = gl_LocalInvocationIndex;
        do {
          if (f < end_facet) addFacet(tile, listedFacet(tile, view, f), found);
          f += WORKGROUP;
        } while (f - gl_LocalInvocationIndex < end_facet);
      }
      if ((TRIANGLE_SIZES & kByLargeSums) != 0) {
        for (uint f = large ? 0 : num_listed_facets; f < num_listed_facets; ++f) addLargeFacet(tile, listedFacet(tile, view, f), found);
      }
      workgroupBarrier();
      start += kQuadsPerChunk;
    } while (start < count);
}
#endif
