// The tile of a patch that a workgroup computes: a rectangle of whole taxels and their samples, in the patch's frame P. Lengths in m.
// In: patches, tiles (shared/sensor.h).

struct Tile {
  Affine X_PS;        // patch from sensor
  vec2 spacing;       // of samples
  float sample_area;  // m^2
  float force_area;   // m^2: sample_area times the instance's factor on the skin's stiffness
  vec2 corner;        // of sample (0, 0) of the patch, in P
  uvec4 grid;         // of the patch, PatchRecord
  uvec2 first_taxel;  // row and column in the patch
  uvec2 size;         // in taxels
  uint stride;        // samples of a row
  vec2 first, end;    // in samples of the patch, half-open
  float z_limit;      // surfaces at or above cannot touch
  float z_floor;      // surfaces below are the far side of the body and are ignored
  float z_base;       // that the heights of the tile count from
  float level;        // of the undeformed skin, below a float's resolution of the poses: what a load search adds to depths
  float deepest;      // of the object whose cells are summed, at most, m; depth/area/cell_depths.glsl
  float offset_z;     // by which a load search over several tiles has moved the objects along z of S
};

// Samples of the tile: first and last row and column, inclusive; empty where a last is before its first.
struct Box {
  ivec2 first, last;
};

bool isAny(Box box) { return box.first.x <= box.last.x && box.first.y <= box.last.y; }
uint areaOf(Box box) { return isAny(box) ? uint(box.last.x - box.first.x + 1) * uint(box.last.y - box.first.y + 1) : 0u; }
Box noSamples() { return Box(ivec2(0x7FFFFFFF), ivec2(-1)); }

void grow(inout Box box, Box other) {
  box.first = min(box.first, other.first);
  box.last = max(box.last, other.last);
}

vec2 samplePosition(Tile tile, vec2 sample_index) { return tile.corner + sample_index * tile.spacing; }

// Up to which height over the skin surfaces count for the slope of depth, m.
float cellReach(Tile tile) { return SAMPLES > 1 ? max(tile.spacing.x, tile.spacing.y) : 0.0; }

// `number`: of the tile in the sensor.
Tile loadTile(uint number) {
  Tile tile;
  uvec4 place = uvec4(0), size = uvec4(NUM_ROWS, NUM_COLS, 0, 0);
  if (NUM_TILES > 1 || NUM_ROWS == 0) {
    place = tiles[number].place;
    size = tiles[number].size;
  }
  tile.grid = uvec4(NUM_ROWS, NUM_COLS, 0, 0);
  tile.spacing = vec2(PITCH_X, PITCH_Y) / float(SAMPLES);
  tile.z_floor = 0.0;
  if (NUM_ROWS == 0) {
    tile.grid = patchRecord(place.x).grid;
    tile.spacing = patchRecord(place.x).spacing.xy;
    tile.z_floor = -patchRecord(place.x).spacing.w;
  }
  tile.sample_area = tile.spacing.x * tile.spacing.y;
  tile.force_area = tile.sample_area;
  tile.X_PS = Affine(vec4(1, 0, 0, 0), vec4(0, 1, 0, 0), vec4(0, 0, 1, 0));
  if (!FLAT) tile.X_PS = Affine(patchRecord(place.x).row0, patchRecord(place.x).row1, patchRecord(place.x).row2);
  tile.corner = -0.5 * vec2(tile.grid.xy * SAMPLES - 1u) * tile.spacing;
  tile.first_taxel = place.yz;
  tile.size = size.xy;
  tile.first = vec2(tile.first_taxel * SAMPLES);
  tile.end = tile.first + vec2(tile.size * SAMPLES);
  tile.stride = tile.size.y * SAMPLES;
  tile.offset_z = 0.0;
  tile.z_limit = OUTPUT_JACOBIAN ? cellReach(tile) : REACH;
  tile.z_base = 0.0;
  tile.level = 0.0;
  tile.deepest = 0.0;
  return tile;
}
