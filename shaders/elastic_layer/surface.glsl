// The surface over the nodes of an elastic layer, from the heights that the heights pass leaves, and its overlap with the undeformed skin.
//
// Heights are in m, in P, with the slot in their lowest bits (depth/slots.glsl); kNoHeight without a surface. Overlaps are in thicknesses,
// positive below Surface::origin.

struct Surface {
  uint first_height;  // index of the instance in heights[]
  uvec4 reached;      // nodes under objects: first row, end row, first col, end col; all 0 without any
  float origin;       // height at which the overlap is 0, m
};

// ---- geometry of the nodes ----

vec2 nodeSpacing() { return vec2(PITCH_X, PITCH_Y) / float(SAMPLES); }
float nodeArea() { return nodeSpacing().x * nodeSpacing().y; }
vec2 nodePosition(uvec2 node) { return (vec2(node) - 0.5 * vec2(NODE_ROWS - 1u, NODE_COLS - 1u)) * nodeSpacing(); }

// y coordinates of the nodes of a strip, m.
vec4 columnPositions(uvec2 at) { return nodePosition(at).y + vec4(0, 1, 2, 3) * nodeSpacing().y; }

bool isReached(Surface surface, uvec2 node) { return isInside(node, surface.reached); }

// ---- heights ----

#include "elastic_layer/cells.glsl"

// Word of heights[] over a node.
uint heightWordAt(Surface surface, uvec2 node) {
  uint at = surface.first_height + node.x * NODE_COLS + node.y;
  return fourOf(Heights, at / 4u)[at % 4u];
}

// Words of heights[] over a strip; those past the end of a row belong to other nodes.
uvec4 heightWordsOver(Surface surface, uvec2 at) {
  const bool kAligned = NODE_COLS % 4u == 0u;
  uint first = surface.first_height + at.x * NODE_COLS + at.y, shift = first % 4u;
  uvec4 low = fourOf(Heights, first / 4u);
  if (kAligned) return low;
  uvec4 high = fourOf(Heights, first / 4u + 1u);
  bvec4 by_two = bvec4((shift & 2u) != 0), by_one = bvec4((shift & 1u) != 0);
  low = mix(low, uvec4(low.zw, high.xy), by_two);
  return mix(low, uvec4(low.yzw, by_two.x ? high.z : high.x), by_one);
}

float heightAt(Surface surface, uvec2 node) {
  float height = withoutSlot(heightWordAt(surface, node));
  return AREA ? heightOf(cellAt(surface, node), height) : height;
}

// Heights over a strip; kNoHeight outside the nodes that were reached.
vec4 heightsOver(Surface surface, uvec2 at) {
  uvec4 words = heightWordsOver(surface, at), col = at.y + uvec4(0, 1, 2, 3);
  bool row = at.x >= surface.reached.x && at.x < surface.reached.y;
  uvec4 reached = uvec4(greaterThanEqual(col, uvec4(surface.reached.z))) * uvec4(lessThan(col, uvec4(surface.reached.w))) * uint(row);
  vec4 h;
  for (uint c = 0; c < kStrip; ++c) h[c] = withoutSlot(words[c]);
  if (AREA) {
    for (uint c = 0; c < kStrip; ++c) {
      if (reached[c] == 1u) h[c] = heightOf(cellAt(surface, uvec2(at.x, col[c])), h[c]);
    }
  }
  return mix(vec4(kNoHeight), h, equal(reached, uvec4(1)));
}

// Bounding rectangle of the windows of an instance's tiles, as Surface::reached.
uvec4 reachedNodes(uint instance) {
  uvec4 reached = uvec4(NODE_ROWS, 0, NODE_COLS, 0);
  for (uint t = 0; t < NUM_HEIGHT_TILES; ++t) {
    uvec4 tile = windows[instance * NUM_HEIGHT_TILES + t];
    if (tile.x >= tile.y) continue;
    reached = uvec4(min(reached.x, tile.x), max(reached.y, tile.y), min(reached.z, tile.z), max(reached.w, tile.w));
  }
  return reached.x < reached.y ? reached : uvec4(0);
}

// The lowest height over the window, m; kNoHeight without any.
float lowestHeight(Surface surface, Window window) {
  REDUCE_STRIPS(window, vec4(-kNoHeight), sums.x = max(sums.x, largestOf(-heightsOver(surface, at))))
  return -largestOfPartials(window.num_parts);
}

// ---- overlaps ----

// At most 1: the skin is not pressed deeper than its thickness.
vec4 overlapOf(Surface surface, vec4 height) { return min((surface.origin - height) / THICKNESS, 1.0); }

vec4 overlapsOver(Surface surface, uvec2 at) { return overlapOf(surface, heightsOver(surface, at)); }

float overlapAt(Surface surface, uvec2 node) { return overlapOf(surface, vec4(heightAt(surface, node))).x; }
