// With AREA how far outlines cut the links (common/cut_links.glsl).
//
// A node has four arms, towards the sides of its cell, in two words; a link has the arms of the sides through which the line between its two nodes leaves their
// cells. Over a seam each of the two counts as half of the link, whatever the sizes of the cells. Four links have 1 / c in two words.

vec2 numbersOf(uint word) { return vec2(word & 0xFFFFu, word >> 16) * (1.0 / 65535.0); }
vec4 numbersOf(uvec2 words) { return vec4(numbersOf(words.x), numbersOf(words.y)); }
uvec2 wordsFor(vec4 numbers) { return uvec2(packUnorm2x16(numbers.xy), packUnorm2x16(numbers.zw)); }

uint blockOf(uvec4 link) { return bitfieldExtract(link.x, int(kLinkBlockShift), int(kLinkSidesShift - kLinkBlockShift)); }
uint nodeOf(uvec4 link) { return link.x & ((1u << kLinkBlockShift) - 1u); }
bool isActive(uvec4 link) { return (block_flags[blockOf(link)] & kIsActive) != 0; }

// Covered parts of the half links of a node, in lengths of a link.
vec4 armsOf(uint instance, uint node) { return 0.5 * numbersOf(wordsOf(foundation[forceAddress(instance, node)])); }

// Links to nodes that are not active are not cut.
void cutFourLinks(uint instance, uint node, uint four) {
  float own = pairAt(pairAddress(instance, node)).x;
  vec4 own_arms = armsOf(instance, node), others = vec4(own), arms = vec4(0), slopes = vec4(0);
  [[unroll]] for (uint k = 0; k < 4; ++k) {
    uvec4 link = fourOf(FoundationLinks, (4u * four + k) * kNumNodes + node);
    if (!isActive(link)) continue;
    uint other = nodeOf(link), sides = link.x >> kLinkSidesShift;
    others[k] = pairAt(pairAddress(instance, other)).x;
    arms[k] = own_arms[sides & ((1u << kSideBits) - 1u)] + armsOf(instance, other)[sides >> kSideBits];
    slopes[k] = abs(own - others[k]) * uintBitsToFloat(link.z);
  }
  foundation[linksAddress(instance, four, node)] = pairOf(wordsFor(freeShares(vec4(own), others, arms, slopes)));
}

// Stores 1 / c of the links of the active nodes. All invocations call it.
void cutLinks(uint instance) {
  uint total = num_listed_blocks * kNodesPerBlock, k = gl_LocalInvocationIndex;
  for (; k < total; k += WORKGROUP) {
    uint node = listedNode(k).y, num_fours = fourOf(FoundationNodes, node).w >> kNodeLinksShift;
    for (uint four = 0; four < NUM_FOURS; ++four) {
      if (NUM_FOURS > 1 && four >= num_fours) break;
      cutFourLinks(instance, node, four);
    }
  }
  checkLoop(k < total);
  workgroupBarrierWithBuffers();
}

// 1 / c of four links of a node.
vec4 freeSharesOf(uint instance, uint node, uint four) { return numbersOf(wordsOf(foundation[linksAddress(instance, four, node)])); }
