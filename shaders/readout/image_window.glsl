// The part of a sensor's taxels that carries forces: rectangles of the grid patch, or all taxels in rows of kCols (the last one padded) on other sensors.

const bool kOnePatch = NUM_ROWS > 0;
// Scalars: Mesa 22.3 picks the wrong components where a specialization constant chooses between two vectors.
const uint kCols = kOnePatch ? NUM_COLS : kListCols;
const uint kRows = kOnePatch ? NUM_ROWS : (NUM_TAXELS + kCols - 1) / kCols;

struct ImageWindow {
  uvec2 contact_first, contact_count;  // taxels that contact reaches: first row and column, their numbers
  uvec2 first, count;                  // taxels that forces reach after the spread
};

// `everything`: all taxels are to be read out, wherever contact is.
ImageWindow imageWindow(uint instance, bool everything) {
  ImageWindow window;
  uvec2 all_taxels = uvec2(kRows, kCols);
  if (!kOnePatch) {
    window.contact_first = window.first = uvec2(0);
    window.contact_count = window.count = all_taxels;
    return window;
  }
  const uint kRadius = KERNEL / 2;
  uvec2 first = all_taxels, end = uvec2(0);
  for (uint t = 0; t < NUM_TILES; ++t) {
    uvec4 reached = tile_results[instance * NUM_TILES + t].window;
    if (reached.x < reached.y) {
      first = min(first, reached.xz);
      end = max(end, reached.yw);
    }
  }
  bool touched = end.x > 0;
  // With several tiles, and after passes over the taxels, every taxel's force has been written.
  const bool kWritten = NUM_TILES > 1 || WHOLE_ARRAY;
  window.contact_first = kWritten ? uvec2(0) : first;
  window.contact_count = kWritten ? all_taxels : touched ? end - first : uvec2(0);
  window.first = first - min(first, uvec2(kRadius));
  window.count = touched ? min(end + kRadius, all_taxels) - window.first : uvec2(0);
  if (WHOLE_ARRAY || everything) {
    window.first = uvec2(0);
    window.count = all_taxels;
  }
  return window;
}

// Clears the outputs of the taxels that the step before has written (all of them where it is not known) outside the window. `lane`: of the team.
void clearOutside(uint instance, uint lane, ImageWindow window, bool new_frame) {
  if (!kOnePatch) return;
  uvec4 before = KEEPS_WINDOW ? image_windows[instance] : uvec4(0, 0, kRows, kCols);
  uvec2 first = before.xy, count = before.zw;
  bool covered = all(greaterThanEqual(first, window.first)) && all(lessThanEqual(first + count, window.first + window.count));
  uint num_rows = covered ? 0 : count.x;
  uint i = lane;
  for (; i < num_rows; i += TEAM) {
    uint j = 0;
    for (; j < count.y; ++j) {
      uvec2 at = first + uvec2(i, j);
      if (all(lessThan(at - window.first, window.count))) continue;
      uint t = instance * NUM_TAXELS + at.x * kCols + at.y;
      if (OUTPUT_NORMAL) spread_normal[t] = 0.0;
      if (SHEAR) spread_shear[2 * t] = spread_shear[2 * t + 1] = 0.0;
      if (new_frame) image[t] = 0;
    }
    checkLoop(j < count.y);
  }
  checkLoop(i < num_rows);
}
