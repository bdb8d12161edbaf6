// Where a mesh's vertices are, seen by the window's samples: (u, v) in units of 2^-subpixel_bits of their spacing, from the tile's first one. Sample (a, b)
// is at (a, b) << subpixel_bits.

int subpixel_bits;  // of the mesh on its way into the tile, ObjectRecord

struct Vertex {
  ivec2 at;
  float z;
};

// First and last sample of the tile from `low` to `high`; none where one is greater.
ivec2 firstSample(ivec2 low) { return max((low + ((1 << subpixel_bits) - 1)) >> subpixel_bits, 0); }
ivec2 lastSample(ivec2 high) { return min(high >> subpixel_bits, ivec2(tile_size * SAMPLES) - 1); }
