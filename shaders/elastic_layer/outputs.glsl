// Outputs of an elastic layer: forces and depths of the taxels, and the wrench, load and solver statistics of an instance.
//
// `node_force`: force of a node under the pressure 1 of the solution, N. `shift`: of the solution, thicknesses.

// 1 at nodes that belong to a taxel, 0 in the margin.
vec4 onTaxels(uvec2 at) {
  bool row = at.x >= MARGIN_ROWS && at.x < NODE_ROWS - MARGIN_ROWS;
  vec4 col = float(at.y) + vec4(0, 1, 2, 3);
  vec2 range = row ? vec2(MARGIN_COLS, NODE_COLS - MARGIN_COLS) : vec2(0);
  return vec4(greaterThanEqual(col, vec4(range.x))) * vec4(lessThan(col, vec4(range.y)));
}

// Writes force (N), shear (N) and mean depth (m) of the taxels that were reached; returns their rectangle: first row, end row, first col,
// end col. `pressed`: the nodes that have a shear traction.
uvec4 writeTaxels(uint instance, Surface surface, Window window, uvec4 pressed, float shift, float node_force) {
  uvec2 margin = uvec2(MARGIN_ROWS, MARGIN_COLS);
  uvec4 reached = surface.reached;
  uvec2 first_node = max(reached.xz, margin), end_node = min(reached.yw, uvec2(NODE_ROWS - MARGIN_ROWS, NODE_COLS - MARGIN_COLS));
  bool any_node = (window.num_strips > 0 || RELAXATION > 0) && all(lessThan(first_node, end_node));
  uvec2 first = (first_node - margin) / SAMPLES, count = (end_node - margin + SAMPLES - 1u) / SAMPLES - first;
  if (!any_node) first = count = uvec2(0);
  uvec2 first_written = OUTPUT_DEPTH ? uvec2(0) : first, num_written = OUTPUT_DEPTH ? uvec2(NUM_TAXELS / NUM_COLS, NUM_COLS) : count;
  for (uint v = gl_LocalInvocationIndex; v < num_written.x * num_written.y; v += WORKGROUP) {
    uvec2 at = first_written + cellNumbered(v, num_written.y);
    bool inside = all(lessThan(at - first, count));
    uint k = at.x * NUM_COLS + at.y;
    float pressure = 0.0, depth = 0.0;
    vec2 traction = vec2(0);
    for (uint a = 0; inside && a < SAMPLES; ++a) {
      for (uint b = 0; b < SAMPLES; ++b) {
        uvec2 node = margin + at * SAMPLES + uvec2(a, b);
        // A taxel may be reached in part; the surface over its other nodes is unknown.
        if (any(lessThan(node, first_node)) || any(greaterThanEqual(node, end_node))) continue;
        pressure += readStrip(window.layer_start, kLayerPressure, node)[node.y % kStrip];
        if (OUTPUT_DEPTH) depth += max(overlapAt(surface, node) + shift, 0.0) * (AREA ? cellAt(surface, node).share : 1.0);
        if (OUTPUT_SHEAR && isInside(node, pressed)) traction += tractionAt(instance, node);
      }
    }
    uint taxel = instance * NUM_TAXELS + k;
    contact_normal[taxel] = pressure * node_force * spread_scale[k];
    if (OUTPUT_DEPTH) contact_depth[taxel] = depth * THICKNESS / float(SAMPLES * SAMPLES);
    if (OUTPUT_SHEAR) {
      vec2 shear = traction * nodeArea() * spread_scale[k];
      contact_shear[2 * taxel] = shear.x;
      contact_shear[2 * taxel + 1] = shear.y;
    }
  }
  return uvec4(first.x, first.x + count.x, first.y, first.y + count.y);
}

// Adds a strip to the sums of pressure, pressure times x and y of P, and pressure on taxels, and its nodes of taxels at full depth to
// `deep`.
void addPressures(Surface surface, Window window, uvec2 at, float shift, inout vec4 sums, inout float deep) {
  vec4 p = readStrip(window, kLayerPressure, at), overlap = readStrip(window, kLayerTarget, at), on_taxels = onTaxels(at);
  if (RELAXATION > 0) overlap = overlapsOver(surface, at);
  float sum = sumOf(p), x = nodePosition(at).x;
  sums += vec4(sum, sum * x, dot(p, columnPositions(at)), dot(p, on_taxels));
  if (AREA) {
    StripCells cells = cellsOver(surface, at);
    sums.yz += vec2(dot(p, cells.x), dot(p, cells.y));
    on_taxels *= whereAbove(cells.share, kLeastShareOfFull);
  }
  deep += dot(on_taxels, whereAbove(overlap + shift, AREA ? kFullDepth : 0.9999999));
}

// Adds to num_deep the nodes of taxels at full depth. Returns the sums of addPressures() over the window.
vec4 sumPressures(Surface surface, Window window, float shift) {
  float deep = 0.0;
  REDUCE_STRIPS(window, vec4(0), addPressures(surface, window, at, shift, sums, deep))
  if (deep > 0.0) atomicAdd(num_deep, uint(deep));
  return sumOfPartials(window.num_parts);
}

// Writes tile_results and the features of the solution. `taxels`: as writeTaxels() returns it.
void writeResults(uint instance, uint num_instances, Surface surface, Window window, Solution found, uint iterations, uvec4 taxels,
                  Shear shear, float node_force) {
  vec4 sums = sumPressures(surface, window, found.shift) * node_force;
  if (gl_LocalInvocationIndex != 0) return;
  mat3 R_SP = transpose(mat3(sensor.X_SC_row0.xyz, sensor.X_SC_row1.xyz, sensor.X_SC_row2.xyz));
  vec3 force = R_SP * vec3(shear.force, -sums.x);
  // The skin is pressed along -z of P: torque (x, y, 0) x (0, 0, -f).
  vec3 torque =
      R_SP * (vec3(-sums.z, sums.y, 0) + shear.torque) + cross(vec3(sensor.X_SC_row0.w, sensor.X_SC_row1.w, sensor.X_SC_row2.w), force);
  tile_results[instance].force = vec4(force, float(num_deep));
  tile_results[instance].torque = vec4(torque, sums.w);
  tile_results[instance].window = taxels;
  features[kFeatureOffArrayLoad * num_instances + instance] = max(sums.x - sums.w, 0.0);
  features[kFeatureContactResidual * num_instances + instance] = found.error;
  features[kFeatureContactIterations * num_instances + instance] = float(iterations);
}
