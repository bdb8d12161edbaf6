// Area sampling of closed meshes: the triangles that look down are clipped at the level of the skin, and add their exact integrals to the cells that they
// cover (depth/area/edge_sums.glsl, depth/area/cell_depths.glsl). Coordinates (u, v): cell (a, b) of the tile is [a, a + 1] x [b, b + 1].

// A triangle that looks down, counter-clockwise in (u, v); z is the depth under the skin, m.
struct Facet {
  vec3 a, b, c;
  vec2 slope;  // of the depth, m per cell
};

// What the part of a facet that is deeper than a level does to the integral of clamp(depth, 0, THICKNESS).
const uint kPressed = 0u;  // deeper than 0: adds its depth
const uint kBeyond = 1u;   // deeper than THICKNESS: subtracts the depth beyond it
const uint kUnseen = 2u;   // deeper than the tile sees, Tile::z_floor: subtracts THICKNESS

vec3 atLevel(vec3 p, vec3 q, float level) { return mix(p, q, (level - p.z) / (q.z - p.z)); }

// `first`, `step`: which of the cells the invocation takes.
void addPart(Tile tile, Facet facet, uint part, uint first, uint step) {
  float level = part == kPressed ? 0.0 : part == kBeyond ? THICKNESS : tile.level - tile.z_floor;
  vec3 a = facet.a, b = facet.b, c = facet.c;
  bvec3 deeper = greaterThan(vec3(a.z, b.z, c.z), vec3(level));
  if (!any(deeper)) return;
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
  vec3 corners[4] = vec3[4](a, b, c, c);
  if (!all(deeper)) {
    vec3 ca = atLevel(c, a, level), bc = atLevel(b, c, level);
    corners = deeper.z ? vec3[4](bc, c, ca, ca) : vec3[4](a, b, bc, ca);
  }
  vec3 low = min(min(corners[0], corners[1]), min(corners[2], corners[3])), high = max(max(corners[0], corners[1]), max(corners[2], corners[3]));
  ivec2 first_cell = max(ivec2(floor(low.xy)), 0), last_cell = min(ivec2(floor(high.xy)), ivec2(tile.size * SAMPLES) - 1);
  if (first_cell.x > last_cell.x || first_cell.y > last_cell.y) return;
  ivec2 size = last_cell - first_cell + 1;
  vec2 rates[4];
  for (uint k = 0; k < 4; ++k) rates[k] = ratesOf(corners[k].xy, corners[(k + 1) & 3].xy);
  uint i = first;
  for (; i < uint(size.x * size.y); i += step) {
    ivec2 cell = first_cell + ivec2(cellNumbered(i, uint(size.y)));
    vec2 corner = vec2(cell);
    vec3 sums = vec3(0);
    for (uint k = 0; k < 4; ++k) addEdge(corners[k].xy - corner, corners[(k + 1) & 3].xy - corner, rates[k], sums);
    if (sums.x <= 0.0) continue;
    // The integral of a plane is the area times its value at the centroid, which lies between those at the corners.
    vec2 middle = corner + sums.yz / sums.x;
    float depth = part == kUnseen ? THICKNESS : clamp(facet.a.z + dot(facet.slope, middle - facet.a.xy), low.z, high.z);
    uint address = uint(cell.x) * tile.stride + uint(cell.y);
    addToCell(tile, address, sums.x * (part == kBeyond ? depth - THICKNESS : depth), part == kBeyond ? 0.0 : sums.x, part != kPressed);
  }
  checkLoop(i < uint(size.x * size.y));
}

// Adds the triangle (p, q, r), counter-clockwise seen from outside of the body, if it looks down and touches. `first`, `step`: as in addPart().
void addFacet(Tile tile, vec3 p, vec3 q, vec3 r, uint first, uint step, inout Found found) {
  const float kLeastArea = 1e-9;  // of a cell, twice
  vec3 ab = r - p, ac = q - p;    // seen from above it turns the other way
  float area = ab.x * ac.y - ac.x * ab.y, deepest = max(p.z, max(q.z, r.z));
  if (area < kLeastArea || deepest <= 0.0) return;
  Facet facet = Facet(p, r, q, vec2(ab.z * ac.y - ac.z * ab.y, ab.x * ac.z - ac.x * ab.z) / area);
  addPart(tile, facet, kPressed, first, step);
  if (deepest > THICKNESS) addPart(tile, facet, kBeyond, first, step);
  if (NUM_ROWS > 0 || deepest <= tile.level - tile.z_floor) return;
  addPart(tile, facet, kUnseen, first, step);
  found.below_floor = true;
}

vec3 inCells(Tile tile, MeshView view, Vertex v) { return vec3(vec2(v.at) / float(1 << view.subpixel_bits) + 0.5, tile.level - v.z); }

// All invocations share the cells of a large triangle.
void addTriangle(Tile tile, MeshView view, Vertex p, Vertex q, Vertex r, inout Found found) {
  uint first = view.large ? gl_LocalInvocationIndex : 0u, step = view.large ? WORKGROUP : 1u;
  addFacet(tile, inCells(tile, view, p), inCells(tile, view, q), inCells(tile, view, r), first, step, found);
}
