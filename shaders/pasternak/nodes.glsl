// The nodes of a two-parameter foundation: their heights, from the contact pass.
//
// Nodes are numbered along x and y of P; node (0, 0) is at the corner of the array. Heights are in m, in P; kMiss without a surface.

const uint kPerTaxel = SAMPLES * NODES_PER_SAMPLE;
// One number at a time: the optimizer of the validation layers breaks the order of constants that come from vectors of specialization constants.
const uint kNodeRows = NUM_ROWS * kPerTaxel, kNodeCols = NUM_COLS * kPerTaxel;
const uint kLastRow = kNodeRows - 1u, kLastCol = kNodeCols - 1u;
const uvec2 kNodes = uvec2(kNodeRows, kNodeCols), kLastNode = uvec2(kLastRow, kLastCol);

struct Surface {
  uint first_height;  // of the instance in Heights
  uint first_tile;    // of the instance in Windows
  float origin;       // height at which the overlap is `depth`, m
  float depth;        // m
};

// A rectangle of nodes, or of blocks of nodes.
struct Window {
  uvec2 first, count;
};

vec2 nodeSpacing() { return vec2(PITCH_X, PITCH_Y) / float(kPerTaxel); }
vec2 nodePosition(vec2 node) { return (node - 0.5 * vec2(kLastNode)) * nodeSpacing(); }

// Height at a node that a tile of the contact pass has reached.
float heightAt(Surface surface, uvec2 node) {
  uint at = surface.first_height + node.x * kNodes.y + node.y;
  return floatsOfFour(Heights, at / 4u)[at % 4u];
}

// Heights at four nodes of a row that a tile has reached, from `node` on.
vec4 heightsOfRow(Surface surface, uvec2 node) {
  const bool kAligned = kNodeCols % 4u == 0u;
  uint at = surface.first_height + min(node.x, kNodes.x - 1u) * kNodes.y + min(node.y, kNodes.y - 1u);
  vec4 low = floatsOfFour(Heights, at / 4u);
  if (kAligned) return low;
  vec4 high = floatsOfFour(Heights, at / 4u + 1u);
  uint shift = at % 4u;
  if (shift == 1u) return vec4(low.yzw, high.x);
  if (shift == 2u) return vec4(low.zw, high.xy);
  return shift == 3u ? vec4(low.w, high.xyz) : low;
}

// Signed overlap of object and undeformed skin, m.
vec4 overlapOf(Surface surface, vec4 height) { return min((surface.origin - height) + surface.depth, THICKNESS); }

// The nodes that a tile of the contact pass has reached.
Window reachedNodes(Surface surface, uint tile) {
  const uint kFours = 3u, kWindow = 2u;  // of a TileResult
  uvec4 window = fourOf(Windows, kFours * (surface.first_tile + tile) + kWindow);
  return Window(window.xz, window.yw - window.xz);
}

// The rectangle around the nodes that any tile has reached.
Window allReachedNodes(Surface surface) {
  uvec2 first = kNodes, end = uvec2(0);
  for (uint t = 0; t < NUM_HEIGHT_TILES; ++t) {
    Window reached = reachedNodes(surface, t);
    if (reached.count.x == 0 || reached.count.y == 0) continue;
    first = min(first, reached.first);
    end = max(end, reached.first + reached.count);
  }
  return end.x == 0 ? Window(uvec2(0), uvec2(0)) : Window(first, end - first);
}
