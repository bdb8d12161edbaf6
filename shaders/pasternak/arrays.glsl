// Arrays over blocks of kBlockRows x kBlockCols nodes, Foundation: kNumArrays per workgroup, each (num_blocks x kBlockCols) columns of kBlockRows words. A workgroup
// uses them for all of its instances, so that they stay in a processor's caches.

const uint kOverlap = 0u, kFirst = 1u, kSecond = 2u;  // signed overlap, m; displacements, m: for each block one has them, and the other one becomes the forces, N
const uint kLinks = 3u;                                 // with AREA: 1 / c of the links to the next row and column, in 16 bits each, cells.glsl
const uint kNumArrays = AREA ? 4u : 3u;
const uvec2 kBlockSize = uvec2(kBlockRows, kBlockCols);
const uint kBlocksAlongRows = (kNodeRows + kBlockRows - 1u) / kBlockRows, kBlocksAlongCols = (kNodeCols + kBlockCols - 1u) / kBlockCols;
const uvec2 kBlocks = uvec2(kBlocksAlongRows, kBlocksAlongCols);
const uint kNumBlocks = kBlocksAlongRows * kBlocksAlongCols;
const uint kColumnsOfArray = kNumBlocks * kBlockCols;

// A column of a block.
uint columnAddress(uint array, uint block, uint col) { return ((workgroupNumber() * kNumArrays + array) * kNumBlocks + block) * kBlockCols + col; }

uvec4 readWords(uint address) { return loadFour(FoundationRows, address); }
vec4 readRows(uint address) { return uintBitsToFloat(readWords(address)); }

void writeWords(uint address, uvec4 rows) {
  foundation[2u * address] = pairOf(rows.xy);
  foundation[2u * address + 1u] = pairOf(rows.zw);
}
void writeRows(uint address, vec4 rows) { writeWords(address, floatBitsToUint(rows)); }
