// Nodes of an elastic layer in strips of kStrip: reading and writing them, sums over them, which are touched, and what they are moved by others. Included by
// elastic_layer.comp, whose names it uses.

struct Strip {
  vec4 low, high;
};

Strip strip(float value) { return Strip(vec4(value), vec4(value)); }

vec4 floatsOf(Pair a, Pair b) { return uintBitsToFloat(uvec4(wordsOf(a), wordsOf(b))); }

uint layer_start;  // of the instance, in pairs

uint stripAddress(uint kind, uvec2 at) { return layer_start + kind * kArrayPairs + (at.x * kRowStrips + at.y) * kStripPairs; }

Strip readStrip(uint kind, uvec2 at) {
  uint address = stripAddress(kind, at);
  return Strip(floatsOf(layer[address], layer[address + 1]), floatsOf(layer[address + 2], layer[address + 3]));
}

void writeStrip(uint kind, uvec2 at, Strip values) {
  uint address = stripAddress(kind, at);
  uvec4 low = floatBitsToUint(values.low), high = floatBitsToUint(values.high);
  layer[address] = pairOf(low.xy);
  layer[address + 1] = pairOf(low.zw);
  layer[address + 2] = pairOf(high.xy);
  layer[address + 3] = pairOf(high.zw);
}

float sumOf(Strip s) { return dot(s.low + s.high, vec4(1)); }
float dotOf(Strip a, Strip b) { return dot(a.low, b.low) + dot(a.high, b.high); }
float largestOf(Strip s) {
  vec4 four = max(s.low, s.high);
  return max(max(four.x, four.y), max(four.z, four.w));
}
// 1 where a value is positive, else 0.
Strip whereAbove(Strip s, float limit) { return Strip(vec4(greaterThan(s.low, vec4(limit))), vec4(greaterThan(s.high, vec4(limit)))); }

// What every invocation wrote into the layer and into shared memory is there for all.
void meet() {
  workgroupBarrierWithBuffers();
}

// Totals of partial[] over `count` of them in a fixed order; every invocation gets them.
vec4 sumOfPartials(uint count) {
  meet();
  vec4 total = vec4(0);
  for (uint v = 0; v < count; ++v) total += partial[v];
  workgroupBarrier();
  return total;
}

float largestOfPartials(uint count) {
  meet();
  float largest = kNever;
  for (uint v = 0; v < count; ++v) largest = max(largest, partial[v].x);
  workgroupBarrier();
  return largest;
}

// ---- windows and sources ----

// The window: strips that can be touched. Of each of its rows as many, beginning where the row's own do, so that a line across the array is no rectangle.
uvec2 window_rows;  // first, how many
uint window_width;  // strips of a row
uint num_strips;    // in the window
uint num_parts;     // partial sums that it needs

uvec2 stripAt(uint k) {
  uint row = window_rows.x + k / window_width;
  return uvec2(row, window_first[row] + k % window_width);
}

void setWindow(uvec2 rows, uint width) {
  window_rows = rows;
  window_width = max(width, 1u);
  num_strips = rows.y * width;
  num_parts = min(LANES, num_strips);
}

// Sources: strips over which an array is not zero.
void clearSources() {
  for (uint row = gl_LocalInvocationIndex; row < NODE_ROWS; row += WORKGROUP) {
    source_first[row] = kRowStrips;
    source_end[row] = 0;
  }
  if (gl_LocalInvocationIndex == 0) {
    source_rows[0] = NODE_ROWS;
    source_rows[1] = 0;
    widest = 0;
  }
  meet();
}

void addSource(uvec2 at) {
  atomicMin(source_first[at.x], at.y);
  atomicMax(source_end[at.x], at.y + 1u);
  atomicMin(source_rows[0], at.x);
  atomicMax(source_rows[1], at.x + 1u);
}

// ---- displacements ----

// Four neighbours that begin 1, 2 or 3 before those of b; a comes before b.
vec4 before1(vec4 a, vec4 b) { return vec4(a.w, b.xyz); }
vec4 before2(vec4 a, vec4 b) { return vec4(a.zw, b.xy); }
vec4 before3(vec4 a, vec4 b) { return vec4(a.yzw, b.x); }

// Of a strip of the table.
Strip readInfluence(uint number) {
  return Strip(floatsOfFour(Influence, 2 * number), floatsOfFour(Influence, 2 * number + 1));
}

// Displacement of the nodes of strip `at` under array `kind`, over its sources.
//
//   coefficient of distance   -8 .. -5   -4 .. -1    0 .. 3    4 .. 7     (result - source, between the beginnings of the two strips)
//   held in                    past.low  past.high   next.low  next.high
Strip displacementAt(uvec2 at, uint kind) {
  Strip w = strip(0.0);
  uint row = source_rows[0], end_row = source_rows[1];
  for (; row < end_row; ++row) {
    uint distance = at.x > row ? at.x - row : row - at.x;
    uint k = source_first[row], end = source_end[row];
    // A row of the table has the distances from -kRowStrips strips up.
    uint entry = distance * 2 * kRowStrips + kRowStrips + at.y - k;
    uint source = stripAddress(kind, uvec2(row, k));
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
    cut_short = cut_short || k < end;
  }
  cut_short = cut_short || row < end_row;
  return w;
}
