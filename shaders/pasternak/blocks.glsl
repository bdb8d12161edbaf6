// Which blocks of nodes are solved: the active ones, within MARGIN nodes of an overlap. The nodes of a block that lie beyond the array, if any, are dead, and so
// are those of blocks that are not active.
// Shared memory: 8 kNumBlocks + 52 bytes, and that of settled.glsl.

shared uint active_blocks[kNumBlocks];  // words of shaders/pasternak/settled.glsl; 0 if not active
shared uint block_list[kNumBlocks];     // numbers of the active ones, in ascending order
shared uint num_listed_blocks;
shared uint block_bounds[4];  // of the active ones: first row, end row, first col, end col; end 0 without any
const uint kParts = 8u;       // of the blocks to be listed
shared uint active_of_part[kParts];

#include "pasternak/settled.glsl"

bool isWithin(uint value, uint first, uint count) { return value - first < count; }  // wraps below first

// Number of the k-th block of a window.
uint blockOf(Window blocks, uint k) {
  uvec2 at = blocks.first + cellNumbered(k, blocks.count.y);
  return at.x * kBlocks.y + at.y;
}

// The blocks that hold the nodes of a window.
Window blocksOf(Window window) {
  if (window.count.x == 0 || window.count.y == 0) return Window(uvec2(0), uvec2(0));
  uvec2 first = window.first / kBlockSize;
  return Window(first, (window.first + window.count - 1u) / kBlockSize + 1u - first);
}

Window widened(Window window, uint margin) {
  if (window.count.x == 0) return window;
  uvec2 first = window.first - min(window.first, uvec2(margin));
  return Window(first, min(window.first + window.count + margin, kNodes) - first);
}

// Activates the blocks near the nodes of a block from `first` to `last`. Returns where these are, as kChanged...
uint activateAround(uvec2 first, uvec2 last) {
  Window near = blocksOf(widened(Window(first, last - first + 1u), MARGIN));
  for (uint i = 0; i < near.count.x; ++i) {
    for (uint j = 0; j < near.count.y; ++j) active_blocks[(near.first.x + i) * kBlocks.y + near.first.y + j] = kAtOverlap;
  }
  return changesOf(first % kBlockSize, last % kBlockSize);
}

// The columns from `first` to before `end`, as bits, of those from `corner` on.
uint columnBits(uint first, uint end, uint corner) {
  uvec2 bits = uvec2(clamp(ivec2(first, end) - int(corner), 0, int(kBlockCols)));
  return (1u << bits.y) - 1u & ~((1u << bits.x) - 1u);
}

// The nodes of a block that a tile has reached: columns of each row, as bits.
uvec4 reachedBits(Surface surface, uint tile, uvec2 corner) {
  Window reached = reachedNodes(surface, tile);
  uvec4 rows = corner.x + uvec4(0, 1, 2, 3) - reached.first.x;  // wraps below the first one
  return columnBits(reached.first.y, reached.first.y + reached.count.y, corner.y) * uvec4(lessThan(rows, uvec4(reached.count.x)));
}

// Stores the overlaps of a block, of which any tiles of the contact pass may have reached any nodes, and activates the blocks around them. Returns where they are, as
// kChanged...
uint setOverlaps(Surface surface, uvec2 block) {
  uvec2 corner = block * kBlockSize;
  uint address = columnAddress(kOverlap, block.x * kBlocks.y + block.y, 0);
  uvec4 reached = uvec4(0), overlaps = uvec4(0);
  for (uint t = 0; t < NUM_HEIGHT_TILES; ++t) reached |= reachedBits(surface, t, corner);
  for (uint start = 0; start < kBlockCols; start += 4u) {
    vec4 heights[kBlockRows];
    [[unroll]] for (uint r = 0; r < kBlockRows; ++r) heights[r] = heightsOfRow(surface, corner + uvec2(r, start));
    [[unroll]] for (uint c = 0; c < 4u; ++c) {
      vec4 height = vec4(heights[0][c], heights[1][c], heights[2][c], heights[3][c]);
      vec4 overlap = overlapOf(surface, mix(vec4(kMiss), height, equal(reached >> start + c & 1u, uvec4(1))));
      writeRows(address + start + c, overlap);
      overlaps |= uvec4(greaterThan(overlap, vec4(0))) << start + c;
    }
  }
  uint cols = overlaps.x | overlaps.y | overlaps.z | overlaps.w;
  if (cols == 0u) return 0u;
  uvec4 any_of_row = uvec4(notEqual(overlaps, uvec4(0)));
  uint rows = any_of_row.x | any_of_row.y << 1 | any_of_row.z << 2 | any_of_row.w << 3;
  return activateAround(corner + uvec2(findLSB(rows), findLSB(cols)), corner + uvec2(findMSB(rows), findMSB(cols)));
}

// Lists the active blocks, which are among `near`. Each of kParts invocations lists a part of them.
void listBlocks(Window near) {
  uint total = near.count.x * near.count.y, most = (total + kParts - 1u) / kParts, v = gl_LocalInvocationIndex;
  for (; v < kParts; v += WORKGROUP) {
    uint count = 0;
    for (uint k = v * most; k < min(total, (v + 1u) * most); ++k) count += active_blocks[blockOf(near, k)] != 0u ? 1u : 0u;
    active_of_part[v] = count;
  }
  workgroupBarrier();
  for (v = gl_LocalInvocationIndex; v < kParts; v += WORKGROUP) {
    uint count = 0;
    for (uint part = 0; part < v; ++part) count += active_of_part[part];
    uvec4 bounds = uvec4(kBlocks.x, 0, kBlocks.y, 0);
    for (uint k = v * most; k < min(total, (v + 1u) * most); ++k) {
      uint block = blockOf(near, k);
      if (active_blocks[block] == 0) continue;
      block_list[count] = block;
      ++count;
      uvec2 at = cellNumbered(block, kBlocks.y);
      bounds = uvec4(min(bounds.x, at.x), max(bounds.y, at.x + 1u), min(bounds.z, at.y), max(bounds.w, at.y + 1u));
    }
    if (v == kParts - 1u) num_listed_blocks = count;
    atomicMin(block_bounds[0], bounds.x);
    atomicMax(block_bounds[1], bounds.y);
    atomicMin(block_bounds[2], bounds.z);
    atomicMax(block_bounds[3], bounds.w);
  }
  workgroupBarrierWithBuffers();
}

// With AREA stores overlaps and arms of a block, and activates the blocks around its overlaps. Returns where these are, as kChanged... The contact pass has
// written heights and cells of all nodes.
uint setCutNodes(Surface surface, uvec2 block) {
  uvec2 corner = block * kBlockSize, first = kNodes, last = uvec2(0);
  uint address = columnAddress(kOverlap, block.x * kBlocks.y + block.y, 0);
  for (uint col = 0; col < kBlockCols; ++col) {
    vec4 height = vec4(kMiss);
    Arms arms = noArms();
    [[unroll]] for (uint r = 0; r < kBlockRows; ++r) {
      uvec2 node = corner + uvec2(r, col);
      if (all(lessThan(node, kNodes))) height[r] = cutNode(surface, node, r, arms);
    }
    vec4 overlap = overlapOf(surface, height);
    writeRows(address + col, overlap);
    writeArms(address + col, arms);
    [[unroll]] for (uint r = 0; r < kBlockRows; ++r) {
      if (overlap[r] <= 0.0) continue;
      first = min(first, corner + uvec2(r, col));
      last = max(last, corner + uvec2(r, col));
    }
  }
  return first.x < kNodes.x ? activateAround(first, last) : 0u;
}

// With AREA sets overlaps, active blocks and links of the blocks around the object.
void startLinks(Surface surface, Window near) {
  uint total = near.count.x * near.count.y, k = gl_LocalInvocationIndex;
  for (; k < total; k += WORKGROUP) {
    sweep_list[k] = blockOf(near, k) | setCutNodes(surface, near.first + cellNumbered(k, near.count.y)) << kNumberBits;
  }
  checkLoop(k < total);
  workgroupBarrierWithBuffers();
  listBlocks(near);
  takeChanges(total, 0u, false);
  k = gl_LocalInvocationIndex;
  for (; k < num_listed_blocks; k += WORKGROUP) setLinks(block_list[k]);
  checkLoop(k < num_listed_blocks);
  workgroupBarrierWithBuffers();
}

// Sets the overlaps of the blocks around the object, and which of them are active.
void startBlocks(Surface surface) {
  for (uint block = gl_LocalInvocationIndex; block < kNumBlocks; block += WORKGROUP) active_blocks[block] = 0;
  for (uint v = gl_LocalInvocationIndex; v < 4u; v += WORKGROUP) block_bounds[v] = v % 2u == 0u ? kNumBlocks : 0u;
  workgroupBarrier();
  Window near = blocksOf(widened(allReachedNodes(surface), MARGIN));
  if (AREA) {
    startLinks(surface, near);
    return;
  }
  uint total = near.count.x * near.count.y, k = gl_LocalInvocationIndex;
  for (; k < total; k += WORKGROUP) {
    sweep_list[k] = blockOf(near, k) | setOverlaps(surface, near.first + cellNumbered(k, near.count.y)) << kNumberBits;
  }
  checkLoop(k < total);
  workgroupBarrier();
  listBlocks(near);
  takeChanges(total, 0u, false);
}
