// The nodes of a two-parameter foundation: their heights, from the contact pass, and the rectangle of them that is solved.
//
// Nodes are numbered along x and y of P; node (0, 0) is at the corner of the array. Heights are in m, in P; kMiss without a surface.
// Shared memory: 16 bytes.

const uint kPerTaxel = SAMPLES * NODES_PER_SAMPLE;
const uvec2 kNodes = uvec2(NUM_ROWS, NUM_COLS) * kPerTaxel;

struct Surface {
  uint first_height;  // of the instance in heights[]
  uvec4 reached;      // nodes that the contact pass has reached: first row, end row, first col, end col; all 0 without any
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

float heightAt(Surface surface, uvec2 node) {
  bool reached = node.x >= surface.reached.x && node.x < surface.reached.y && node.y >= surface.reached.z && node.y < surface.reached.w;
  return reached ? uintBitsToFloat(heights[surface.first_height + node.x * kNodes.y + node.y]) : kMiss;
}

// Signed overlap of object and undeformed skin, m. `precise`: a node in contact is recognised by its bits.
float overlapAt(Surface surface, uvec2 node) {
  precise float overlap = (surface.origin - heightAt(surface, node)) + surface.depth;
  return min(overlap, THICKNESS);
}

// Bounding rectangle of the windows of an instance's tiles, as Surface::reached.
uvec4 reachedNodes(uint instance) {
  uvec4 reached = uvec4(kNodes.x, 0, kNodes.y, 0);
  for (uint t = 0; t < NUM_HEIGHT_TILES; ++t) {
    uvec4 tile = windows[instance * NUM_HEIGHT_TILES + t].window;
    if (tile.x >= tile.y) continue;
    reached = uvec4(min(reached.x, tile.x), max(reached.y, tile.y), min(reached.z, tile.z), max(reached.w, tile.w));
  }
  return reached.x < reached.y ? reached : uvec4(0);
}

Window reachedWindow(Surface surface) { return Window(surface.reached.xz, surface.reached.yw - surface.reached.xz); }

// Height of the lowest node, m; kMiss without any.
float lowestHeight(Surface surface) {
  Window window = reachedWindow(surface);
  for (uint v = gl_LocalInvocationIndex; v < LANES; v += WORKGROUP) {
    float lowest = kMiss;
    uint k = v;
    for (; k < window.count.x * window.count.y; k += LANES) lowest = min(lowest, heightAt(surface, window.first + cellNumbered(k, window.count.y)));
    checkLoop(k < window.count.x * window.count.y);
    partial[v] = vec4(lowest, 0, 0, 0);
  }
  workgroupBarrier();
  float lowest = kMiss;
  for (uint v = 0; v < LANES; ++v) lowest = min(lowest, partial[v].x);
  workgroupBarrier();
  return lowest;
}

// The nodes with overlap, and MARGIN nodes around them; none without overlap.
Window overlapWindow(Surface surface) {
  if (gl_LocalInvocationIndex < 4) window_bounds[gl_LocalInvocationIndex] = gl_LocalInvocationIndex < 2 ? 0xFFFFFFFFu : 0u;
  workgroupBarrier();
  Window reached = reachedWindow(surface);
  uvec4 bounds = uvec4(0xFFFFFFFFu, 0xFFFFFFFFu, 0, 0);
  uint k = gl_LocalInvocationIndex;
  for (; k < reached.count.x * reached.count.y; k += WORKGROUP) {
    uvec2 node = reached.first + cellNumbered(k, reached.count.y);
    if (overlapAt(surface, node) > 0.0) bounds = uvec4(min(bounds.xy, node), max(bounds.zw, node + 1u));
  }
  checkLoop(k < reached.count.x * reached.count.y);
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
