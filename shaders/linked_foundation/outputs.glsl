// Outputs of a linked foundation: forces and depths of the taxels, and the wrench on every patch.
//
// The sums of a block: force (N); its moments about x and y of P, which are force times place (N m); nodes at full depth; overlaps (m).

// Place of a node in P, m. `record`: of the node.
vec2 nodePosition(PatchRecord patch_record, uvec4 record) {
  vec2 at = vec2(record.y >> 16, record.y & 0xFFFFu);
  return (at - 0.5 * vec2(patch_record.grid.xy - 1u)) * patch_record.spacing.xy;
}

// Sums the nodes of the active blocks.
void sumBlocks(uint instance) {
  uint i = gl_LocalInvocationIndex;
  for (; i < num_listed_blocks; i += WORKGROUP) {
    uint block = block_list[i];
    PatchRecord patch_record = patchRecord(foundation_blocks[block].near.z);
    vec3 sums = vec3(0);
    float depth = 0.0, deep = 0.0;
    bool is_near = (block_flags[block] & kIsNear) != 0;
    for (uint k = 0; k < kNodesPerBlock; ++k) {
      uint node = block * kNodesPerBlock + k;
      float force = pairAt(forceAddress(instance, node)).x, overlap = pairAt(pairAddress(instance, node)).x;
      sums += force * vec3(1, nodePosition(patch_record, fourOf(FoundationNodes, node)));
      if (!AREA) depth += max(overlap, 0.0);
      if (AREA && OUTPUT_DEPTH && is_near) depth += meanOverlap(instance, node);
      deep += overlap >= fullOverlap() ? 1.0 : 0.0;
    }
    uint address = sumsAddress(instance, block);
    writePair(address, sums.xy);
    writePair(address + 1u, vec2(sums.z, deep));
    writePair(address + 2u, vec2(depth, 0));
  }
  checkLoop(i < num_listed_blocks);
  workgroupBarrierWithBuffers();
}

// Writes force (N) and mean depth (m) of the taxels.
void writeTaxels(uint instance) {
  uint taxel = gl_LocalInvocationIndex;
  for (; taxel < NUM_TAXELS; taxel += WORKGROUP) {
    float force = 0.0, depth = 0.0;
    for (uint k = 0; k < BLOCKS_PER_TAXEL; ++k) {
      uint block = taxel * BLOCKS_PER_TAXEL + k;
      if ((block_flags[block] & kIsActive) == 0) continue;
      force += pairAt(sumsAddress(instance, block)).x;
      if (OUTPUT_DEPTH) depth += pairAt(sumsAddress(instance, block) + 2u).x;
    }
    contact_normal[instance * NUM_TAXELS + taxel] = force * spread_scale[taxel];
    if (OUTPUT_DEPTH) contact_depth[instance * NUM_TAXELS + taxel] = depth / float(kNodesPerTaxel);
  }
  checkLoop(taxel < NUM_TAXELS);
}

// Whether a load search has passed through the body, by the tiles of a block.
bool isBehind(uint instance, uint block) {
  if ((block_flags[block] & kIsNear) == 0) return false;
  uvec4 tiles = foundation_blocks[block].tiles;
  bool behind = false;
  for (uint k = 0; k < 4; ++k) behind = behind || windows[instance * NUM_HEIGHT_TILES + tiles[k]].force.w > 0.0;
  return behind;
}

// For Newton's method of a load search, load.comp: how fast a force along z of S (N) grows with the depth, N/m. The force on a flat face grows as the depth does, that
// on a smooth surface up to as its square; the mean of both exponents lets each step reduce the error to a third.
float slopeOf(float force_z) {
  const float kExponent = 1.5;
  return kExponent * -force_z / max(uintBitsToFloat(deepest_overlap), 1e-9);
}

// Writes tile_results of a patch: force and torque about the origin of S, in S.
void writePatch(uint instance, uint number) {
  PatchRecord patch_record = patchRecord(number);
  uint block = patch_record.grid.z / kNodesPerBlock, end = block + patch_record.grid.x * patch_record.grid.y / kNodesPerBlock;
  vec4 sums = vec4(0);
  bool behind = false;
  for (; block < end; ++block) {
    behind = behind || LOADS && isBehind(instance, block);
    if ((block_flags[block] & kIsActive) == 0) continue;
    sums += vec4(pairAt(sumsAddress(instance, block)), pairAt(sumsAddress(instance, block) + 1u));
  }
  checkLoop(block < end);
  vec4 row0 = patch_record.row0, row1 = patch_record.row1, row2 = patch_record.row2;  // whose first three are the axes of P in S
  vec3 force = -sums.x * row2.xyz, origin = -(row0.xyz * row0.w + row1.xyz * row1.w + row2.xyz * row2.w);
  // The skin is pressed along -z of P: torque (x, y, 0) x (0, 0, -f).
  vec3 torque = -sums.z * row0.xyz + sums.y * row1.xyz + cross(origin, force);
  uint result = instance * NUM_TILES + number;
  tile_results[result].force = vec4(force, sums.w / float(NODES_PER_SAMPLE * NODES_PER_SAMPLE));
  tile_results[result].torque = vec4(torque, LOADS && AREA ? slopeOf(force.z) : sums.x);
  tile_results[result].window = uvec4(behind ? 1u : 0u, 0, 0, 0);
}

// Writes tile_results of an offset that a load search need not know the force of, because a node is at the skin's full thickness.
void writeTooDeep(uint instance) {
  uint p = gl_LocalInvocationIndex;
  for (; p < NUM_TILES; p += WORKGROUP) tile_results[instance * NUM_TILES + p] = TileResult(vec4(0, 0, 0, p == 0 ? 1 : 0), vec4(0), uvec4(0));
  checkLoop(p < NUM_TILES);
}

void writeResults(uint instance, uint num_instances) {
  uint p = gl_LocalInvocationIndex;
  for (; p < NUM_TILES; p += WORKGROUP) writePatch(instance, p);
  checkLoop(p < NUM_TILES);
  if (gl_LocalInvocationIndex == 0) features[kFeatureOffArrayLoad * num_instances + instance] = 0.0;
}
