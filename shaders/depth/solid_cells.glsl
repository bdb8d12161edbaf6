// Area sampling of analytic solids: cells inside of the contact by five rays, cells on its edge by scan lines.
//
// Where all corners and the middle of a cell touch and the surface is smooth, the mean of a quadratic surface is (2 middle + mean of the corners) / 3. A convex
// solid is over the whole cell no lower than 2 middle - highest corner; where that is over the skin, nothing touches. The other cells are listed, and kScanLines
// lines through each, along y, are integrated: the ends of kScanParts parts show where the line touches, bisection finds the edges, and Gauss's rule with two
// nodes integrates each of kGaussParts parts between them. Twin: src/reference/covered_solids.cpp, by subdivision.
// Shared memory: 4 TILE_SAMPLES + 4 bytes.

const uint kScanLines = 8u;
const uint kScanParts = 4u;
const uint kBisections = 6u;         // of a part: to 1/500 of a cell
const uint kGaussParts = 3u;         // of the contact on a line
const float kSmooth = 0.003;         // of a quartic surface: the error of the quadratic is then below this share
const float kGauss = 0.5773502692;   // nodes of Gauss's rule on [-1, 1]

shared uint edge_cells[AREA && kHasAnalytic ? TILE_SAMPLES : 1u];
shared uint num_edge_cells;

// The solid in a slot.
struct Solid {
  uint kind;
  vec4 parameters;
  Affine X_PO;
};

// Height (m) of the solid's lowest surface at a place of the tile, in samples; kMiss without one.
float solidHeight(Tile tile, Solid solid, vec2 at, inout Found found) {
  float z = analyticHeight(solid.kind, solid.parameters, solid.X_PO, samplePosition(tile, at), tile.z_floor, found);
  bool below_floor = NUM_ROWS == 0 && z < tile.z_floor;
  found.below_floor = found.below_floor || below_floor;
  return below_floor ? kMiss : z;
}

float depthUnder(Tile tile, float z) { return clamp(tile.level - z, 0.0, THICKNESS); }
float solidDepth(Tile tile, Solid solid, vec2 at, inout Found found) { return depthUnder(tile, solidHeight(tile, solid, at, found)); }

// The cells of the tile that a solid within the radius of its axis may touch: the axis is cut where it is more than the radius over the skin, and the lowest
// point of what is left reaches farthest.
Box touchedCells(Tile tile, Solid solid, Body body) {
  if (solid.kind == kKindHalfSpace || solid.kind == kKindTorus) return samplesUnder(tile, body);
  float radius = solid.parameters.x, half_length = solid.kind == kKindSphere ? 0.0 : solid.parameters.y;
  vec3 low = apply(solid.X_PO, vec3(0, 0, solid.kind == kKindCone ? 0.0 : -half_length)), high = apply(solid.X_PO, vec3(0, 0, half_length));
  low.z -= tile.level;
  high.z -= tile.level;
  if (low.z > high.z) { vec3 swap = low; low = high; high = swap; }
  if (low.z >= radius) return noSamples();
  if (high.z > radius) high = mix(low, high, (radius - low.z) / (high.z - low.z));
  float reach = low.z > 0.0 ? sqrt(radius * radius - low.z * low.z) : radius;
  const float kRounding = 1e-3;  // samples
  vec2 first = (min(low.xy, high.xy) - reach - tile.corner) / tile.spacing - tile.first + 0.5 - kRounding;
  vec2 last = (max(low.xy, high.xy) + reach - tile.corner) / tile.spacing - tile.first + 0.5 + kRounding;
  vec2 end = tile.end - tile.first;
  return Box(wholeNumbers(floor(clamp(first, vec2(0), end))), wholeNumbers(floor(clamp(last, vec2(-1), end - 1.0))));
}

// Integral of the depth over one scan line of the cell around `middle`, of a solid that touches the line in one piece.
float scanLine(Tile tile, Solid solid, vec2 middle, uint line, out bool deep, inout Found found) {
  vec2 start = middle + vec2((float(line) + 0.5) / float(kScanLines) - 0.5, -0.5);
  const float kPart = 1.0 / float(kScanParts);
  float first = 2.0, last = -1.0;  // the first and last end of a part that touch
  deep = false;
  for (uint k = 0; k <= kScanParts; ++k) {
    float depth = solidDepth(tile, solid, start + vec2(0, float(k) * kPart), found);
    deep = deep || depth >= THICKNESS;
    if (depth > 0.0) first = min(first, float(k) * kPart);
    if (depth > 0.0) last = float(k) * kPart;
  }
  if (last < 0.0) return 0.0;
  // The edges of the contact lie between these and the next ends, by bisection.
  vec2 touching = vec2(first, last), apart = clamp(touching + vec2(-kPart, kPart), 0.0, 1.0);
  for (uint k = 0; k < kBisections; ++k) {
    vec2 between = 0.5 * (touching + apart);
    for (uint end = 0; end < 2; ++end) {
      if (touching[end] == apart[end]) continue;
      if (solidDepth(tile, solid, start + vec2(0, between[end]), found) > 0.0) {
        touching[end] = between[end];
      } else {
        apart[end] = between[end];
      }
    }
  }
  vec2 edges = 0.5 * (touching + apart);
  float length = (edges.y - edges.x) / float(kGaussParts), sum = 0.0;
  for (uint k = 0; k < 2 * kGaussParts; ++k) {
    float node = float(k >> 1) + 0.5 + ((k & 1u) != 0 ? 0.5 * kGauss : -0.5 * kGauss);
    sum += solidDepth(tile, solid, start + vec2(0, edges.x + node * length), found);
  }
  return 0.5 * sum * length;
}

// Adds the cell at `at` if all of it is smooth contact. False: it needs scan lines.
bool addSmoothCell(Tile tile, Solid solid, vec2 at, uint address, inout Found found) {
  float z = solidHeight(tile, solid, at, found), highest = z, corners = 0.0, middle = depthUnder(tile, z);
  bool deep = middle >= THICKNESS;
  for (uint k = 0; k < 4; ++k) {
    float z_corner = solidHeight(tile, solid, at + vec2(k & 1u, k >> 1) - 0.5, found), depth = depthUnder(tile, z_corner);
    highest = max(highest, z_corner);
    deep = deep || depth >= THICKNESS;
    corners += 0.25 * depth;
  }
  if (solid.kind != kKindTorus && highest < kMiss && 2.0 * z - highest > tile.level) return true;
  float bend = abs(corners - middle);  // of a quadratic; it makes a quartic of the order of bend^3 / spacing^2
  if (highest >= tile.level || bend * bend * bend > kSmooth * middle * tile.sample_area) return false;
  addToCell(address, (2.0 * middle + corners) * (1.0 / 3.0), 1.0, false);
  if (deep) atomicOr(cell_covered[address], kDeepBit);
  return true;
}

// Adds the solid to the cells of a box, touchedCells().
void addSolid(Tile tile, Solid solid, Box box, inout Found found) {
  if (!isAny(box)) return;
  if (gl_LocalInvocationIndex == 0) num_edge_cells = 0;
  workgroupBarrier();
  ivec2 size = box.last - box.first + 1;
  uint count = uint(size.x * size.y), i = gl_LocalInvocationIndex;
  for (; i < count; i += WORKGROUP) {
    uvec2 at = uvec2(box.first) + cellNumbered(i, uint(size.y));
    uint address = at.x * tile.stride + at.y;
    if (!addSmoothCell(tile, solid, tile.first + vec2(at), address, found)) edge_cells[atomicAdd(num_edge_cells, 1u)] = at.x << 16 | at.y;
  }
  checkLoop(i < count);
  workgroupBarrier();
  count = num_edge_cells * kScanLines;
  i = gl_LocalInvocationIndex;
  for (; i < count; i += WORKGROUP) {
    uint cell = edge_cells[i / kScanLines];
    uvec2 at = uvec2(cell >> 16, cell & 0xFFFFu);
    bool deep;
    float depth = scanLine(tile, solid, tile.first + vec2(at), i % kScanLines, deep, found);
    uint address = at.x * tile.stride + at.y;
    if (depth > 0.0) addToCell(address, depth / float(kScanLines), 0.0, false);
    if (deep) atomicOr(cell_covered[address], kDeepBit);
  }
  checkLoop(i < count);
}
