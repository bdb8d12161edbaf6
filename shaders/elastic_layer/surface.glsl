// The surface over the nodes of an elastic layer, from the heights that the contact pass leaves, and its overlap with the undeformed skin.
//
// Heights are in m, in P, with the slot in their lowest bits (depth/slots.glsl); kMiss without a surface. Overlaps are in thicknesses, positive below
// Surface::origin.

struct Surface {
  uint first_height;  // of the instance in heights[]
  uvec4 reached;      // nodes that the contact pass has reached: first row, end row, first col, end col; all 0 without any
  float origin;       // height at which the overlap is 0, m
};

// ---- geometry of the nodes ----

vec2 nodeSpacing() { return vec2(PITCH_X, PITCH_Y) / float(SAMPLES); }
float nodeArea() { return nodeSpacing().x * nodeSpacing().y; }
vec2 nodePosition(uvec2 node) { return (vec2(node) - 0.5 * vec2(NODE_ROWS - 1u, NODE_COLS - 1u)) * nodeSpacing(); }

// y coordinates of the nodes of a strip, m.
vec4 columnPositions(uvec2 at) {
  return nodePosition(at).y + vec4(0, 1, 2, 3) * nodeSpacing().y;
}

bool isReached(Surface surface, uvec2 node) { return isInside(node, surface.reached); }

// ---- heights ----

#include "elastic_layer/cells.glsl"

float heightAt(Surface surface, uvec2 node) {
  float height = withoutSlot(heights[surface.first_height + node.x * NODE_COLS + node.y]);
  return AREA ? heightOf(cellAt(surface, node), height) : height;
}

// Heights over a strip; kMiss outside the nodes that were reached.
vec4 heightsOver(Surface surface, uvec2 at) {
  vec4 h = vec4(kMiss);
  if (at.x < surface.reached.x || at.x >= surface.reached.y) return h;
  for (uint c = 0; c < kStrip; ++c) {
    uint col = at.y + c;
    if (col >= surface.reached.z && col < surface.reached.w) h[c] = heightAt(surface, uvec2(at.x, col));
  }
  return h;
}

// Bounding rectangle of the windows of an instance's tiles, as Surface::reached.
uvec4 reachedNodes(uint instance) {
  uvec4 reached = uvec4(NODE_ROWS, 0, NODE_COLS, 0);
  for (uint t = 0; t < NUM_HEIGHT_TILES; ++t) {
    uvec4 tile = windows[instance * NUM_HEIGHT_TILES + t].window;
    if (tile.x >= tile.y) continue;
    reached = uvec4(min(reached.x, tile.x), max(reached.y, tile.y), min(reached.z, tile.z), max(reached.w, tile.w));
  }
  return reached.x < reached.y ? reached : uvec4(0);
}

// The lowest height over the window, m; kMiss without any.
float lowestHeight(Surface surface, Window window) {
  uint v = gl_LocalInvocationIndex;
  if (v < window.num_parts) do {
    float highest = -kMiss;
    uint k = v;
    do {
      if (k < window.num_strips) highest = max(highest, largestOf(-heightsOver(surface, stripAt(window, k))));
      k += LANES;
    } while (k - v < window.num_strips);
    checkLoop(k < window.num_strips);
    setPartial(v, vec4(highest));
    v += WORKGROUP;
  } while (WORKGROUP < LANES && v < window.num_parts);
  return -largestOfPartials(window.num_parts);
}

// ---- overlaps ----

// At most 1: the skin is not pressed deeper than its thickness.
vec4 overlapOf(Surface surface, vec4 height) { return min((surface.origin - height) / THICKNESS, 1.0); }

vec4 overlapsOver(Surface surface, uvec2 at) {
  return overlapOf(surface, heightsOver(surface, at));
}

float overlapAt(Surface surface, uvec2 node) { return overlapOf(surface, vec4(heightAt(surface, node))).x; }
