// Outputs of a linked foundation: forces and depths of the taxels, and the wrench on every patch.
//
// The sums of a taxel: force (N) and its moments about x and y of P, which are force times place (N m); nodes at full depth.

// Place of a node in P, m. `record`: of the node.
vec2 nodePosition(PatchRecord patch_record, uvec4 record) {
  vec2 at = vec2(record.y >> 16, record.y & 0xFFFFu);
  return (at - 0.5 * vec2(patch_record.grid.xy - 1u)) * patch_record.spacing.xy;
}

// Sums the nodes of an active taxel; returns the sum of their overlaps, m.
float sumTaxel(uint instance, uint taxel) {
  PatchRecord patch_record = patches[foundation_taxels[taxel].near.z];
  precise vec3 sums = vec3(0);
  float depth = 0.0, deep = 0.0;
  uint k = 0;
  for (; k < kNodesPerTaxel; ++k) {
    uint node = taxel * kNodesPerTaxel + k;
    float force = pairAt(forceAddress(instance, node)).x, overlap = pairAt(pairAddress(instance, node)).x;
    vec2 position = nodePosition(patch_record, fourOf(FoundationNodes, node));
    sums += force * vec3(1, position);
    depth += max(overlap, 0.0);
    deep += overlap >= THICKNESS ? 1.0 : 0.0;
  }
  checkLoop(k < kNodesPerTaxel);
  writePair(sumsAddress(instance, taxel), sums.xy);
  writePair(sumsAddress(instance, taxel) + 1u, vec2(sums.z, deep));
  return depth;
}

// Writes force (N) and mean depth (m) of the taxels.
void writeTaxels(uint instance) {
  uint t = gl_LocalInvocationIndex;
  for (; t < NUM_TAXELS; t += WORKGROUP) {
    if ((taxel_flags[t] & kIsActive) != 0) continue;
    contact_normal[instance * NUM_TAXELS + t] = 0.0;
    if (OUTPUT_DEPTH) contact_depth[instance * NUM_TAXELS + t] = 0.0;
  }
  for (uint i = gl_LocalInvocationIndex; i < num_listed_taxels; i += WORKGROUP) {
    uint taxel = taxel_list[i];
    float depth = sumTaxel(instance, taxel);
    contact_normal[instance * NUM_TAXELS + taxel] = pairAt(sumsAddress(instance, taxel)).x * spread_scale[taxel];
    if (OUTPUT_DEPTH) contact_depth[instance * NUM_TAXELS + taxel] = depth / float(kNodesPerTaxel);
  }
  checkLoop(t < NUM_TAXELS);
  workgroupBarrierWithBuffers();
}

// Whether a load search has passed through the body, by the tiles of a taxel.
bool isBehind(uint instance, uint taxel) {
  if ((taxel_flags[taxel] & kIsNear) == 0) return false;
  uvec4 tiles = foundation_taxels[taxel].tiles;
  bool behind = false;
  for (uint k = 0; k < 4; ++k) behind = behind || windows[instance * NUM_HEIGHT_TILES + tiles[k]].force.w > 0.0;
  return behind;
}

// Writes tile_results of a patch: force and torque about the origin of S, in S.
void writePatch(uint instance, uint number) {
  PatchRecord patch_record = patches[number];
  uint taxel = patch_record.grid.z / kNodesPerTaxel, end = taxel + patch_record.grid.x * patch_record.grid.y / kNodesPerTaxel;
  vec4 sums = vec4(0);
  bool behind = false;
  for (; taxel < end; ++taxel) {
    behind = behind || LOADS && isBehind(instance, taxel);
    if ((taxel_flags[taxel] & kIsActive) == 0) continue;
    sums += vec4(pairAt(sumsAddress(instance, taxel)), pairAt(sumsAddress(instance, taxel) + 1u));
  }
  checkLoop(taxel < end);
  vec4 row0 = patch_record.row0, row1 = patch_record.row1, row2 = patch_record.row2;  // whose first three are the axes of P in S
  vec3 force = -sums.x * row2.xyz, origin = -(row0.xyz * row0.w + row1.xyz * row1.w + row2.xyz * row2.w);
  // The skin is pressed along -z of P: torque (x, y, 0) x (0, 0, -f).
  vec3 torque = -sums.z * row0.xyz + sums.y * row1.xyz + cross(origin, force);
  uint result = instance * NUM_TILES + number;
  tile_results[result].force = vec4(force, sums.w / float(NODES_PER_SAMPLE * NODES_PER_SAMPLE));
  tile_results[result].torque = vec4(torque, sums.x);
  tile_results[result].window = uvec4(behind ? 1u : 0u, 0, 0, 0);
}

void writeResults(uint instance, uint num_instances) {
  uint p = gl_LocalInvocationIndex;
  for (; p < NUM_TILES; p += WORKGROUP) writePatch(instance, p);
  checkLoop(p < NUM_TILES);
  if (gl_LocalInvocationIndex == 0) features[kFeatureOffArrayLoad * num_instances + instance] = 0.0;
}
