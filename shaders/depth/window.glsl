// The window of samples that a workgroup looks at: a tile of the sensor, in the frame of its patch. Needs the sensor's patches and tiles.

Affine X_PS;         // patch from sensor
vec2 spacing;        // of samples, m
float sample_area;   // m^2
vec2 patch_corner;   // of sample (0, 0), in P, m
uvec4 grid;          // of the patch, PatchRecord
uvec2 tile_taxel;    // first one of the tile
uvec2 tile_size;     // in taxels
uint tile_stride;    // samples of a row
vec2 tile_first, tile_end;  // in samples of the patch, half-open
float z_limit;       // m: surfaces at or above cannot touch
float z_floor;       // m: surfaces below are at the far side of the body, and not seen
float offset_z;      // by which a load search over several tiles has moved the objects along z of S, m

// Samples of the tile, first and last row and column; none where a last is before its first.
struct Box {
  ivec2 first, last;
};

bool isAny(Box box) { return box.first.x <= box.last.x && box.first.y <= box.last.y; }
Box noSamples() { return Box(ivec2(0x7FFFFFFF), ivec2(-1)); }

void grow(inout Box box, Box other) {
  box.first = min(box.first, other.first);
  box.last = max(box.last, other.last);
}

// How far over the skin surfaces tell the slope of depth, m.
float cellReach() { return SAMPLES > 1 ? max(spacing.x, spacing.y) : 0.0; }

// Goes to a tile: the whole patch, or a part of one.
void enterWindow(uint tile_number) {
  uvec4 place = uvec4(0), size = uvec4(NUM_ROWS, NUM_COLS, 0, 0);
  if (NUM_TILES > 1 || NUM_ROWS == 0) {
    place = tiles[tile_number].place;
    size = tiles[tile_number].size;
  }
  grid = uvec4(NUM_ROWS, NUM_COLS, 0, 0);
  spacing = vec2(PITCH_X, PITCH_Y) / float(SAMPLES);
  if (NUM_ROWS == 0) {
    grid = patches[place.x].grid;
    spacing = patches[place.x].spacing.xy;
    z_floor = -patches[place.x].spacing.w;
  }
  sample_area = spacing.x * spacing.y;
  X_PS = Affine(vec4(1, 0, 0, 0), vec4(0, 1, 0, 0), vec4(0, 0, 1, 0));
  if (!FLAT) X_PS = Affine(patches[place.x].row0, patches[place.x].row1, patches[place.x].row2);
  patch_corner = -0.5 * vec2(grid.xy * SAMPLES - 1u) * spacing;
  tile_taxel = place.yz;
  tile_size = size.xy;
  tile_first = vec2(tile_taxel * SAMPLES);
  tile_end = tile_first + vec2(tile_size * SAMPLES);
  tile_stride = tile_size.y * SAMPLES;
  offset_z = 0.0;
  z_limit = OUTPUT_JACOBIAN ? cellReach() : REACH;
}
