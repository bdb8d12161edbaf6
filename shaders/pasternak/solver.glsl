// Displacements of a two-parameter foundation under a rigid surface, by a fixed number of red-black sweeps of projected successive over-relaxation.
//
//   spring w + sum over links of c link (w - w') = f >= 0,   w >= d,   f (w - d) = 0
//
// A link has c = 2 where an outline of the object crosses it, which on average is half-way (src/reference/pasternak.h); with AREA common/cut_links.glsl has c. Beyond the
// active blocks and beyond the array the surface decays exponentially. Twin: src/reference/pasternak.cpp.
//
// An invocation sweeps a block in one pass over its columns, from one array into the other (settled.glsl), and needs nothing that others compute in the same
// sweep: it moves the red nodes around the block's black ones again. Nodes are red where row plus column is even.
//
//          before   q     p     e     o           columns 2n - 3 to 2n + 1 in step n
//   rows     .      .     .     .     .  -2       read: e and o, rows -2 to 5
//            .      .     r     .     .  -1       red:  p and e, rows -1 to 4
//            .      .     b     r     .   0       black, and then written: q and p, rows 0 to 3
//            .      b     r     .     .   1

// Whether all nodes of all blocks exist.
const bool kWholeRows = kNodeRows % kBlockRows == 0u, kWholeCols = kNodeCols % kBlockCols == 0u;

// A column of a block and of two rows more on either side. `even`: rows -2, 0, 2, 4; `odd`: rows -1, 1, 3, 5.
struct Column {
  vec4 even, odd;                  // displacements w, m
  vec4 even_overlap, odd_overlap;  // d, m; -kMiss at dead nodes
  bvec4 even_alive, odd_alive;
  vec4 before;                     // displacements of rows 0 to 3 before the sweep
  vec4 even_odd, odd_even;         // links from even[i] to odd[i] and from odd[i] to even[i + 1], N/m
  uvec4 even_links, odd_links;     // with AREA: words of kLinks
};

// Links between two columns, N/m.
struct Links {
  vec4 even, odd;
};

// Three blocks, one below another along x, of which the second has the columns to be swept next to it or in it.
struct Stack {
  uvec3 blocks;
  uvec3 to_w;  // from a column's overlaps to its displacements
  bvec3 alive;
};

Stack stackAt(uvec2 block, int step_to) {
  uint col = block.y + uint(step_to);
  Stack stack;
  for (uint k = 0; k < 3; ++k) {
    uint row = block.x + k - 1u;  // -1 wraps to a large number
    bool exists = row < kBlocks.x && col < kBlocks.y;
    uint number = exists ? row * kBlocks.y + col : block.x * kBlocks.y + block.y;
    stack.blocks[k] = number;
    uint word = active_blocks[number];
    stack.alive[k] = exists && word != 0u;
    stack.to_w[k] = word != 0u ? arrayOf(word) * kColumnsOfArray : 0u;
  }
  return stack;
}

// Links (N/m) between nodes with overlaps a and b, of which one is over skin that is solved. They grow from `link` to twice as much while the surface falls by one
// to two spacings between two nodes, of which one overlaps.
vec4 linksOfSlope(vec4 a, vec4 b, float link, float per_spacing) {
  vec4 steep = clamp(abs(a - b) * (link * per_spacing), link, 2.0 * link);
  return mix(vec4(link), steep, greaterThan(max(a, b), vec4(0)));
}

bvec4 bothOf(bvec4 a, bvec4 b) { return bvec4(a.x && b.x, a.y && b.y, a.z && b.z, a.w && b.w); }

// A link to a dead node pulls as much as the displacement falls on the way to it.
vec4 withDead(vec4 links, bvec4 both_alive, float link, float decay) { return mix(vec4(link * (1.0 - decay)), links, both_alive); }

vec4 previous(vec4 v) { return vec4(0, v.xyz); }
vec4 next(vec4 v) { return vec4(v.yzw, 0); }
bvec4 next(bvec4 v) { return bvec4(v.yzw, false); }

// Rows 0 to 3 of a column.
vec4 ownRows(vec4 even, vec4 odd) { return vec4(even.y, odd.y, even.z, odd.z); }

Links linksBetween(Column a, Column b) {
  float per_spacing = 1.0 / nodeSpacing().y;
  vec4 even = AREA ? LINK_Y * colFactors(a.even_links) : linksOfSlope(a.even_overlap, b.even_overlap, LINK_Y, per_spacing);
  vec4 odd = AREA ? LINK_Y * colFactors(a.odd_links) : linksOfSlope(a.odd_overlap, b.odd_overlap, LINK_Y, per_spacing);
  return Links(withDead(even, bothOf(a.even_alive, b.even_alive), LINK_Y, DECAY_Y), withDead(odd, bothOf(a.odd_alive, b.odd_alive), LINK_Y, DECAY_Y));
}

Column deadColumn() {
  return Column(vec4(0), vec4(0), vec4(-kMiss), vec4(-kMiss), bvec4(false), bvec4(false), vec4(0), vec4(0), vec4(0), uvec4(0), uvec4(0));
}

// Sets the links along x.
void setRowLinks(inout Column c) {
  float per_spacing = 1.0 / nodeSpacing().x;
  vec4 even = AREA ? LINK_X * rowFactors(c.even_links) : linksOfSlope(c.even_overlap, c.odd_overlap, LINK_X, per_spacing);
  vec4 odd = AREA ? LINK_X * rowFactors(c.odd_links) : linksOfSlope(c.odd_overlap, next(c.even_overlap), LINK_X, per_spacing);
  c.even_odd = withDead(even, bothOf(c.even_alive, c.odd_alive), LINK_X, DECAY_X);
  c.odd_even = withDead(odd, bothOf(c.odd_alive, next(c.even_alive)), LINK_X, DECAY_X);
}

// Reads column `col` of the blocks of a stack, whose second one starts at node `corner`.
Column readColumn(Stack stack, uvec2 corner, uint col) {
  Column column;
  uint up = columnAddress(0, stack.blocks.x, col), own = columnAddress(0, stack.blocks.y, col);
  uint down = columnAddress(0, stack.blocks.z, col);
  vec4 d_up = readRows(up), d = readRows(own), d_down = readRows(down);
  vec4 w_up = readRows(up + stack.to_w.x), w = readRows(own + stack.to_w.y), w_down = readRows(down + stack.to_w.z);
  bool exists = kWholeCols;
  if (!kWholeCols) exists = corner.y + col < kNodes.y;
  bvec4 alive = bvec4(exists && stack.alive.x, exists && stack.alive.y, exists && stack.alive.y, exists && stack.alive.z);
  column.even_alive = column.odd_alive = alive;
  if (!kWholeRows) {
    uvec4 even_rows = corner.x + uvec4(0, 0, 2, 4), odd_rows = corner.x + uvec4(0, 1, 3, 5);  // the first one exists where its block does
    column.even_alive = bothOf(alive, lessThan(even_rows, uvec4(kNodes.x)));
    column.odd_alive = bothOf(alive, lessThan(odd_rows, uvec4(kNodes.x)));
  }
  column.even_overlap = mix(vec4(-kMiss), vec4(d_up.z, d.xz, d_down.x), column.even_alive);
  column.odd_overlap = mix(vec4(-kMiss), vec4(d_up.w, d.yw, d_down.y), column.odd_alive);
  column.even = mix(vec4(0), max(vec4(w_up.z, w.xz, w_down.x), 0.0), column.even_alive);
  column.odd = mix(vec4(0), max(vec4(w_up.w, w.yw, w_down.y), 0.0), column.odd_alive);
  column.before = ownRows(column.even, column.odd);
  column.even_links = column.odd_links = uvec4(0);
  if (AREA) {
    const uint kToLinks = kLinks * kColumnsOfArray;
    uvec4 links_up = readWords(up + kToLinks), links = readWords(own + kToLinks), links_down = readWords(down + kToLinks);
    column.even_links = uvec4(links_up.z, links.xz, links_down.x);
    column.odd_links = uvec4(links_up.w, links.yw, links_down.y);
  }
  setRowLinks(column);
  return column;
}

// The equation of nodes: sum of link w', N, and the diagonal, N/m.
struct Equation {
  vec4 pull, diagonal;
};

Equation evenEquation(Column column, Column left, Column right, Links to_left, Links to_right) {
  vec4 up = previous(column.odd_even), down = column.even_odd;
  vec4 pull = up * previous(column.odd) + down * column.odd + to_left.even * left.even + to_right.even * right.even;
  vec4 diagonal = SPRING + up + down + to_left.even + to_right.even;
  return Equation(pull, diagonal);
}

Equation oddEquation(Column column, Column left, Column right, Links to_left, Links to_right) {
  vec4 up = column.even_odd, down = column.odd_even;
  vec4 pull = up * column.even + down * next(column.even) + to_left.odd * left.odd + to_right.odd * right.odd;
  vec4 diagonal = SPRING + up + down + to_left.odd + to_right.odd;
  return Equation(pull, diagonal);
}

vec4 relaxed(vec4 w, vec4 overlap, bvec4 alive, Equation equation) {
  vec4 relaxation = AREA ? relaxationOf(equation.diagonal, SPRING + 2.0 * (LINK_X + LINK_Y)) : vec4(OVER_RELAXATION);
  vec4 free = w + relaxation * (equation.pull / equation.diagonal - w);
  return mix(vec4(0), max(free, max(overlap, 0.0)), alive);
}

// The columns of a block and around it that a pass over it holds.
struct Columns {
  Column before, q, p, e, o;
  Links before_q, q_p, p_e, e_o;
};

// Starts with columns -2 and -1 of the block; the others are never used.
Columns noColumns() {
  Columns c;
  c.before = c.q = c.p = c.e = c.o = deadColumn();
  c.before_q = c.q_p = c.p_e = c.e_o = Links(vec4(0), vec4(0));
  return c;
}

const int kFirstStep = -1, kEndStep = int(kBlockCols) / 2 + 1;

// Reads columns 2n and 2n + 1 as `e` and `o`. `stacks` are those to the left of the block, its own, and those to its right.
void advance(inout Columns c, Stack stacks[3], uvec2 corner, int n) {
  c.before = c.p;
  c.before_q = c.p_e;
  c.q = c.e;
  c.q_p = c.e_o;
  c.p = c.o;
  int last = int(kBlockCols) / 2 - 1;
  uint side = n < 0 ? 0u : n > last ? 2u : 1u;
  Stack stack = stacks[1];
  if (side == 0u) stack = stacks[0];
  if (side == 2u) stack = stacks[2];
  uvec2 start = uvec2(corner.x, corner.y + kBlockCols * side - kBlockCols);
  uint col = uint(2 * n) % kBlockCols;
  c.e = readColumn(stack, start, col);
  c.o = readColumn(stack, start, col + 1u);
  c.p_e = linksBetween(c.p, c.e);
  c.e_o = linksBetween(c.e, c.o);
}

// Sweeps a block; returns what has changed.
uint sweepBlock(uint number) {
  uvec2 block = cellNumbered(number, kBlocks.y), corner = block * kBlockSize;
  Stack stacks[3] = Stack[3](stackAt(block, -1), stackAt(block, 0), stackAt(block, 1));
  uint address = columnAddress(otherArrayOf(active_blocks[number]), number, 0);
  uint changes = 0u;
  bvec4 changed = bvec4(false);
  Columns c = noColumns();
  for (int n = kFirstStep; n < kEndStep; ++n) {
    advance(c, stacks, corner, n);
    c.p.odd = relaxed(c.p.odd, c.p.odd_overlap, c.p.odd_alive, oddEquation(c.p, c.q, c.e, c.q_p, c.p_e));
    c.e.even = relaxed(c.e.even, c.e.even_overlap, c.e.even_alive, evenEquation(c.e, c.p, c.o, c.p_e, c.e_o));
    vec4 q_odd = relaxed(c.q.odd, c.q.odd_overlap, c.q.odd_alive, oddEquation(c.q, c.before, c.p, c.before_q, c.q_p));
    vec4 p_even = relaxed(c.p.even, c.p.even_overlap, c.p.even_alive, evenEquation(c.p, c.q, c.e, c.q_p, c.p_e));
    if (n < 1) continue;
    uint at = address + uint(2 * n - 2);
    vec4 on_q = ownRows(c.q.even, q_odd), on_p = ownRows(p_even, c.p.odd);
    writeRows(at, on_q);
    writeRows(at + 1u, on_p);
    bvec4 now = bvec4(uvec4(notEqual(on_q, c.q.before)) | uvec4(notEqual(on_p, c.p.before)));
    changed = bvec4(uvec4(changed) | uvec4(now));
    if (n == 1 && any(now)) changes |= kChangedFirstCols;
    if (n == kEndStep - 1 && any(now)) changes |= kChangedLastCols;
  }
  if (any(changed)) changes |= kChanged;
  if (any(changed.xy)) changes |= kChangedFirstRows;
  if (any(changed.zw)) changes |= kChangedLastRows;
  return changes;
}

// Forces on rows 0 to 3 of a column, N.
vec4 forcesOn(Column column, Column left, Column right, Links to_left, Links to_right) {
  Equation even = evenEquation(column, left, right, to_left, to_right), odd = oddEquation(column, left, right, to_left, to_right);
  vec4 w = ownRows(column.even, column.odd);
  vec4 reaction = ownRows(even.diagonal, odd.diagonal) * w - ownRows(even.pull, odd.pull);
  return mix(vec4(0), max(reaction, 0.0), lessThanEqual(w, ownRows(column.even_overlap, column.odd_overlap)));
}

// Sums over the columns of a block.
struct BlockSums {
  vec4 total;     // force (N), force times x and y of P (N m), nodes at full depth
  vec4 of_taxel;  // forces on the rows of the last taxel, N
};

// Adds the forces on column `col` of a block whose first node is `corner`. Column i of the block in Foundation, from `address` on, becomes the sums over the
// taxel that is i taxels after that of the block's first column.
void addForces(inout BlockSums sums, vec4 force, vec4 overlap, uvec2 corner, uint col, uint address) {
  vec2 place = nodePosition(vec2(corner) + vec2(0, col));
  vec4 x = place.x + vec4(0, 1, 2, 3) * nodeSpacing().x;
  float total = dot(force, vec4(1)), moment = dot(force, x);
  sums.total += vec4(total, moment, total * place.y, dot(vec4(greaterThanEqual(overlap, vec4(AREA ? kFullDepth * THICKNESS : THICKNESS))), vec4(1)));
  sums.of_taxel += force;
  uint node = corner.y + col;
  if ((node + 1u) % kPerTaxel != 0 && col + 1u < kBlockCols) return;
  writeRows(address + node / kPerTaxel - corner.y / kPerTaxel, sums.of_taxel);
  sums.of_taxel = vec4(0);
}

// Computes the forces on a block: their sums for the taxels, and in all.
vec4 forcesOfBlock(uint number) {
  uvec2 block = cellNumbered(number, kBlocks.y), corner = block * kBlockSize;
  Stack stacks[3] = Stack[3](stackAt(block, -1), stackAt(block, 0), stackAt(block, 1));
  uint address = columnAddress(otherArrayOf(active_blocks[number]), number, 0);
  BlockSums sums = BlockSums(vec4(0), vec4(0));
  Columns c = noColumns();
  for (int n = kFirstStep; n < kEndStep; ++n) {
    advance(c, stacks, corner, n);
    vec4 on_p = forcesOn(c.p, c.q, c.e, c.q_p, c.p_e), on_e = forcesOn(c.e, c.p, c.o, c.p_e, c.e_o);
    uint col = uint(2 * n);
    if (n >= 1) addForces(sums, on_p, ownRows(c.p.even_overlap, c.p.odd_overlap), corner, col - 1u, address);
    if (n >= 0 && n + 1 < kEndStep) addForces(sums, on_e, ownRows(c.e.even_overlap, c.e.odd_overlap), corner, col, address);
  }
  return sums.total;
}

// Solves the contact of a surface; returns the sums of BlockSums::total over all blocks.
vec4 solveContact(Surface surface) {
  startBlocks(surface);
  uint num = num_listed_blocks;
  for (uint s = 0; s < SWEEPS; ++s) {
    listUnsettled(s);
    uint num_swept = num_swept_blocks, k = gl_LocalInvocationIndex;
    for (; k < num_swept; k += WORKGROUP) {
      uint block = sweep_list[k];
      sweep_list[k] = block | sweepBlock(block) << kNumberBits;
    }
    checkLoop(k < num_swept);
    workgroupBarrierWithBuffers();
    takeChanges(num_swept, s + 1u, true);
  }
  for (uint v = gl_LocalInvocationIndex; v < LANES; v += WORKGROUP) {
    vec4 sums = vec4(0);
    uint k = v;
    for (; k < num; k += LANES) sums += forcesOfBlock(block_list[k]);
    checkLoop(k < num);
    setPartial(v, sums);
  }
  workgroupBarrierWithBuffers();
  return sumOfPartials();
}
