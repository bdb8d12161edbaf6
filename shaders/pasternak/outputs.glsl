// Outputs of a two-parameter foundation: forces and depths of the taxels, and the wrench of an instance.

// Taxels that active blocks cover: first row and col, numbers of rows and cols.
Window touchedTaxels() {
  uvec2 first = uvec2(block_bounds[0], block_bounds[2]) * kBlockSize, end = min(uvec2(block_bounds[1], block_bounds[3]) * kBlockSize, kNodes);
  if (end.x == 0) return Window(uvec2(0), uvec2(0));
  first /= kPerTaxel;
  return Window(first, (end + kPerTaxel - 1u) / kPerTaxel - first);
}

// Sum of the rows of a taxel in a pair of rows.
float sumOfRows(vec2 rows, uint first_row, uint taxel_row) {
  const bool kWhole = kPerTaxel % 2u == 0u;  // pairs of rows are within a taxel
  if (kWhole) return rows.x + rows.y;
  return (isWithin(first_row, taxel_row, kPerTaxel) ? rows.x : 0.0) + (isWithin(first_row + 1u, taxel_row, kPerTaxel) ? rows.y : 0.0);
}

// Rows 2n and 2n + 1 of a column of a block, n = `pair`.
vec2 pairAt(uint address, uint pair) {
  vec4 rows = readRows(address);
  return pair == 0u ? rows.xy : rows.zw;
}

// The sum of the mean overlaps of the cells of a taxel, m; `first`: its first node.
float cellSums(Surface surface, uvec2 first) {
  float depth = 0.0;
  for (uint k = 0; k < kPerTaxel * kPerTaxel; ++k) {
    depth += meanOverlap(surface, first + cellNumbered(k, kPerTaxel));
  }
  return depth;
}

// Force on a taxel, N, and the sum of its overlaps, m; `at`: its row and col.
vec2 taxelSums(Surface surface, uvec2 at) {
  const uint kPairsOfRows = (kPerTaxel + 1u) / 2u;
  uvec2 node = at * kPerTaxel, end = node + kPerTaxel;
  float force = 0.0, depth = AREA && OUTPUT_DEPTH ? cellSums(surface, node) : 0.0;
  for (uint col = node.y / kBlockCols; col * kBlockCols < end.y; ++col) {
    uint place = at.y - col * kBlockCols / kPerTaxel;  // of the taxel among those over the columns of the block
    for (uint a = 0; a < kPairsOfRows; ++a) {
      uint row = (node.x / 2u + a) * 2u, block = row / kBlockRows * kBlocks.y + col, pair = row % kBlockRows / 2u;
      if (row >= kNodes.x || active_blocks[block] == 0) continue;
      force += sumOfRows(pairAt(columnAddress(otherArrayOf(active_blocks[block]), block, place), pair), row, node.x);
      if (!OUTPUT_DEPTH || AREA) continue;
      for (uint b = max(node.y, col * kBlockCols); b < min(end.y, (col + 1u) * kBlockCols); ++b) {
        vec2 overlap = pairAt(columnAddress(kOverlap, block, b - col * kBlockCols), pair);
        depth += sumOfRows(max(overlap, 0.0), row, node.x);
      }
    }
  }
  return vec2(force, depth);
}

// Writes force (N) and mean depth (m) of the taxels that active blocks cover; returns their rectangle: first row, end row, first col, end col.
uvec4 writeTaxels(uint instance, Surface surface) {
  Window touched = touchedTaxels();
  uint k = gl_LocalInvocationIndex;
  for (; k < NUM_TAXELS; k += WORKGROUP) {
    uvec2 at = uvec2(k / NUM_COLS, k % NUM_COLS);
    bool inside = all(lessThan(at - touched.first, touched.count));
    if (!inside && !OUTPUT_DEPTH) continue;
    vec2 sums = vec2(0);
    if (inside) sums = taxelSums(surface, at);
    uint taxel = instance * NUM_TAXELS + k;
    contact_normal[taxel] = sums.x * spread_scale[k];
    if (OUTPUT_DEPTH) contact_depth[taxel] = sums.y / float(kPerTaxel * kPerTaxel);
  }
  checkLoop(k < NUM_TAXELS);
  return uvec4(touched.first.x, touched.first.x + touched.count.x, touched.first.y, touched.first.y + touched.count.y);
}

// Writes tile_results. `sums`: of solveContact(). `taxels`: as writeTaxels() returns it.
void writeResults(uint instance, uint num_instances, vec4 sums, uvec4 taxels) {
  if (gl_LocalInvocationIndex != 0) return;
  mat3 R_SP = transpose(mat3(sensor.X_SC_row0.xyz, sensor.X_SC_row1.xyz, sensor.X_SC_row2.xyz));
  vec3 force = R_SP * vec3(0, 0, -sums.x);
  // The skin is pressed along -z of P: torque (x, y, 0) x (0, 0, -f).
  vec3 torque = R_SP * vec3(-sums.z, sums.y, 0) + cross(vec3(sensor.X_SC_row0.w, sensor.X_SC_row1.w, sensor.X_SC_row2.w), force);
  tile_results[instance].force = vec4(force, sums.w / float(NODES_PER_SAMPLE * NODES_PER_SAMPLE));
  tile_results[instance].torque = vec4(torque, sums.x);
  tile_results[instance].window = taxels;
  features[kFeatureOffArrayLoad * num_instances + instance] = 0.0;
}
