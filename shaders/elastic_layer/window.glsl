// The strips that the solver visits: the window (strips that may be in contact) and the sources (strips over which an array is not zero), with the reductions
// over the window.
//
// The window has the same number of strips in each of its rows, but its own first column per row, so that a contact along a diagonal does not need the bounding
// rectangle. Sources are one range of columns per row.
// Shared memory: 16 LANES + 12 NODE_ROWS + 12 bytes. A workgroup works on one instance, and all its invocations hold the same Window.

#include "common/partial_sums.glsl"

const float kNoTarget = -kNoHeight;  // target of a node that cannot be touched; also the identity of the maximum

struct Window {
  uint layer_start;  // first pair of the instance in layer[]
  uvec2 rows;        // first row, number of rows
  uint width;        // strips per row, at least 1
  uint num_strips;
  uint num_parts;    // partial sums over these strips
};

shared uint window_first[NODE_ROWS];                         // first column of the window in each row
shared uint source_first[NODE_ROWS], source_end[NODE_ROWS];  // range of sources in each row
shared uint source_rows[2];                                  // range of rows that have sources
shared uint widest;                                          // largest number of columns of a row

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

void clearSources() {
  for (uint row = gl_LocalInvocationIndex; row < NODE_ROWS; row += WORKGROUP) {
    source_first[row] = kRowNodes;
    source_end[row] = 0;
  }
  if (gl_LocalInvocationIndex == 0) {
    source_rows[0] = NODE_ROWS;
    source_rows[1] = 0;
    widest = 0;
  }
  workgroupBarrierWithBuffers();
}

void addSource(uvec2 at) {
  atomicMin(source_first[at.x], at.y);
  atomicMax(source_end[at.x], at.y + kStrip);
  atomicMin(source_rows[0], at.x);
  atomicMax(source_rows[1], at.x + 1u);
}

// ---- reductions ----

// Sum of the first `count` values of partial[], in a fixed order; every invocation gets it. Many values are first summed in groups.
vec4 sumOfPartials(uint count) {
  const uint kGroup = LANES > 16u ? 8u : 1u;
  workgroupBarrierWithBuffers();
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

// Largest x component of the first `count` values of partial[]; kNoTarget without any.
float largestOfPartials(uint count) {
  workgroupBarrierWithBuffers();
  float largest = kNoTarget;
  for (uint v = 0; v < count; ++v) largest = max(largest, partial[v].x);
  workgroupBarrier();
  return largest;
}
