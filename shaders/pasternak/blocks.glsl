// Which blocks of nodes are solved: the active ones, within MARGIN nodes of an overlap. The nodes of a block that lie beyond the array, if any, are dead, and so
// are those of blocks that are not active.
// Shared memory: 8 kNumBlocks + 20 bytes.

shared uint active_blocks[kNumBlocks];  // 1 or 0
shared uint block_list[kNumBlocks];     // numbers of the active ones, in ascending order
shared uint num_listed_blocks;
shared uint block_bounds[4];  // of the active ones: first row, end row, first col, end col

bool isWithin(uint value, uint first, uint count) { return value - first < count; }  // wraps below first

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

// Activates the blocks near the nodes from `first` to `last`.
void activateAround(uvec2 first, uvec2 last) {
  Window near = blocksOf(widened(Window(first, last - first + 1u), MARGIN));
  for (uint i = 0; i < near.count.x; ++i) {
    for (uint j = 0; j < near.count.y; ++j) active_blocks[(near.first.x + i) * kBlocks.y + near.first.y + j] = 1u;
  }
}

// Stores the overlaps of a block at those of its nodes that a tile has reached.
void setOverlaps(uint instance, Surface surface, Window reached, uvec2 block) {
  const bool kSplits = kPerTaxel % kBlockRows != 0;  // whether a block may have rows of two tiles
  uvec2 corner = block * kBlockSize, first = kNodes, last = uvec2(0);
  uint address = columnAddress(instance, kOverlap, block.x * kBlocks.y + block.y, 0);
  for (uint col = 0; col < kBlockCols; ++col) {
    if (!isWithin(corner.y + col, reached.first.y, reached.count.y)) continue;
    vec4 height = vec4(kMiss);
    bvec4 here = bvec4(false);
    for (uint r = 0; r < kBlockRows; ++r) {
      here[r] = isWithin(corner.x + r, reached.first.x, reached.count.x);
      if (here[r]) height[r] = heightAt(surface, corner + uvec2(r, col));
    }
    vec4 overlap = overlapOf(surface, height);
    if (kSplits) overlap = mix(readRows(address + col), overlap, here);
    writeRows(address + col, overlap);
    for (uint r = 0; r < kBlockRows; ++r) {
      if (!here[r] || overlap[r] <= 0.0) continue;
      first = min(first, corner + uvec2(r, col));
      last = max(last, corner + uvec2(r, col));
    }
  }
  if (first.x < kNodes.x) activateAround(first, last);
}

// Lists the active blocks.
void listBlocks() {
  if (gl_LocalInvocationIndex == 0) {
    uint count = 0;
    uvec4 bounds = uvec4(kBlocks.x, 0, kBlocks.y, 0);
    for (uint block = 0; block < kNumBlocks; ++block) {
      if (active_blocks[block] == 0) continue;
      block_list[count] = block;
      ++count;
      uvec2 at = cellNumbered(block, kBlocks.y);
      bounds = uvec4(min(bounds.x, at.x), max(bounds.y, at.x + 1u), min(bounds.z, at.y), max(bounds.w, at.y + 1u));
    }
    num_listed_blocks = count;
    for (uint k = 0; k < 4; ++k) block_bounds[k] = count > 0 ? bounds[k] : 0u;
  }
  workgroupBarrierWithBuffers();
}

// With AREA stores overlaps and arms of a block. The contact pass has written heights and cells of all nodes.
void setCutNodes(uint instance, Surface surface, uvec2 block) {
  uvec2 corner = block * kBlockSize, first = kNodes, last = uvec2(0);
  uint address = columnAddress(instance, kOverlap, block.x * kBlocks.y + block.y, 0);
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
  if (first.x < kNodes.x) activateAround(first, last);
}

// With AREA sets overlaps, active blocks and links of the blocks around the object.
void startLinks(uint instance, Surface surface, Window near) {
  workgroupBarrier();
  uint total = near.count.x * near.count.y, k = gl_LocalInvocationIndex;
  for (; k < total; k += WORKGROUP) setCutNodes(instance, surface, near.first + cellNumbered(k, near.count.y));
  checkLoop(k < total);
  workgroupBarrierWithBuffers();
  listBlocks();
  k = gl_LocalInvocationIndex;
  for (; k < num_listed_blocks; k += WORKGROUP) setLinks(instance, block_list[k]);
  checkLoop(k < num_listed_blocks);
  workgroupBarrierWithBuffers();
}

// Sets the overlaps of the blocks around the object, and which of them are active.
void startBlocks(uint instance, Surface surface) {
  for (uint block = gl_LocalInvocationIndex; block < kNumBlocks; block += WORKGROUP) active_blocks[block] = 0;
  Window near = blocksOf(widened(allReachedNodes(surface), MARGIN));
  uint total = near.count.x * near.count.y, k = gl_LocalInvocationIndex;
  if (AREA) {
    startLinks(instance, surface, near);
    return;
  }
  for (; k < total; k += WORKGROUP) {
    uvec2 block = near.first + cellNumbered(k, near.count.y);
    uint address = columnAddress(instance, kOverlap, block.x * kBlocks.y + block.y, 0);
    for (uint col = 0; col < kBlockCols; ++col) writeRows(address + col, vec4(-kMiss));
  }
  checkLoop(k < total);
  workgroupBarrierWithBuffers();
  for (uint t = 0; t < NUM_HEIGHT_TILES; ++t) {
    Window reached = reachedNodes(surface, t), blocks = blocksOf(reached);
    total = blocks.count.x * blocks.count.y;
    k = gl_LocalInvocationIndex;
    for (; k < total; k += WORKGROUP) setOverlaps(instance, surface, reached, blocks.first + cellNumbered(k, blocks.count.y));
    checkLoop(k < total);
    workgroupBarrierWithBuffers();
  }
  listBlocks();
}
