// The part of a node's cell that an object covers, with area sampling: the words of node_cells[], shared/elastic_layer.h.

struct CellPart {
  uint height;    // mean over what is covered, m, as bits, with the slot in the lowest ones
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
