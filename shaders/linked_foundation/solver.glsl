// Displacements of a linked foundation under a rigid surface, by a fixed number of sweeps of projected successive over-relaxation, color by color.
//
//   spring w + sum over links of c link (w - w') = f >= 0,   w >= d,   f (w - d) = 0
//
// c as in pasternak/solver.glsl: 2 where an outline of the object crosses a link, on average half-way; with AREA links.glsl has c. Beyond the active blocks the surface decays
// exponentially; the springs of nodes at the end of the skin include what the surface beyond it adds.

// The equation of a node: sum of link (w - w'), N; its spring; sum of spring and links, N/m, and with AREA of links that are not cut. The difference keeps what
// the pulls of the links have in common out of the rounding.
struct Equation {
  float tension, spring, diagonal, whole;
};

// `own`: overlap and displacement of the node.
Equation equationOf(uint instance, uint node, vec2 own) {
  uvec4 record = fourOf(FoundationNodes, node);
  float tension = 0.0, diagonal = uintBitsToFloat(record.z);
  float whole = uintBitsToFloat(record.z);
  for (uint i = 0; i < NUM_FOURS; ++i) {
    if (NUM_FOURS > 1 && i >= record.w >> kNodeLinksShift) break;
    vec4 free = AREA ? freeSharesOf(instance, node, i) : vec4(1);
    [[unroll]] for (uint k = 0; k < 4; ++k) {
      uvec4 link = fourOf(FoundationLinks, (4u * i + k) * kNumNodes + node);
      vec3 numbers = uintBitsToFloat(link.yzw);  // stiffness, 1 / length, stiffness towards skin at rest
      bool is_active = isActive(link);
      vec2 other = pairAt(pairAddress(instance, nodeOf(link)));
      float steep = clamp(abs(own.x - other.x) * numbers.y - 1.0, 0.0, 1.0);
      float factor = max(own.x, other.x) > 0.0 ? 1.0 + steep : 1.0;
      if (AREA) factor = 1.0 / free[k];
      if (AREA) whole += is_active ? numbers.x : numbers.z;
      float stiffness = is_active ? numbers.x * factor : numbers.z;
      tension += stiffness * (own.y - (is_active ? other.y : 0.0));
      diagonal += stiffness;
    }
  }
  return Equation(tension, uintBitsToFloat(record.z), diagonal, whole);
}

// First and end of the nodes of a color, from the first node of the block on.
uvec2 nodesOfColor(uint block, uint color) {
  uvec4 ends = foundation_blocks[block].color_ends;
  uint end = ends[color / 2u] >> 16u * (color % 2u) & 0xFFFFu, before = color - 1u;
  return uvec2(color == 0u ? 0u : ends[before / 2u] >> 16u * (before % 2u) & 0xFFFFu, end);
}

void sweepColor(uint instance, uint color) {
  uint total = num_listed_blocks * MOST_OF_COLOR, k = gl_LocalInvocationIndex;
  for (; k < total; k += WORKGROUP) {
    uvec2 at = cellNumbered(k, MOST_OF_COLOR);
    uint block = block_list[at.x];
    uvec2 nodes = nodesOfColor(block, color);
    if (nodes.x + at.y >= nodes.y) continue;
    uint node = block * kNodesPerBlock + nodes.x + at.y;
    vec2 own = pairAt(pairAddress(instance, node));
    Equation equation = equationOf(instance, node, own);
    float relaxation = AREA ? relaxationOf(vec4(equation.diagonal), equation.whole).x : OVER_RELAXATION;
    float free = own.y - relaxation * (equation.tension + equation.spring * own.y) / equation.diagonal;
    writePair(pairAddress(instance, node), vec2(own.x, max(free, max(own.x, 0.0))));
  }
  checkLoop(k < total);
}

// Solves the contact and stores the forces on the nodes of the active blocks.
void solveContact(uint instance) {
  for (uint s = 0; s < SWEEPS; ++s) {
    for (uint color = 0; color < NUM_COLORS; ++color) {
      sweepColor(instance, color);
      workgroupBarrierWithBuffers();
    }
  }
  uint total = num_listed_blocks * kNodesPerBlock, k = gl_LocalInvocationIndex;
  for (; k < total; k += WORKGROUP) {
    uint node = listedNode(k).y;
    vec2 own = pairAt(pairAddress(instance, node));
    Equation equation = equationOf(instance, node, own);
    float reaction = equation.tension + equation.spring * own.y;
    writePair(forceAddress(instance, node), vec2(own.y <= own.x ? max(reaction, 0.0) : 0.0, 0));
  }
  checkLoop(k < total);
  workgroupBarrierWithBuffers();
}
