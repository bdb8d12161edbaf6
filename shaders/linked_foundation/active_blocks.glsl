// The blocks whose nodes are solved: the active ones, which have a node near a block with a node that overlaps the object.
// Shared memory: 8 kNumBlocks + 12 bytes.

// Flags of a block.
const uint kIsNear = 1u;     // the windows of tiles reach it: its nodes have heights
const uint kIsTouched = 2u;  // a node overlaps
const uint kIsActive = 4u;

shared uint block_flags[kNumBlocks];
shared uint block_list[kNumBlocks];  // numbers of those that were listed last, in ascending order
shared uint num_listed_blocks;
shared uint is_too_deep;      // 1: a node is at the skin's full thickness
shared uint deepest_overlap;  // with AREA and LOADS: of a node, m, as the bits of a float that is not negative

// Whether the window of a tile has any of the nodes: first row, end row, first column, end column.
bool isAnyIn(uint instance, uint tile, uvec4 nodes) {
  uvec4 window = windows[instance * NUM_HEIGHT_TILES + tile].window;
  return all(lessThan(max(nodes.xz, window.xz), min(nodes.yw, window.yw)));
}

bool isNear(uint instance, uint block) {
  uvec4 tiles = foundation_blocks[block].tiles, nodes = foundation_blocks[block].nodes;
  if (isAnyIn(instance, tiles.x, nodes)) return true;
  if (all(equal(tiles, tiles.xxxx))) return false;
  return isAnyIn(instance, tiles.y, nodes) || isAnyIn(instance, tiles.z, nodes) || isAnyIn(instance, tiles.w, nodes);
}

// Lists the blocks with a flag. All invocations call it.
void listBlocks(uint flag) {
  workgroupBarrier();
  if (gl_LocalInvocationIndex == 0) {
    uint count = 0, block = 0;
    for (; block < kNumBlocks; ++block) {
      if ((block_flags[block] & flag) == 0) continue;
      block_list[count] = block;
      ++count;
    }
    checkLoop(block < kNumBlocks);
    num_listed_blocks = count;
  }
  workgroupBarrierWithBuffers();
}

// The k-th node of the listed blocks: the place of its block in the list, and its number.
uvec2 listedNode(uint k) {
  uvec2 at = cellNumbered(k, kNodesPerBlock);
  return uvec2(at.x, block_list[at.x] * kNodesPerBlock + at.y);
}

// Stores the overlaps of the blocks near the object.
void setOverlaps(uint instance) {
  uint total = num_listed_blocks * kNodesPerBlock, k = gl_LocalInvocationIndex;
  for (; k < total; k += WORKGROUP) {
    uvec2 at = listedNode(k);
    uvec2 arms;
    float overlap = overlapOf(instance, at.y, arms);
    writePair(pairAddress(instance, at.y), vec2(overlap, max(overlap, 0.0)));
    if (AREA) foundation[forceAddress(instance, at.y)] = pairOf(arms);
    if (LOADS && overlap >= fullOverlap()) atomicOr(is_too_deep, 1u);
    if (LOADS && AREA) atomicMax(deepest_overlap, floatBitsToUint(max(overlap, 0.0)));
    if (overlap > 0.0) atomicOr(block_flags[block_list[at.x]], kIsTouched);
  }
  checkLoop(k < total);
}

void activateAround(uint block) {
  uvec4 near = foundation_blocks[block].near;
  uint i = near.x;
  for (; i < near.y; ++i) atomicOr(block_flags[near_blocks[i]], kIsActive);
  checkLoop(i < near.y);
}

// Lists the active blocks and starts their nodes from the object's surface.
void startBlocks(uint instance) {
  workgroupBarrier();
  if (gl_LocalInvocationIndex == 0) is_too_deep = deepest_overlap = 0;
  uint b = gl_LocalInvocationIndex;
  for (; b < kNumBlocks; b += WORKGROUP) block_flags[b] = isNear(instance, b) ? kIsNear : 0u;
  checkLoop(b < kNumBlocks);
  listBlocks(kIsNear);
  setOverlaps(instance);
  workgroupBarrier();
  for (uint i = gl_LocalInvocationIndex; i < num_listed_blocks; i += WORKGROUP) {
    if ((block_flags[block_list[i]] & kIsTouched) != 0) activateAround(block_list[i]);
  }
  listBlocks(kIsActive);
  uint total = num_listed_blocks * kNodesPerBlock, k = gl_LocalInvocationIndex;
  for (; k < total; k += WORKGROUP) {
    uvec2 at = listedNode(k);
    if ((block_flags[block_list[at.x]] & kIsNear) != 0) continue;
    writePair(pairAddress(instance, at.y), vec2(-kMiss, 0));
    if (AREA) foundation[forceAddress(instance, at.y)] = pairOf(uvec2(0));
  }
  checkLoop(k < total);
  workgroupBarrierWithBuffers();
}
