// The part of a sensor's taxels that carries forces: rectangles of the grid patch, or all taxels in rows of kCols (the last one padded) on
// other sensors.
//
// The includer defines kContactMargin (so far around the taxels that objects reach there are forces before the spread), kSpreadRadius (so
// far these spread) and WHOLE_ARRAY (there are forces everywhere).

const bool kOnePatch = NUM_ROWS > 0;
// Scalars (driver/README.md).
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
  uvec2 first = all_taxels, end = uvec2(0);
  for (uint t = 0; t < NUM_TILES; ++t) {
    uvec4 reached = tileResult(instance * NUM_TILES + t).window;
    if (reached.x < reached.y) {
      first = min(first, reached.xz - min(reached.xz, uvec2(kContactMargin)));
      end = max(end, min(reached.yw + kContactMargin, all_taxels));
    }
  }
  bool touched = end.x > 0;
  // With several tiles, and after passes over the taxels, every taxel's force has been written.
  const bool kWritten = NUM_TILES > 1 || WHOLE_ARRAY;
  window.contact_first = kWritten ? uvec2(0) : first;
  window.contact_count = kWritten ? all_taxels : touched ? end - first : uvec2(0);
  window.first = first - min(first, uvec2(kSpreadRadius));
  window.count = touched ? min(end + kSpreadRadius, all_taxels) - window.first : uvec2(0);
  if (WHOLE_ARRAY || everything) {
    window.first = uvec2(0);
    window.count = all_taxels;
  }
  return window;
}
