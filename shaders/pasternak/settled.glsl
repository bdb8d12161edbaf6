// Blocks that a sweep need not compute. Where neither a block nor what its nodes read of the blocks around it changed in the sweep before, this sweep would give the
// same displacements: blocks inside the contact, whose nodes stay at their overlap, and blocks that the displacement has not reached yet. Each block has its
// displacements in an array of its own choice, since a block that is swept writes the other one.
//
// active_blocks[]: the array with the displacements plus 1 (2 bits), kChanged... (5 bits), and the number of sweeps after which these apply.
// Shared memory: 4 kNumBlocks + 4 bytes.

shared uint sweep_list[kNumBlocks];  // numbers of the blocks to be swept, in any order; in the high bits what their sweep changed, as kChanged...
shared uint num_swept_blocks;
const uint kNumberBits = 16u;
const uint kAtOverlap = kOverlap + 1u;
// What has changed of a block: any node, the outer two of its rows and columns.
const uint kChanged = 1u, kChangedFirstRows = 2u, kChangedLastRows = 4u, kChangedFirstCols = 8u, kChangedLastCols = 16u;

// The array that has the displacements of an active block.
uint arrayOf(uint word) { return (word & 3u) - 1u; }

// The array that its next sweep writes.
uint otherArrayOf(uint word) { return arrayOf(word) == kFirst ? kSecond : kFirst; }

// Changes of the nodes of a block from `first` to `last`.
uint changesOf(uvec2 first, uvec2 last) {
  return kChanged | (first.x < 2u ? kChangedFirstRows : 0u) | (last.x >= kBlockRows - 2u ? kChangedLastRows : 0u) |
         (first.y < 2u ? kChangedFirstCols : 0u) | (last.y >= kBlockCols - 2u ? kChangedLastCols : 0u);
}

// Marks what has changed of the first `num` blocks of sweep_list[] in sweep number `sweep`, from 1 on; 0: before the first one. `swept`: they have been swept.
void takeChanges(uint num, uint sweep, bool swept) {
  uint k = gl_LocalInvocationIndex;
  for (; k < num; k += WORKGROUP) {
    uint entry = sweep_list[k], block = entry & (1u << kNumberBits) - 1u, word = active_blocks[block];
    if (word == 0u) continue;
    uint array = swept ? otherArrayOf(word) : arrayOf(word);
    active_blocks[block] = array + 1u | entry >> kNumberBits << 2 | sweep << 7;
  }
  checkLoop(k < num);
  if (gl_LocalInvocationIndex == 0) num_swept_blocks = 0;
  workgroupBarrierWithBuffers();
}

// Whether a block, `rows` and `cols` away, had all of the changes `which` in the last of `sweep` sweeps.
bool hasChanged(uvec2 block, int rows, int cols, uint which, uint sweep) {
  uvec2 at = block + uvec2(rows, cols);  // wraps below 0
  if (at.x >= kBlocks.x || at.y >= kBlocks.y) return false;
  uint word = active_blocks[at.x * kBlocks.y + at.y];
  return word >> 7 == sweep && (word >> 2 & which) == which;
}

bool isUnsettled(uvec2 block, uint sweep) {
  bool changed = hasChanged(block, 0, 0, kChanged, sweep);
  changed = changed || hasChanged(block, -1, 0, kChangedLastRows, sweep) || hasChanged(block, 1, 0, kChangedFirstRows, sweep);
  changed = changed || hasChanged(block, 0, -1, kChangedLastCols, sweep) || hasChanged(block, 0, 1, kChangedFirstCols, sweep);
  changed = changed || hasChanged(block, -1, -1, kChangedLastRows | kChangedLastCols, sweep);
  changed = changed || hasChanged(block, -1, 1, kChangedLastRows | kChangedFirstCols, sweep);
  changed = changed || hasChanged(block, 1, -1, kChangedFirstRows | kChangedLastCols, sweep);
  return changed || hasChanged(block, 1, 1, kChangedFirstRows | kChangedFirstCols, sweep);
}

// Lists the blocks that the sweep after `sweep` sweeps may change.
void listUnsettled(uint sweep) {
  uint k = gl_LocalInvocationIndex;
  for (; k < num_listed_blocks; k += WORKGROUP) {
    uint block = block_list[k];
    if (isUnsettled(cellNumbered(block, kBlocks.y), sweep)) sweep_list[atomicAdd(num_swept_blocks, 1u)] = block;
  }
  checkLoop(k < num_listed_blocks);
  workgroupBarrier();
}
