// Arrays over blocks of kBlockRows x kBlockCols nodes in foundation[]: kNumArrays per instance, each (num_blocks x kBlockCols x kBlockRows) words in pairs.

const uint kOverlap = 0u, kFirst = 1u, kSecond = 2u;  // signed overlap, m; displacements, m, of which one becomes the forces, N
const uint kLinks = 3u;                                 // with AREA: 1 / c of the links to the next row and column, in 16 bits each, cells.glsl
const uint kNumArrays = AREA ? 4u : 3u;
const uint kColumnPairs = kBlockRows / 2u;                            // of a column of a block
const uvec2 kBlockSize = uvec2(kBlockRows, kBlockCols);
const uint kBlocksAlongRows = (kNodeRows + kBlockRows - 1u) / kBlockRows, kBlocksAlongCols = (kNodeCols + kBlockCols - 1u) / kBlockCols;
const uvec2 kBlocks = uvec2(kBlocksAlongRows, kBlocksAlongCols);
const uint kNumBlocks = kBlocksAlongRows * kBlocksAlongCols;

// The first pair of a column.
uint columnAddress(uint instance, uint array, uint block, uint col) {
  return (((instance * kNumArrays + array) * kNumBlocks + block) * kBlockCols + col) * kColumnPairs;
}

vec2 pairAt(uint address) { return uintBitsToFloat(wordsOf(foundation[address])); }

vec4 readRows(uint address) { return vec4(pairAt(address), pairAt(address + 1u)); }

void writeRows(uint address, vec4 rows) {
  foundation[address] = pairOf(floatBitsToUint(rows.xy));
  foundation[address + 1u] = pairOf(floatBitsToUint(rows.zw));
}

uvec4 readWords(uint address) { return uvec4(wordsOf(foundation[address]), wordsOf(foundation[address + 1u])); }

void writeWords(uint address, uvec4 rows) {
  foundation[address] = pairOf(rows.xy);
  foundation[address + 1u] = pairOf(rows.zw);
}
