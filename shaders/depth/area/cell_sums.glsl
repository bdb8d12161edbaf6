// Area sampling: sums over the cells of a tile, for one object at a time. Sums are integers, so that the order of facets does not matter.
//
//   closed mesh, box                    facets.glsl
//   torus                               a mesh of its own, as a closed mesh
//   half-space, cone, upright cylinder  solid_cells.glsl, by facets
//   sphere, capsule, lying cylinder     solid_cells.glsl, cell by cell
//   mesh that is not closed             as with point sampling, depth/raster.glsl
//
// With ONE_VECTOR two sums are one word of 64 bits (driver/README.md): the second sum, plus 2^32 times the first. Otherwise, where an
// instance has one slot, the sums of volume and share begin at the words of an empty tile: they take no more shared memory, so that a GPU's
// core has room for more workgroups.
// Shared memory: 8 TILE_SAMPLES with ONE_VECTOR or MANY_SLOTS, else 0; 12 TILE_SAMPLES with VARIATION.
// Reference: src/reference/area_depth.cpp.
#ifndef DEPTH_AREA_CELL_SUMS_GLSL
#define DEPTH_AREA_CELL_SUMS_GLSL
#include "depth/tile_heights.glsl"

const float kVolumeUnits = 134217728.0;  // units per cell area times Tile::deepest; 2^27 leaves room for sixteen surfaces above each other
const float kCoveredUnits = 1048576.0;   // units per cell area
const float kLeastDepth = 1e-9;          // m

// A list of cells that need more work than the others.
const uint kMostListed = (TILE_SAMPLES + 3u) / 4u;
shared uint listed_cells[AREA ? kMostListed : 1u];

shared uint cell_squares[VARIATION ? TILE_SAMPLES : 1u];

#ifdef ONE_VECTOR
#extension GL_EXT_shader_atomic_int64 : require
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
shared int64_t cell_volumes[AREA ? TILE_SAMPLES : 1u];       // and the covered share
shared int64_t cell_moments[VARIATION ? TILE_SAMPLES : 1u];  // along x, and along y

int64_t packedSums(ivec2 sums) { return packInt2x32(ivec2(sums.y, sums.x + (sums.y >> 31))); }
ivec2 unpackedSums(int64_t word) {
  ivec2 words = unpackInt2x32(word);
  return ivec2(words.y - (words.x >> 31), words.x);
}

// Adds to volume and covered share. `alone`: no two invocations add to one cell at a time.
void addVolume(uint address, ivec2 more, bool alone) {
  if (alone) {
    cell_volumes[address] += packedSums(more);
  } else {
    atomicAdd(cell_volumes[address], packedSums(more));
  }
}

ivec2 volumeOf(uint address) { return unpackedSums(cell_volumes[address]); }
void clearVolume(uint address) { cell_volumes[address] = int64_t(0); }

void addMoment(uint address, ivec2 more) { atomicAdd(cell_moments[address], packedSums(more)); }
ivec2 momentOf(uint address) { return unpackedSums(cell_moments[address]); }
void clearMoment(uint address) { cell_moments[address] = int64_t(0); }
#else
shared uint cell_volumes[AREA && MANY_SLOTS ? TILE_SAMPLES : 1u];
shared uint cell_covered[AREA && MANY_SLOTS ? TILE_SAMPLES : 1u];
shared uint cell_moments[VARIATION ? 2u * TILE_SAMPLES : 1u];

void addVolume(uint address, ivec2 more, bool alone) {
  if (MANY_SLOTS) {
    atomicAdd(cell_volumes[address], uint(more.x));
    atomicAdd(cell_covered[address], uint(more.y));
  } else {
    atomicAdd(tile_heights[address], uint(more.x));
    atomicAdd(cell_shares[address], uint(more.y));
  }
}

ivec2 volumeOf(uint address) {
  return MANY_SLOTS ? ivec2(cell_volumes[address], cell_covered[address])
                    : ivec2(tile_heights[address] - kEmpty, cell_shares[address] - kWhole);
}

void clearVolume(uint address) {
  if (MANY_SLOTS) {
    cell_volumes[address] = cell_covered[address] = 0;
  } else if (!keepsShares()) {
    cell_shares[address] = kWhole;
  }
}

void addMoment(uint address, ivec2 more) {
  atomicAdd(cell_moments[2u * address], uint(more.x));
  atomicAdd(cell_moments[2u * address + 1u], uint(more.y));
}
ivec2 momentOf(uint address) { return ivec2(cell_moments[2u * address], cell_moments[2u * address + 1u]); }
void clearMoment(uint address) { cell_moments[2u * address] = cell_moments[2u * address + 1u] = 0; }
#endif

void clearSums(uint address) {
  clearVolume(address);
  if (!VARIATION) return;
  cell_squares[address] = 0;
  clearMoment(address);
}

// Integrals over a part of a cell, per area of the cell. Positions are in widths of the cell, from its middle.
struct CellSums {
  float volume;   // integral of the depth, m
  float covered;  // covered share
  float square;   // integral of the square of the depth, m^2; like the moment only with VARIATION
  vec2 moment;    // integral of depth times position, m
};

void addSums(inout CellSums sums, CellSums more, float factor) {
  sums.volume += factor * more.volume;
  sums.covered += factor * more.covered;
  if (!VARIATION) return;
  sums.square += factor * more.square;
  sums.moment += factor * more.moment;
}

void divideSums(inout CellSums sums, float by) {
  sums.volume /= by;
  sums.covered /= by;
  if (!VARIATION) return;
  sums.square /= by;
  sums.moment /= by;
}

// Adds integrals to the sums of a cell. `alone`: no two invocations add to one cell at a time.
void addToSums(Tile tile, uint address, CellSums sums, bool subtract, bool alone) {
  float units = kVolumeUnits / tile.deepest;
  ivec2 more = ivec2(round(vec2(sums.volume * units, sums.covered * kCoveredUnits)));
  if (VARIATION) {
    float side = subtract ? -units : units;
    atomicAdd(cell_squares[address], uint(int(round(sums.square * side / tile.deepest))));
    addMoment(address, ivec2(round(sums.moment * side)));
  }
  addVolume(address, subtract ? -more : more, alone);
}

// The integrals of a cell; its sums begin anew.
CellSums takeSums(Tile tile, uint address) {
  float unit = tile.deepest / kVolumeUnits;
  ivec2 volume = volumeOf(address);
  CellSums sums = CellSums(float(volume.x) * unit, float(volume.y) * (1.0 / kCoveredUnits), 0.0, vec2(0));
  if (VARIATION) {
    sums.square = float(int(cell_squares[address])) * unit * tile.deepest;
    sums.moment = vec2(momentOf(address)) * unit;
  }
  clearSums(address);
  return sums;
}

void clearHeights() {
  for (uint address = gl_LocalInvocationIndex; address < TILE_SAMPLES; address += WORKGROUP) {
    tile_heights[address] = kEmpty;
    if (AREA) {
      cell_shares[address] = kWhole;
      clearSums(address);
    }
    if (VARIATION) cell_variations[address] = 0;
  }
}
#endif
