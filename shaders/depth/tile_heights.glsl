// The lowest surface over each sample of a tile: height over Tile::z_base, m, with the slot in its lowest bits (depth/slots.glsl).
//
// The bits of a non-negative float order like the float itself, so atomicMin keeps minima and the order of triangles does not matter. The
// array is empty between two tiles: every tile clears the samples that it has written.
// Shared memory: 4 TILE_SAMPLES + 16 bytes.
#ifndef DEPTH_TILE_HEIGHTS_GLSL
#define DEPTH_TILE_HEIGHTS_GLSL
#include "driver/workgroup.glsl"
#include "depth/slots.glsl"
#include "depth/tile.glsl"

// ---- constants that follow from those of passes/depth.h and leave out the code that a model, sensor or batch does not need ----

const bool kHasMesh = (OBJECT_KINDS & 1u) != 0;
const bool kHasAnalytic = (OBJECT_KINDS & ~1u) != 0;
// Estimated iterations of one invocation: shared/model.h.
const uint kIterationsOfSample = AREA                                       ? kIterationsPerCell
                                 : (OBJECT_KINDS & (1u << kKindTorus)) != 0 ? kIterationsPerSampleOfTorus
                                                                            : kIterationsPerSample;
const uint kIterationsOfTriangle = AREA ? kIterationsPerTriangleOfCells : kIterationsPerTriangle;
const bool kOnlyPolyhedra = OBJECT_KINDS == (1u << kKindPolyhedron);
// Heights go through the tile, except for a single analytic solid, whose heights are computed where they are summed. A torus needs the tile
// since its heights are expensive; the Jacobian needs it where the words of the neighbours of a row of samples do not fit into RowWords,
// skin/tile_pressures.glsl.
const bool kReadsNeighbours = BOTH(OUTPUT_JACOBIAN, SAMPLES > 4u);
bool usesTile() {
  return AREA || kReadsNeighbours || kHasMesh || MANY_SLOTS || SEARCH == kSearchInTile || (OBJECT_KINDS & (1u << kKindTorus)) != 0;
}

// How triangles are drawn: depth/raster.glsl, depth/area/facets.glsl. The constant TRIANGLE_SIZES removes the ways that the model does not
// need, and the test of the only one.
const uint kBySamples = 1u, kBySpans = 2u, kBySums = 4u, kByLargeSums = 8u;
bool isDrawn(uint way, bool wanted) { return TRIANGLE_SIZES == way || ((TRIANGLE_SIZES & way) != 0 && wanted); }

// ---- words of a tile ----

const uint kEmpty = 0x7F7FFFFFu;  // the largest finite float, as bits: no surface over the sample
shared uint tile_heights[TILE_SAMPLES];
shared uint cell_shares[AREA ? TILE_SAMPLES : 1u];  // with AREA, the covered share of a cell as the bits of a float, negative at the skin's
                                                    // full thickness; or its sum
shared uint cell_variations[VARIATION ? TILE_SAMPLES : 1u];  // variationOf(), depth/area/cell_depths.glsl
const uint kWhole = 0x3F800000u;                             // the bits of 1.0
// Whether cells keep their shares for stage 2. If not, it needs to know only which cells are at the full thickness, which Found counts.
bool keepsShares() { return AREA && (MANY_SLOTS || VARIATION || OUTPUT_JACOBIAN || SEARCH == kSearchOverTiles); }
shared int active_box[4];  // first row, last row, first col, last col; not IN_VECTOR

// Surfaces that an invocation has found over the samples of a tile.
struct Found {
  Box samples;       // that surfaces may cover
  bool below_floor;  // a surface below Tile::z_floor, on sensors with several patches
  uint full_cells;   // partly covered cells at the skin's full thickness; without keepsShares()
};

bool isVisible(Tile tile, float z, inout Found found) {
  if (NUM_ROWS > 0) return z < tile.z_limit;
  // Locals, because glslang turns && and || with a member of a struct on the right into branches.
  float z_limit = tile.z_limit, z_floor = tile.z_floor;
  found.below_floor = found.below_floor || z < z_floor;
  return z < z_limit && z >= z_floor;
}

// With AREA a word holds a mean depth (m) instead: the deeper, the lower; kEmpty is none.
const uint kNoDepth = kEmpty & ~(kKeepsSlots ? kSlotMask : 0u);
uint wordOfDepth(float depth, uint slot) { return kNoDepth - withSlot(depth, 0) + (kKeepsSlots ? slot : 0u); }
float depthOfWord(uint word) { return uintBitsToFloat(kNoDepth - (kKeepsSlots ? word & ~kSlotMask : word)); }

void lowerHeight(Tile tile, uint address, float z, uint slot) {
  if (AREA) {
    atomicMin(tile_heights[address], wordOfDepth(clamp(tile.level - z, 0.0, THICKNESS), slot));
    return;
  }
  int height = max(floatBitsToInt(z - tile.z_base), 0);  // the bits of a negative float are a negative integer
  atomicMin(tile_heights[address], withSlot(intBitsToFloat(height), slot));
}

void clearSamples(Tile tile, Box box) {
  if (!isAny(box)) return;
  for (int row = box.first.x + int(gl_LocalInvocationIndex); row <= box.last.x; row += int(WORKGROUP)) {
    uint first = uint(row) * tile.stride + uint(box.first.y), last = first + uint(box.last.y - box.first.y);
    for (uint address = first; address <= last; ++address) {
      tile_heights[address] = kEmpty;
      if (keepsShares()) cell_shares[address] = kWhole;
      if (VARIATION) cell_variations[address] = 0;
    }
  }
}

// The box around the boxes of all invocations, which all call boxAround(). One of them calls startBoxes() before, with a barrier in
// between.
void startBoxes() {
  if (IN_VECTOR) return;
  active_box[0] = active_box[2] = 0x7FFFFFFF;
  active_box[1] = active_box[3] = -1;
}

Box boxAround(Box part) {
  if (IN_VECTOR) {
    ivec4 least = leastOverVector(ivec4(part.first, -part.last));
    return Box(least.xy, -least.zw);
  }
  if (isAny(part)) {
    atomicMin(active_box[0], part.first.x);
    atomicMax(active_box[1], part.last.x);
    atomicMin(active_box[2], part.first.y);
    atomicMax(active_box[3], part.last.y);
  }
  workgroupBarrier();
  return Box(ivec2(active_box[0], active_box[2]), ivec2(active_box[1], active_box[3]));
}
#endif
