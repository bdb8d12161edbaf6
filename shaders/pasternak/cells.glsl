// Links that the outline of an object cuts, with area sampling: where between two nodes the surface leaves the object.
//
// In the cell of a node the outline is the straight line with the covered share on one side, across the direction to the centroid of what is covered (as in
// the volume-of-fluid method; W. J. Rider and D. B. Kothe, J. Comput. Phys. 141 (1998) 112). The node is under the object if the line leaves the middle of the
// cell on the covered side. What the two cells of a link have covered of it adds up to the covered share s of the link, where the surface follows the object;
// it falls over the rest, so that the link counts with c = 1 / (1 - s). Where the outline passes a node, s is 0 on one of its sides and 1 on the other: the
// force is continuous in the pose.
//
//        |#########/ . . . |         arms: covered parts of the four half links of a node, in spacings
//     ---|----o###/---o----|---
//        |#######/ .arm = 0|
//
// Where no edge cuts a cell its middle decides, as with points. A smooth surface ends its contact between two nodes, on average a square of h^2 / 12 away from
// the nearer one, h the spacing; there it has bent away from its tangent, so that the node meets it too high. With the curvatures along x and y the difference
// is (xx + yy) h^2 / 48 on average, half of the difference between the middle of a cell and its mean, by which nodes meet a convex surface deeper. Twin: src/reference/foundation_cells.cpp.

const float kBetweenNodes = 0.5;
const float kNearlyWhole = 20.0;  // times the share that is not covered, below 1, is how little a mean says of the middle of a cell
const float kLeastFree = 1.0 / 500.0;  // of 1 / c
const float kLeastBetweenFree = 1.0 / 8.0;  // where the object is over neither node: two stiff links in series would take many sweeps

// Covered parts of the half links of four nodes along -x and x, and along -y and y: in widths of half a link, 16 bits each.
struct Arms {
  uvec4 along_x, along_y;
};

Arms noArms() { return Arms(uvec4(0), uvec4(0)); }

// Distance along `normal`, of which the components add up to 1, from the middle of a cell to the line that has the share of the cell behind it.
float lineOffset(float share, vec2 normal) {
  float least = min(abs(normal.x), abs(normal.y)), most = 1.0 - least, corner = 0.5 * least / most;
  float offset = most * share + 0.5 * least;
  if (share < corner) offset = sqrt(2.0 * least * most * share);
  if (share > 1.0 - corner) offset = 1.0 - sqrt(2.0 * least * most * (1.0 - share));
  return offset - 0.5;
}

// Height that a node meets, m; kMiss where it is free. Sets its arms, as those of node `r`.
float cutNode(Surface surface, uvec2 node, uint r, inout Arms arms) {
  CellPart part = cellPart(surface.first_height + node.x * kNodes.y + node.y);
  float height = heightAt(surface, node), edge = part.covered == 0.0 ? 0.0 : part.edge;
  bool is_over = height < kMiss;
  float share = mix(is_over ? 1.0 : 0.0, part.covered, edge), size = abs(part.center.x) + abs(part.center.y);
  vec2 normal = edge > 0.0 && size > 0.0 ? -part.center / size : vec2(1, 0);
  float offset = lineOffset(share, normal), mean = uintBitsToFloat(part.height);
  bool is_under = offset > 0.0;
  if (is_over) {
    float whole = clamp(1.0 - kNearlyWhole * (1.0 - part.covered), 0.0, 1.0);
    height = mix(height - kBetweenNodes * whole * max(mean - height, 0.0), mean, edge);
  } else if (edge > 0.0) {
    height = mean;
  }
  if (overlapOf(surface, vec4(height)).x > 0.0) {
    vec4 rise = vec4(-normal.x, normal.x, -normal.y, normal.y), crossing = 2.0 * abs(offset) / max(abs(rise), 1e-6);
    vec4 to_line = mix(vec4(1), min(crossing, 1.0), greaterThan(rise, vec4(0)));            // from under the object
    vec4 from_line = mix(vec4(0), max(1.0 - crossing, 0.0), lessThan(rise, vec4(0)));       // where the node is free
    vec4 covered = is_under ? to_line : from_line;
    arms.along_x[r] = packUnorm2x16(covered.xy);
    arms.along_y[r] = packUnorm2x16(covered.zw);
  }
  return is_under ? height : kMiss;
}

// 1 / c of links between nodes with overlaps a and b, of which both cells cover `arms`. As with points a link is cut where the surface falls by more than a
// spacing beyond a node that overlaps.
vec4 freeShares(vec4 a, vec4 b, vec4 arms, float spacing) {
  bvec4 any = greaterThan(max(a, b), vec4(0)), both = greaterThan(min(a, b), vec4(0));
  vec4 free = max(1.0 - mix(arms, vec4(0.5), both), mix(vec4(kLeastBetweenFree), vec4(kLeastFree), any));
  vec4 steep = mix(vec4(1), clamp(abs(a - b) / spacing - 1.0, 0.0, 1.0), any);
  return max(free / (free + steep * (1.0 - free)), kLeastFree);
}

// Stores the arms of a column in kFirst and kSecond, which the solver does not use yet. `at`: of the overlaps of the column.
void writeArms(uint at, Arms arms) {
  const uint kArray = kNumBlocks * kBlockCols * kColumnPairs;
  writeWords(at + kFirst * kArray, arms.along_x);
  writeWords(at + kSecond * kArray, arms.along_y);
}

// The arms of four nodes towards lower rows or columns, or towards higher ones.
vec4 armsBefore(uvec4 words) { return vec4(words & 0xFFFFu) * (0.5 / 65535.0); }
vec4 armsAfter(uvec4 words) { return vec4(words >> 16) * (0.5 / 65535.0); }

// The rows of a column from the second one on, and the first one of the block below.
vec4 rowsBelow(vec4 rows, float below) { return vec4(rows.yzw, below); }
uvec4 rowsBelow(uvec4 rows, uint below) { return uvec4(rows.yzw, below); }

// Computes kLinks of a block from the overlaps, and from the arms in kFirst (along x) and kSecond (along y).
void setLinks(uint instance, uint number) {
  uvec2 block = cellNumbered(number, kBlocks.y);
  uint below = block.x + 1u < kBlocks.x ? number + kBlocks.y : number, right = block.y + 1u < kBlocks.y ? number + 1u : number;
  uint to_first = kFirst * kNumBlocks * kBlockCols * kColumnPairs, to_second = kSecond * kNumBlocks * kBlockCols * kColumnPairs;
  uint own = columnAddress(instance, kOverlap, number, 0);
  vec4 overlap = readRows(own);
  uvec4 along_y = readWords(own + to_second);
  for (uint col = 0; col < kBlockCols; ++col) {
    uint under = columnAddress(instance, kOverlap, below, col);
    uint next_col = col + 1u < kBlockCols ? own + kColumnPairs : columnAddress(instance, kOverlap, right, 0);
    uvec4 along_x = readWords(own + to_first), next_along_y = readWords(next_col + to_second);
    vec4 next_overlap = readRows(next_col);
    uvec4 under_x = rowsBelow(along_x, wordsOf(foundation[under + to_first]).x);
    vec4 to_row = freeShares(overlap, rowsBelow(overlap, pairAt(under).x), armsAfter(along_x) + armsBefore(under_x), nodeSpacing().x);
    vec4 to_col = freeShares(overlap, next_overlap, armsAfter(along_y) + armsBefore(next_along_y), nodeSpacing().y);
    uvec4 words;
    [[unroll]] for (uint r = 0; r < kBlockRows; ++r) words[r] = packUnorm2x16(vec2(to_row[r], to_col[r]));
    writeWords(columnAddress(instance, kLinks, number, col), words);
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
