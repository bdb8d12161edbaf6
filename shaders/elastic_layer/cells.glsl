// Cells that an edge of an object covers in part, with area sampling: the height over the covered part, its centroid, and the own
// compliance of such a node.
//
// A pressed part of a cell is softer than the cell under the same force, and parts of neighbouring cells are closer to each other than the
// middles of their cells. Both go into the node's own compliance, so that influence still depends on distance alone
// (elastic_layer/influence.glsl). With the share s that is covered, the centroid c, and the disc of the cell's area as the shape of what
// carries the edge of a rigid object:
//
//   own(s)       = 1 + (CELL_DISC (1 - s^8) + CELL_FREE s^8) / sqrt(s) - CELL_FREE + CELL_BASE (1 - s)
//   compliance_i = own(s_i) + POINT_COMPLIANCE sum over the eight neighbours j of
//                    sqrt(s_j / s_i) [m(|c_j - c_i|, w_ij) - m(distance of the nodes, w_11)]
//   m(r, w)      = erf(r / w) / r - 1 / sqrt(r^2 + IMAGE_DEPTH^2)
//
// m belongs to two round clouds whose forces act over w; their image is the base.
// sqrt(s_j / s_i) is the ratio of forces under a flat object; a surface that only enters a cell has the share that it covers there.
// Compliances are relative to a whole cell's. Constants: src/sensor/elastic_layer.h. Reference: src/reference/layer_cells.cpp.

const float kPi = 3.14159265358979;
const uint kLayerCompliance = kLayerArrays - 1u;      // array of compliance - 1
const uint kLayerDentCompliance = kLayerArrays - 2u;  // the same of a dent, of a skin that relaxes
const float kLeastCompliance = 0.5;                   // bound for layers much thinner than a cell

// The words of node_cells[], shared/elastic_layer.h.
struct CellPart {
  uint height;    // mean over the covered part, m, as bits, with the slot in the lowest ones
  float covered;  // share that is covered; 0: nothing touches, and the rest is undefined
  vec2 center;    // centroid, from the middle of the cell, in its widths
  float edge;     // how far an edge bounds the covered part, 0 to 1
};

CellPart cellPart(uint node) {
  const int kBits = int(kCentroidBits);
  uint first = kNodeCellWords * node, word = node_cells[first + 2u];
  vec2 center =
      vec2(bitfieldExtract(int(word), 0, kBits), bitfieldExtract(int(word), kBits, kBits)) * (0.5 / float((1 << (kBits - 1)) - 1));
  float edge = float(word >> (2u * kCentroidBits)) / float((1u << kEdgeBits) - 1u);
  return CellPart(node_cells[first], uintBitsToFloat(node_cells[first + 1u]), center, edge);
}

// Distance along `normal`, of which the components add up to 1, from the middle of a cell to the line that has the share of the cell behind
// it.
float lineOffset(float share, vec2 normal) {
  float least = min(abs(normal.x), abs(normal.y)), most = 1.0 - least, corner = 0.5 * least / most;
  float offset = most * share + 0.5 * least;
  if (share < corner) offset = sqrt(2.0 * least * most * share);
  if (share > 1.0 - corner) offset = 1.0 - sqrt(2.0 * least * most * (1.0 - share));
  return offset - 0.5;
}

struct NodeCell {
  float height;   // over the covered part, m
  float share;    // that counts as covered: 1 without an edge; 0: nothing touches
  float covered;  // share that is covered
  vec2 center;    // centroid, from the node, m
  float edge;     // how far an edge bounds the covered part
  uint slot;
};

NodeCell noNodeCell() { return NodeCell(0.0, 0.0, 0.0, vec2(0), 0.0, 0u); }

NodeCell cellAt(Surface surface, uvec2 node) {
  if (!AREA) return NodeCell(0.0, 1.0, 1.0, vec2(0), 0.0, 0u);
  CellPart part = cellPart(surface.first_height + node.x * NODE_COLS + node.y);
  if (part.covered == 0.0) return noNodeCell();
  return NodeCell(withoutSlot(part.height), mix(1.0, part.covered, part.edge), part.covered, part.center * nodeSpacing(), part.edge,
                  slotOf(part.height));
}

// Height that a node meets, m: in the middle of its cell, or over the part that an edge bounds.
float heightOf(NodeCell cell, float height) {
  if (cell.edge == 0.0) return height;
  return height >= kNoHeight ? cell.height : mix(height, cell.height, cell.edge);
}

// Error function, to 1.5e-7 (Abramowitz and Stegun, 7.1.26).
float errorFunction(float x) {
  float t = 1.0 / (1.0 + 0.3275911 * x);
  return 1.0 - t * (0.254829592 + t * (-0.284496736 + t * (1.421413741 + t * (-1.453152027 + t * 1.061405429)))) * exp(-x * x);
}

// m(r, w), 1/m. `shares`: sum of both.
float mutualCompliance(vec2 distance_of, float shares) {
  const float kCloud = 8.0 / (kPi * kPi * kPi * kPi);  // w^2 of two clouds, of the sum of their areas
  float r = length(distance_of), w = sqrt(kCloud * shares * nodeArea()), x = r / w;
  float between = x > 1e-3 ? errorFunction(x) / r : 2.0 / (sqrt(kPi) * w);
  return between - (IMAGE_DEPTH > 0.0 ? inversesqrt(r * r + IMAGE_DEPTH * IMAGE_DEPTH) : 0.0);
}

float ownCompliance(float s) {
  float s2 = s * s, s4 = s2 * s2, s8 = s4 * s4;
  return 1.0 + mix(CELL_DISC, CELL_FREE, s8) * inversesqrt(s) - CELL_FREE + CELL_BASE * (1.0 - s);
}

float complianceOf(Surface surface, uvec2 node) {
  NodeCell cell = cellAt(surface, node);
  if (cell.share == 0.0) return 1.0;
  float mutual = 0.0;
  for (uint k = 0; k < 9; ++k) {
    ivec2 step_to = ivec2(k / 3, k % 3) - 1;
    uvec2 at = uvec2(ivec2(node) + step_to);  // -1 wraps to a large number
    if (k == 4 || !isReached(surface, at)) continue;
    NodeCell other = cellAt(surface, at);
    if (other.share == 0.0 || cell.share >= 1.0 && other.share >= 1.0) continue;
    vec2 nodes = vec2(step_to) * nodeSpacing();
    mutual += sqrt(other.covered) *
              (mutualCompliance(nodes + other.center - cell.center, cell.share + other.share) - mutualCompliance(nodes, 2.0));
  }
  return max(ownCompliance(cell.share) + POINT_COMPLIANCE * mutual * inversesqrt(cell.share), kLeastCompliance);
}

vec4 compliancesOver(Surface surface, uvec2 at) {
  vec4 more = vec4(0);
  for (uint c = 0; c < kStrip; ++c) {
    uvec2 node = uvec2(at.x, at.y + c);
    more[c] = isReached(surface, node) ? complianceOf(surface, node) - 1.0 : 0.0;
  }
  return more;
}

// Stores the compliances of the window.
void setCompliances(Surface surface, Window window) {
  if (!AREA) return;
  FOR_EACH_STRIP(window, writeStrip(window, kLayerCompliance, at, compliancesOver(surface, at)))
  workgroupBarrierWithBuffers();
}

// Over a strip: x and y from the nodes to the points where their forces act, m, and the shares that count as covered.
struct StripCells {
  vec4 x, y, share;
};

StripCells cellsOver(Surface surface, uvec2 at) {
  StripCells cells = StripCells(vec4(0), vec4(0), vec4(0));
  for (uint c = 0; c < kStrip; ++c) {
    uvec2 node = uvec2(at.x, at.y + c);
    NodeCell cell = noNodeCell();
    if (isReached(surface, node)) cell = cellAt(surface, node);
    cells.x[c] = cell.center.x;
    cells.y[c] = cell.center.y;
    cells.share[c] = cell.share;
  }
  return cells;
}

// Weights of the solver for residuals: one over the compliance of the node.
vec4 weighted(Window window, uvec2 at, vec4 values) {
  if (!AREA) return values;
  return values / (1.0 + readStrip(window, kLayerCompliance, at));
}
