// Product of the influence matrix A with an array of a layer: the displacement (thicknesses) that it causes at a strip of nodes.
//
// A depends on the distance of two nodes only. The table Influence holds its coefficients as (NODE_ROWS x 2 kRowStrips) strips: by distance of the rows, then
// by distance of the strips from -kRowStrips up; the host computes it (src/sensor/elastic_layer.cpp). A strip of sources and a strip of results need kStrip^2
// products but only 2 kStrip - 1 coefficients, of which half are kept from the strip before.

// Four consecutive values that begin 1, 2 or 3 before those of b; a holds the four before b.
vec4 before1(vec4 a, vec4 b) { return vec4(a.w, b.xyz); }
vec4 before2(vec4 a, vec4 b) { return vec4(a.zw, b.xy); }
vec4 before3(vec4 a, vec4 b) { return vec4(a.yzw, b.x); }

Strip readInfluence(uint number) {
  return Strip(floatsOfFour(Influence, 2 * number), floatsOfFour(Influence, 2 * number + 1));
}

// Displacement of the nodes of strip `at` under array `array`, summed over the sources.
//
//   coefficient of distance   -8 .. -5   -4 .. -1    0 .. 3    4 .. 7     (result - source, between the first nodes of the two strips)
//   held in                    past.low  past.high   next.low  next.high
Strip displacementAt(Window window, uvec2 at, uint array) {
  Strip w = strip(0.0);
  uint row = source_rows[0], end_row = source_rows[1];
  for (; row < end_row; ++row) {
    uint distance = at.x > row ? at.x - row : row - at.x;
    uint k = source_first[row], end = source_end[row];
    uint entry = distance * 2 * kRowStrips + kRowStrips + at.y - k;
    uint source = stripAddress(window.layer_start, array, uvec2(row, k));
    Strip next = readInfluence(entry);
    for (; k < end; ++k) {
      Strip past = readInfluence(--entry);
      vec4 x = floatsOf(layer[source], layer[source + 1]), y = floatsOf(layer[source + 2], layer[source + 3]);
      source += kStripPairs;
      vec4 middle1 = before1(past.high, next.low), middle2 = before2(past.high, next.low), middle3 = before3(past.high, next.low);
      w.low += x.x * next.low + x.y * middle1 + x.z * middle2 + x.w * middle3 + y.x * past.high + y.y * before1(past.low, past.high) +
               y.z * before2(past.low, past.high) + y.w * before3(past.low, past.high);
      w.high += x.x * next.high + x.y * before1(next.low, next.high) + x.z * before2(next.low, next.high) + x.w * before3(next.low, next.high) +
                y.x * next.low + y.y * middle1 + y.z * middle2 + y.w * middle3;
      next = past;
    }
    checkLoop(k < end);
  }
  checkLoop(row < end_row);
  if (AREA && at.y >= source_first[at.x] && at.y < source_end[at.x]) {
    w = sumOf(w, productOf(readStrip(window, kLayerCompliance, at), readStrip(window, array, at)));
  }
  return w;
}
