// Heights of samples while a taxel's are summed, as words of the tile (depth/tile_heights.glsl), with or without a tile: a batch may change between the two, and
// both give the same bits.

// The one solid of a pass without a tile.
struct OneSolid {
  Body body;
  uint slot;
  vec4 parameters;
};

// Word over the sample at `position` of P. startRow() of its x goes before for a polyhedron.
uint wordOver(Tile tile, OneSolid solid, vec2 position, inout Found found) {
  float z = kOnlyPolyhedra ? heightInRow(position.y, tile.z_floor, found)
                           : analyticHeight(solid.body.kind_groups.x, solid.parameters, solid.body.X_PO, position, tile.z_floor, found);
  bool is_seen = NUM_ROWS > 0 || isVisible(tile, z, found);
  return is_seen ? withSlot(max(z - tile.z_base, 0.0), solid.slot) : kEmpty;
}

// Words at four samples of a row of a taxel, and at the same samples of the rows before and after it; kEmpty beyond the taxel. The tactile Jacobian needs them;
// every word of a tile costs software drivers a scalar load per lane.
struct Neighbours {
  uvec4 before, here, after;
};

// `corner`: first sample of the taxel in the tile; `row`, `first`: of the taxel.
uvec4 wordsOfRow(Tile tile, OneSolid solid, uvec2 corner, uint row, uint first, inout Found found) {
  uvec2 at = corner + uvec2(min(row, SAMPLES - 1u), first);  // -1 wraps to a large number
  vec2 position = samplePosition(tile, tile.first + vec2(at));
  if (!usesTile() && kOnlyPolyhedra) startRow(position.x);
  uvec4 words = uvec4(kEmpty);
  for (uint i = 0; i < 4u; ++i) {
    if (first + i >= SAMPLES) continue;
    words[i] = usesTile() ? tile_heights[at.x * tile.stride + at.y + i] : wordOver(tile, solid, samplePosition(tile, tile.first + vec2(at + uvec2(0, i))), found);
  }
  return mix(uvec4(kEmpty), words, bvec4(row < SAMPLES));
}

Neighbours firstNeighbours(Tile tile, OneSolid solid, uvec2 corner, inout Found found) {
  return Neighbours(uvec4(kEmpty), uvec4(kEmpty), wordsOfRow(tile, solid, corner, 0u, 0u, found));
}

// Those of `row`, from those of the row before it where a row has four samples at most.
void slideNeighbours(Tile tile, OneSolid solid, uvec2 corner, uint row, uint first, inout Neighbours words, inout Found found) {
  words.before = kFoursOfRow == 1u ? words.here : wordsOfRow(tile, solid, corner, row - 1u, first, found);
  words.here = kFoursOfRow == 1u ? words.after : wordsOfRow(tile, solid, corner, row, first, found);
  words.after = wordsOfRow(tile, solid, corner, row + 1u, first, found);
}

// The words before and after sample `i` of the four along its row, where it is the `b`th. Rows of more than four samples have a tile.
uvec2 wordsAlongRow(Neighbours words, uint address, uint i, uint b) {
  uvec2 along = uvec2(kEmpty);
  if (i > 0u) along.x = words.here[i - 1u];
  if (i < 3u) along.y = words.here[i + 1u];
  if (kFoursOfRow > 1u && i == 0u && b > 0u) along.x = tile_heights[address - 1u];
  if (kFoursOfRow > 1u && i == 3u && b + 1u < SAMPLES) along.y = tile_heights[address + 1u];
  return along;
}
