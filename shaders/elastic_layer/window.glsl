// The strips that the solver visits: the window (strips that may be in contact) and the sources (strips over which an array is not zero),
// with the reductions over the window.
//
// The window has the same number of strips in each of its rows, but its own first column per row, so that a contact along a diagonal does
// not need the bounding rectangle. Sources are one range of strips per row.
// Shared memory: 16 LANES + 8 NODE_ROWS + 8 bytes. A workgroup works on one instance, and all its invocations hold the same Window.

const float kNoTarget = -kNoHeight;  // target of a node that cannot be touched; also the identity of the maximum

struct Window {
  uint layer_start;  // first pair of the instance in layer[]
  uvec2 rows;        // first row, number of rows
  uint width;        // strips per row, at least 1
  uint num_strips;
  uint num_parts;  // partial sums over these strips
};

shared uint window_first[NODE_ROWS];   // first column of the window in each row
shared uint source_strips[NODE_ROWS];  // sources of each row, a bit for every kStripsPerBit strips
shared uint source_rows;               // rows that have sources, a bit for every kRowsPerBit rows
shared uint widest;                    // largest number of strips of a row

// `rows`: first row, number of rows. The caller sets window_first[].
void setWindow(inout Window window, uvec2 rows, uint width) {
  window.rows = rows;
  window.width = max(width, 1u);
  window.num_strips = rows.y * width;
  window.num_parts = min(LANES, window.num_strips);
}

uvec2 stripAt(Window window, uint k) {
  uvec2 at = cellNumbered(k, window.width);
  uint row = window.rows.x + at.x;
  return uvec2(row, window_first[row] + at.y * kStrip);
}

bool isInWindow(Window window, uvec2 node) {
  return node.x - window.rows.x < window.rows.y && node.y - window_first[node.x] < window.width * kStrip;  // wraps before the first
}

vec4 readStrip(Window window, uint array, uvec2 at) { return readStrip(window.layer_start, array, at); }
void writeStrip(Window window, uint array, uvec2 at, vec4 values) { writeStrip(window.layer_start, array, at, values); }

// ---- sources ----

const uint kStripsPerBit = (kRowStrips + 31u) / 32u, kRowsPerBit = (NODE_ROWS + 31u) / 32u;

void clearSources() {
  for (uint row = gl_LocalInvocationIndex; row < NODE_ROWS; row += WORKGROUP) source_strips[row] = 0;
  if (gl_LocalInvocationIndex == 0) source_rows = 0;
  workgroupBarrierWithBuffers();
}

void addSource(uvec2 at) {
  atomicOr(source_strips[at.x], 1u << at.y / kStrip / kStripsPerBit);
  atomicOr(source_rows, 1u << at.x / kRowsPerBit);
}

bool isSource(uvec2 at) { return (source_strips[at.x] >> at.y / kStrip / kStripsPerBit & 1u) == 1u; }

// First and end of what the set bits of a word that is not 0 cover.
uvec2 rangeOf(uint bits, uint per_bit, uint end) { return uvec2(findLSB(bits) * per_bit, min((findMSB(bits) + 1) * per_bit, end)); }

// First and end of the rows that have sources; may include more rows at both ends.
uvec2 rowsAroundSources() { return source_rows == 0 ? uvec2(0) : rangeOf(source_rows, kRowsPerBit, NODE_ROWS); }

// First and end of the rows that have sources.
uvec2 sourceRows() {
  uvec2 rows = rowsAroundSources();
  if (kRowsPerBit > 1u) {
    while (rows.x < rows.y && source_strips[rows.x] == 0) ++rows.x;
    while (rows.x < rows.y && source_strips[rows.y - 1u] == 0) --rows.y;
  }
  return rows;
}

// First and end of the strips of a row that has sources, in strips.
uvec2 sourcesOfRow(uint row) { return rangeOf(source_strips[row], kStripsPerBit, kRowStrips); }

// Runs `statement` for each strip of the window; `at`: the strip.
#define FOR_EACH_STRIP(window, statement) \
  FOR_EACH(window.num_strips, {           \
    uvec2 at = stripAt(window, k);        \
    statement;                            \
  })

// ---- reductions ----

// Reduces the strips of the window to its partial sums: `statement` updates `sums` by the strip `at`.
#define REDUCE_STRIPS(window, initial, statement)        \
  REDUCE(window.num_parts, window.num_strips, initial, { \
    uvec2 at = stripAt(window, k);                       \
    statement;                                           \
  })

vec4 partialAt(uint v) { return kInRegisters ? own_partial : partial[v]; }

// Sum of the first `count` partial sums, in a fixed order; every invocation gets it. Many are first summed in groups.
vec4 sumOfPartials(uint count) {
  const uint kGroup = LANES > 16u ? 8u : 1u;
  workgroupBarrierWithBuffers();
  if (kInRegisters) return sumOverVector(gl_LocalInvocationIndex < count ? own_partial : vec4(0));
  if (kGroup > 1u) {
    for (uint first = kGroup * gl_LocalInvocationIndex; first < count; first += kGroup * WORKGROUP) {
      vec4 sum = vec4(0);
      for (uint v = first; v < min(first + kGroup, count); ++v) sum += partial[v];
      partial[first] = sum;
    }
    workgroupBarrier();
  }
  vec4 total = vec4(0);
  for (uint v = 0; v < count; v += kGroup) total += partial[v];
  workgroupBarrier();
  return total;
}

// Largest x component of the first `count` partial sums; kNoTarget without any.
float largestOfPartials(uint count) {
  workgroupBarrierWithBuffers();
  if (kInRegisters) return largestOverVector(gl_LocalInvocationIndex < count ? own_partial.x : kNoTarget);
  float largest = kNoTarget;
  for (uint v = 0; v < count; ++v) largest = max(largest, partial[v].x);
  workgroupBarrier();
  return largest;
}
