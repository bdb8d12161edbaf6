// Vertices of a mesh seen from a tile: (u, v) in units of 2^-subpixel_bits of the samples' spacing, from the tile's first sample; z in m,
// in P. Sample (a, b) is at (a, b) << subpixel_bits.

struct Vertex {
  ivec2 at;
  float z;
};

// How the mesh in one slot is seen from a tile.
struct MeshView {
  Affine from_lattice;  // from the mesh's lattice to (u, v, z)
  int subpixel_bits;    // ObjectRecord
  bool large;           // the mesh has large triangles, ObjectRecord
  bool closed;          // and is closed; with AREA
  uint slot;
  ivec2 motion_low, motion_high;  // by how much the mesh may still move along u and v, in units; 0 in the contact pass
};

// First and last sample of the tile between `low` and `high`, in units; none where one is greater.
ivec2 firstSample(MeshView view, ivec2 low) { return max((low + ((1 << view.subpixel_bits) - 1)) >> view.subpixel_bits, 0); }
ivec2 lastSample(Tile tile, MeshView view, ivec2 high) { return min(high >> view.subpixel_bits, ivec2(tile.size * SAMPLES) - 1); }

// The same for the samples that reach between them, depth/bodies.glsl.
int reachOf(MeshView view) { return AREA ? 1 << view.subpixel_bits >> 1 : 0; }
ivec2 firstReaching(MeshView view, ivec2 low) { return firstSample(view, low - reachOf(view)); }
ivec2 lastReaching(Tile tile, MeshView view, ivec2 high) { return lastSample(tile, view, high + reachOf(view)); }
