// The arms and the links of nodes (common/cut_links.glsl) in the blocks of a grid.

// Covered parts of the half links of four nodes along -x and x, and along -y and y: in widths of half a link, 16 bits each.
struct Arms {
  uvec4 along_x, along_y;
};

Arms noArms() { return Arms(uvec4(0), uvec4(0)); }

// Height that a node meets, m; kMiss where it is free. Sets its arms, as those of node `r`.
float cutNode(Surface surface, uvec2 node, uint r, inout Arms arms) {
  CutCell cell = cutCell(heightAt(surface, node), cellPart(surface.first_height + node.x * kNodes.y + node.y));
  if (overlapOf(surface, vec4(cell.height)).x > 0.0) {
    arms.along_x[r] = packUnorm2x16(cell.arms.xy);
    arms.along_y[r] = packUnorm2x16(cell.arms.zw);
  }
  return cell.is_under ? cell.height : kMiss;
}

// Stores the arms of a column in kFirst and kSecond, which the solver does not use yet. `at`: of the overlaps of the column.
void writeArms(uint at, Arms arms) {
  writeWords(at + kFirst * kColumnsOfArray, arms.along_x);
  writeWords(at + kSecond * kColumnsOfArray, arms.along_y);
}

// The arms of four nodes towards lower rows or columns, or towards higher ones.
vec4 armsBefore(uvec4 words) { return vec4(words & 0xFFFFu) * (0.5 / 65535.0); }
vec4 armsAfter(uvec4 words) { return vec4(words >> 16) * (0.5 / 65535.0); }

// The rows of a column from the second one on, and the first one of the block below.
vec4 rowsBelow(vec4 rows, float below) { return vec4(rows.yzw, below); }
uvec4 rowsBelow(uvec4 rows, uint below) { return uvec4(rows.yzw, below); }

// Computes kLinks of a block from the overlaps, and from the arms in kFirst (along x) and kSecond (along y).
void setLinks(uint number) {
  uvec2 block = cellNumbered(number, kBlocks.y);
  uint below = block.x + 1u < kBlocks.x ? number + kBlocks.y : number, right = block.y + 1u < kBlocks.y ? number + 1u : number;
  uint to_first = kFirst * kColumnsOfArray, to_second = kSecond * kColumnsOfArray;
  uint own = columnAddress(kOverlap, number, 0);
  vec4 overlap = readRows(own);
  uvec4 along_y = readWords(own + to_second);
  for (uint col = 0; col < kBlockCols; ++col) {
    uint under = columnAddress(kOverlap, below, col);
    uint next_col = col + 1u < kBlockCols ? own + 1u : columnAddress(kOverlap, right, 0);
    uvec4 along_x = readWords(own + to_first), next_along_y = readWords(next_col + to_second);
    vec4 next_overlap = readRows(next_col);
    uvec4 under_x = rowsBelow(along_x, readWords(under + to_first).x);
    vec4 to_row = freeShares(overlap, rowsBelow(overlap, readRows(under).x), armsAfter(along_x) + armsBefore(under_x),
                             abs(overlap - rowsBelow(overlap, readRows(under).x)) / nodeSpacing().x);
    vec4 to_col = freeShares(overlap, next_overlap, armsAfter(along_y) + armsBefore(next_along_y), abs(overlap - next_overlap) / nodeSpacing().y);
    uvec4 words;
    [[unroll]] for (uint r = 0; r < kBlockRows; ++r) words[r] = packUnorm2x16(vec2(to_row[r], to_col[r]));
    writeWords(columnAddress(kLinks, number, col), words);
    overlap = next_overlap;
    along_y = next_along_y;
    own = next_col;
  }
}

// c of links, from kLinks.
vec4 rowFactors(uvec4 words) { return 65535.0 / vec4(words & 0xFFFFu); }
vec4 colFactors(uvec4 words) { return 65535.0 / vec4(words >> 16); }

// Mean overlap over the cell of a node, m.
float meanOverlap(Surface surface, uvec2 node) {
  CellPart part = cellPart(surface.first_height + node.x * kNodes.y + node.y);
  return part.covered * max(overlapOf(surface, vec4(uintBitsToFloat(part.height))).x, 0.0);
}

// Height that a node meets, m; kMiss where it is free.
float metHeight(Surface surface, uvec2 node) {
  Arms arms = noArms();
  return AREA ? cutNode(surface, node, 0u, arms) : heightAt(surface, node);
}

// Height of the lowest node, m; kMiss without any.
float lowestHeight(Surface surface) {
  for (uint v = gl_LocalInvocationIndex; v < LANES; v += WORKGROUP) {
    float deepest = -kMiss;
    for (uint t = 0; t < NUM_HEIGHT_TILES; ++t) {
      Window window = reachedNodes(surface, t);
      uint total = window.count.x * window.count.y, k = v;
      for (; k < total; k += LANES) deepest = max(deepest, -metHeight(surface, window.first + cellNumbered(k, window.count.y)));
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
