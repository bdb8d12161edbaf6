// Area sampling of spheres, capsules and lying cylinders: cells inside of the contact by five rays, cells on its edge by scan lines.
//
// Where all corners and the middle of a cell touch and the surface is smooth, the mean of a quadratic surface is (2 middle + mean of the corners) / 3. A convex
// solid is over the whole cell no lower than 2 middle - highest corner; where that is over the skin, nothing touches. The other cells are listed, and kScanLines
// lines through each, along y, are integrated by Gauss's rule with two nodes in each of three pieces of what touches (depth/area/chords.glsl). Twin:
// src/reference/mean_depth.cpp.
// Shared memory: 4 TILE_SAMPLES + 4 bytes.

const uint kScanLines = 8u;
const float kSmooth = 0.003;         // of a quartic surface: the error of the quadratic is then below this share
const float kGauss = 0.5773502692;   // nodes of Gauss's rule on [-1, 1]

shared uint edge_cells[AREA && kHasAnalytic ? TILE_SAMPLES : 1u];
shared uint num_edge_cells;

// Height (m) of the solid's lowest surface over a place of P; kMiss without one.
float heightAt(Tile tile, Solid solid, vec2 xy, inout Found found) {
  float z = analyticHeight(solid.kind, solid.parameters, solid.X_PO, xy, tile.z_floor, found);
  bool below_floor = NUM_ROWS == 0 && z < tile.z_floor;
  found.below_floor = found.below_floor || below_floor;
  return below_floor ? kMiss : z;
}

float depthUnder(Tile tile, float z) { return clamp(tile.level - z, 0.0, THICKNESS); }

// The cells of the tile that a solid within the radius of its axis may touch: the axis is cut where it is more than the radius over the skin, and the lowest
// point of what is left reaches farthest.
Box touchedCells(Tile tile, Solid solid) {
  float radius = solid.parameters.x, half_length = isKind(solid.kind, kKindSphere) ? 0.0 : solid.parameters.y;
  vec3 low = apply(solid.X_PO, vec3(0, 0, -half_length)), high = apply(solid.X_PO, vec3(0, 0, half_length));
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

// Adds one scan line of the cell at `at`.
void addScanLine(Tile tile, Solid solid, Tube tube, vec2 at, uint line, uint address, inout Found found) {
  vec2 start = samplePosition(tile, at + vec2((float(line) + 0.5) / float(kScanLines) - 0.5, -0.5));
  float x = start.x, end = start.y + tile.spacing.y;
  vec4 chord = clamp(chordOf(tube, isKind(solid.kind, kKindCylinder), x), start.y, end);
  float sum = 0.0, per_line = 1.0 / (float(kScanLines) * tile.spacing.y);
  if (chord.x >= chord.w) return;
  for (uint k = 0; k < 6; ++k) {
    uint piece = k >> 1;
    float middle = 0.5 * (chord[piece] + chord[piece + 1]), half_length = 0.5 * (chord[piece + 1] - chord[piece]);
    float y = middle + ((k & 1u) != 0 ? kGauss : -kGauss) * half_length;
    sum += half_length * depthUnder(tile, heightAt(tile, solid, vec2(x, y), found));
  }
  addToCell(tile, address, sum * per_line, (chord.w - chord.x) * per_line, false);
}

// Adds the cell at `at` if all of it is smooth contact. False: it needs scan lines.
bool addSmoothCell(Tile tile, Solid solid, vec2 at, uint address, inout Found found) {
  float z = heightAt(tile, solid, samplePosition(tile, at), found), highest = z, corners = 0.0, middle = depthUnder(tile, z);
  for (uint k = 0; k < 4; ++k) {
    float z_corner = heightAt(tile, solid, samplePosition(tile, at + vec2(k & 1u, k >> 1) - 0.5), found);
    highest = max(highest, z_corner);
    corners += 0.25 * depthUnder(tile, z_corner);
  }
  if (highest < kMiss && 2.0 * z - highest > tile.level) return true;
  float bend = abs(corners - middle);  // of a quadratic; it makes a quartic of the order of bend^3 / spacing^2
  if (highest >= tile.level || bend * bend * bend > kSmooth * middle * tile.sample_area) return false;
  addToCell(tile, address, (2.0 * middle + corners) * (1.0 / 3.0), 1.0, false);
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
  Tube tube = tubeOf(tile, solid);
  for (; i < count; i += WORKGROUP) {
    uint cell = edge_cells[i / kScanLines];
    uvec2 at = uvec2(cell >> 16, cell & 0xFFFFu);
    addScanLine(tile, solid, tube, tile.first + vec2(at), i % kScanLines, at.x * tile.stride + at.y, found);
  }
  checkLoop(i < count);
}
