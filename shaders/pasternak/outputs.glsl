// Outputs of a two-parameter foundation: forces and depths of the taxels, and the wrench of an instance.

// Writes force (N) and mean depth (m) of the taxels in the window; returns their rectangle: first row, end row, first col, end col.
uvec4 writeTaxels(uint instance, Window window) {
  uvec2 first = window.first / kPerTaxel, count = (window.first + window.count + kPerTaxel - 1u) / kPerTaxel - first;
  if (window.count.x == 0) first = count = uvec2(0);
  uint k = gl_LocalInvocationIndex;
  for (; k < NUM_TAXELS; k += WORKGROUP) {
    uvec2 at = uvec2(k / NUM_COLS, k % NUM_COLS);
    bool inside = all(lessThan(at - first, count));
    if (!inside && !OUTPUT_DEPTH) continue;
    float force = 0.0, depth = 0.0;
    for (uint a = 0; inside && a < kPerTaxel; ++a) {
      for (uint b = 0; b < kPerTaxel; ++b) {
        uvec2 node = at * kPerTaxel + uvec2(a, b);
        if (any(greaterThanEqual(node - window.first, window.count))) continue;
        force += uintBitsToFloat(foundation[nodeAddress(instance, kForce, node)]);
        if (OUTPUT_DEPTH) depth += max(valueAt(instance, kOverlap, node), 0.0);
      }
    }
    uint taxel = instance * NUM_TAXELS + k;
    contact_normal[taxel] = force * spread_scale[k];
    if (OUTPUT_DEPTH) contact_depth[taxel] = depth / float(kPerTaxel * kPerTaxel);
  }
  checkLoop(k < NUM_TAXELS);
  return uvec4(first.x, first.x + count.x, first.y, first.y + count.y);
}

// Writes tile_results. `sums`: of nodeForces(). `taxels`: as writeTaxels() returns it.
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
