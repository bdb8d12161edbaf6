// Arrays of a linked foundation, and the taxels whose nodes are solved: the active ones, which have a node near one that overlaps the object.
//
// foundation[] has per instance a pair for every node, overlap d and displacement w (m); a pair for every node with its force (N); two pairs for every taxel
// with its sums (outputs.glsl).
// Shared memory: 8 NUM_TAXELS + 4 bytes.

const uint kNodesPerSide = SAMPLES * NODES_PER_SAMPLE;
const uint kNodesPerTaxel = kNodesPerSide * kNodesPerSide;
const uint kNumNodes = NUM_TAXELS * kNodesPerTaxel;
const uint kNumPairs = 2u * (kNumNodes + NUM_TAXELS);

// Flags of a taxel.
const uint kIsNear = 1u;     // an object's bounds reach it: its nodes have heights
const uint kIsTouched = 2u;  // a node overlaps
const uint kIsActive = 4u;

shared uint taxel_flags[NUM_TAXELS];
shared uint taxel_list[NUM_TAXELS];  // numbers of those that were listed last, in ascending order
shared uint num_listed_taxels;

uint pairAddress(uint instance, uint node) { return instance * kNumPairs + node; }
uint forceAddress(uint instance, uint node) { return instance * kNumPairs + kNumNodes + node; }
uint sumsAddress(uint instance, uint taxel) { return instance * kNumPairs + 2u * (kNumNodes + taxel); }

vec2 pairAt(uint address) { return uintBitsToFloat(wordsOf(foundation[address])); }
void writePair(uint address, vec2 pair) { foundation[address] = pairOf(floatBitsToUint(pair)); }

bool isAnyIn(uint instance, uint tile) {
  uvec4 window = windows[instance * NUM_HEIGHT_TILES + tile].window;
  return window.x < window.y && window.z < window.w;
}

bool isNear(uint instance, uint taxel) {
  uvec4 tiles = foundation_taxels[taxel].tiles;
  return isAnyIn(instance, tiles.x) || isAnyIn(instance, tiles.y) || isAnyIn(instance, tiles.z) || isAnyIn(instance, tiles.w);
}

// Lists the taxels with a flag. All invocations call it.
void listTaxels(uint flag) {
  workgroupBarrier();
  if (gl_LocalInvocationIndex == 0) {
    uint count = 0, taxel = 0;
    for (; taxel < NUM_TAXELS; ++taxel) {
      if ((taxel_flags[taxel] & flag) == 0) continue;
      taxel_list[count] = taxel;
      ++count;
    }
    checkLoop(taxel < NUM_TAXELS);
    num_listed_taxels = count;
  }
  workgroupBarrierWithBuffers();
}

// The k-th node of the listed taxels: its place in the list, and its number.
uvec2 listedNode(uint k) {
  uvec2 at = cellNumbered(k, kNodesPerTaxel);
  return uvec2(at.x, taxel_list[at.x] * kNodesPerTaxel + at.y);
}

// Signed overlap of object and undeformed skin at a node, m.
float overlapOf(uint instance, uint node) {
  uvec4 record = fourOf(FoundationNodes, node);
  uvec2 at = uvec2(record.y >> 16, record.y & 0xFFFFu);
  uint tile = record.w & ((1u << kNodeLinksShift) - 1u);
  if (!isInside(at, windows[instance * NUM_HEIGHT_TILES + tile].window)) return -kMiss;
  return min(-uintBitsToFloat(heights[instance * kNumNodes + record.x]), THICKNESS);
}

// Stores the overlaps of the taxels near the object.
void setOverlaps(uint instance) {
  uint total = num_listed_taxels * kNodesPerTaxel, k = gl_LocalInvocationIndex;
  for (; k < total; k += WORKGROUP) {
    uvec2 at = listedNode(k);
    float overlap = overlapOf(instance, at.y);
    writePair(pairAddress(instance, at.y), vec2(overlap, max(overlap, 0.0)));
    if (overlap > 0.0) atomicOr(taxel_flags[taxel_list[at.x]], kIsTouched);
  }
  checkLoop(k < total);
}

void activateAround(uint taxel) {
  uvec4 near = foundation_taxels[taxel].near;
  uint i = near.x;
  for (; i < near.y; ++i) atomicOr(taxel_flags[near_taxels[i]], kIsActive);
  checkLoop(i < near.y);
}

// Lists the active taxels and starts their nodes from the object's surface.
void startTaxels(uint instance) {
  workgroupBarrier();
  for (uint t = gl_LocalInvocationIndex; t < NUM_TAXELS; t += WORKGROUP) taxel_flags[t] = isNear(instance, t) ? kIsNear : 0u;
  listTaxels(kIsNear);
  setOverlaps(instance);
  workgroupBarrier();
  for (uint i = gl_LocalInvocationIndex; i < num_listed_taxels; i += WORKGROUP) {
    if ((taxel_flags[taxel_list[i]] & kIsTouched) != 0) activateAround(taxel_list[i]);
  }
  listTaxels(kIsActive);
  uint total = num_listed_taxels * kNodesPerTaxel, k = gl_LocalInvocationIndex;
  for (; k < total; k += WORKGROUP) {
    uvec2 at = listedNode(k);
    if ((taxel_flags[taxel_list[at.x]] & kIsNear) == 0) writePair(pairAddress(instance, at.y), vec2(-kMiss, 0));
  }
  checkLoop(k < total);
  workgroupBarrierWithBuffers();
}
