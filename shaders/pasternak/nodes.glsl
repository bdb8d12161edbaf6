// The nodes of a two-parameter foundation: their heights, from the contact pass, and the rectangle of them that is solved.
//
// Nodes are numbered along x and y of P; node (0, 0) is at the corner of the array. Heights are in m, in P; kMiss without a surface.
// Shared memory: 16 bytes.

const uint kPerTaxel = SAMPLES * NODES_PER_SAMPLE;
const uvec2 kNodes = uvec2(NUM_ROWS, NUM_COLS) * kPerTaxel;

struct Surface {
  uint first_height;  // of the instance in heights[]
  uint first_tile;    // of the instance in windows[]
  float origin;       // height at which the overlap is `depth`, m
  float depth;        // m
};

// A rectangle of nodes.
struct Window {
  uvec2 first, count;
};

shared uint window_bounds[4];  // first row and col, end row and col

vec2 nodeSpacing() { return vec2(PITCH_X, PITCH_Y) / float(kPerTaxel); }
vec2 nodePosition(uvec2 node) { return (vec2(node) - 0.5 * vec2(kNodes - 1u)) * nodeSpacing(); }

// Height at a node that a tile of the contact pass has reached.
float heightAt(Surface surface, uvec2 node) { return uintBitsToFloat(heights[surface.first_height + node.x * kNodes.y + node.y]); }

// Its signed overlap of object and undeformed skin, m.
float overlapAt(Surface surface, uvec2 node) { return min((surface.origin - heightAt(surface, node)) + surface.depth, THICKNESS); }

// The nodes that a tile of the contact pass has reached.
Window reachedNodes(Surface surface, uint tile) {
  uvec4 window = windows[surface.first_tile + tile].window;
  return Window(window.xz, window.yw - window.xz);
}

Window intersectionOf(Window a, Window b) {
  uvec2 first = max(a.first, b.first), end = min(a.first + a.count, b.first + b.count);
  return Window(first, max(end, first) - first);
}

// Height of the lowest node, m; kMiss without any.
float lowestHeight(Surface surface) {
  for (uint v = gl_LocalInvocationIndex; v < LANES; v += WORKGROUP) {
    float deepest = -kMiss;
    for (uint t = 0; t < NUM_HEIGHT_TILES; ++t) {
      Window window = reachedNodes(surface, t);
      uint total = window.count.x * window.count.y, k = v;
      for (; k < total; k += LANES) deepest = max(deepest, -heightAt(surface, window.first + cellNumbered(k, window.count.y)));
      checkLoop(k < total);
    }
    partial[v] = vec4(deepest, 0, 0, 0);
  }
  workgroupBarrier();
  float deepest = -kMiss;
  for (uint v = 0; v < LANES; ++v) deepest = max(deepest, partial[v].x);
  workgroupBarrier();
  return -deepest;
}

// The nodes with overlap, and MARGIN nodes around them; none without overlap.
Window overlapWindow(Surface surface) {
  if (gl_LocalInvocationIndex < 4) window_bounds[gl_LocalInvocationIndex] = gl_LocalInvocationIndex < 2 ? 0xFFFFFFFFu : 0u;
  workgroupBarrier();
  uvec4 bounds = uvec4(0xFFFFFFFFu, 0xFFFFFFFFu, 0, 0);
  for (uint t = 0; t < NUM_HEIGHT_TILES; ++t) {
    Window reached = reachedNodes(surface, t);
    uint total = reached.count.x * reached.count.y, k = gl_LocalInvocationIndex;
    for (; k < total; k += WORKGROUP) {
      uvec2 node = reached.first + cellNumbered(k, reached.count.y);
      if (overlapAt(surface, node) > 0.0) bounds = uvec4(min(bounds.xy, node), max(bounds.zw, node + 1u));
    }
    checkLoop(k < total);
  }
  if (bounds.x < bounds.z) {
    atomicMin(window_bounds[0], bounds.x);
    atomicMin(window_bounds[1], bounds.y);
    atomicMax(window_bounds[2], bounds.z);
    atomicMax(window_bounds[3], bounds.w);
  }
  workgroupBarrier();
  uvec2 first = uvec2(window_bounds[0], window_bounds[1]), end = uvec2(window_bounds[2], window_bounds[3]);
  workgroupBarrier();
  if (end.x == 0) return Window(uvec2(0), uvec2(0));
  first -= min(first, uvec2(MARGIN));
  return Window(first, min(end + MARGIN, kNodes) - first);
}
