// Product of the influence matrix A with an array of a layer: the displacement (thicknesses) that it causes at a strip of nodes.
//
// A depends on the distance of two nodes only. The table Influence holds its coefficients as (NODE_ROWS x 2 kRowStrips) strips: by the
// distance of the rows, then by that of the strips from -kRowStrips up; the host computes it (src/sensor/elastic_layer.cpp). A strip of
// sources and a strip of results need kStrip^2 products but only 2 kStrip - 1 coefficients, of which half are kept from the strip before.

// Four consecutive values that begin 1, 2 or 3 before those of b; a holds the four before b.
vec4 before1(vec4 a, vec4 b) { return vec4(a.w, b.xyz); }
vec4 before2(vec4 a, vec4 b) { return vec4(a.zw, b.xy); }
vec4 before3(vec4 a, vec4 b) { return vec4(a.yzw, b.x); }

// Product of a strip `x` of sources with the coefficients from `past` on.
vec4 productOf(vec4 x, vec4 past, vec4 next) {
  return x.x * next + x.y * before1(past, next) + x.z * before2(past, next) + x.w * before3(past, next);
}

// Displacement of the nodes of strip `at` under array `array`, summed over the sources.
//
//   coefficient of distance   -4 .. -1    0 .. 3     (result - source, from the distance between the first nodes of the two strips)
//   held in                    past        next
vec4 displacementAt(Window window, uvec2 at, uint array) {
  vec4 w = vec4(0);
  uvec2 rows = rowsAroundSources();
  uint row = rows.x;
  if (row < rows.y) do {
      if (source_strips[row] == 0) continue;
      uint distance = at.x > row ? at.x - row : row - at.x;
      uvec2 range = sourcesOfRow(row);
      uint strip = range.x, end = range.y;
      uint entry = distance * 2 * kRowStrips + kRowStrips + at.y / kStrip - strip;
      uint source = stripAddress(window.layer_start, array, uvec2(row, strip * kStrip));
      vec4 next = floatsOfFour(Influence, entry);
      do {
        // Two strips of sources: some drivers limit the iterations of loops (driver/loops.glsl).
        bool is_pair = strip + 1u < end;
        vec4 past = floatsOfFour(Influence, entry - 1u), before = floatsOfFour(Influence, entry - (is_pair ? 2u : 1u));
        vec4 x = uintBitsToFloat(loadFour(LayerStrips, source)), y = uintBitsToFloat(loadFour(LayerStrips, source + (is_pair ? 1u : 0u)));
        if (!is_pair) y = vec4(0);
        w += productOf(x, past, next) + productOf(y, before, past);
        next = before;
        entry -= 2u;
        source += 2u;
        strip += 2u;
      } while (strip < end);
      checkLoop(strip < end);
    } while (++row < rows.y);
  checkLoop(row < rows.y);
  if (AREA && isSource(at)) w += readStrip(window, kLayerCompliance, at) * readStrip(window, array, at);
  return w;
}
