// Arrays of a linked foundation.
//
// foundation[] has per instance a pair for every node, overlap d and displacement w (m); a pair for every node with its force (N), which before the solution are
// its arms with AREA (links.glsl); three pairs for every block with its sums (outputs.glsl); with AREA NUM_FOURS pairs for every node with its links (links.glsl).

const uint kNodesPerSide = SAMPLES * NODES_PER_SAMPLE;
const uint kNodesPerTaxel = kNodesPerSide * kNodesPerSide;
const uint kNumNodes = NUM_TAXELS * kNodesPerTaxel;
const uint kNodesPerBlock = kNodesPerTaxel / BLOCKS_PER_TAXEL;
const uint kNumBlocks = NUM_TAXELS * BLOCKS_PER_TAXEL;
const uint kFirstOfLinks = 2u * kNumNodes + 3u * kNumBlocks;
const uint kNumPairs = kFirstOfLinks + (AREA ? NUM_FOURS * kNumNodes : 0u);

uint pairAddress(uint instance, uint node) { return instance * kNumPairs + node; }
uint forceAddress(uint instance, uint node) { return instance * kNumPairs + kNumNodes + node; }
uint sumsAddress(uint instance, uint block) { return instance * kNumPairs + 2u * kNumNodes + 3u * block; }
uint linksAddress(uint instance, uint four, uint node) { return instance * kNumPairs + kFirstOfLinks + four * kNumNodes + node; }

vec2 pairAt(uint address) { return uintBitsToFloat(wordsOf(foundation[address])); }
void writePair(uint address, vec2 pair) { foundation[address] = pairOf(floatBitsToUint(pair)); }
