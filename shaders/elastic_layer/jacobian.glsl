// The tactile Jacobian of an elastic layer: how its forces change as the sensor moves and the objects stay. Reference:
// src/reference/layer_rates.cpp.
// Out: taxel_jacobian (num_instances x 6 x num_taxels), N/m and N/rad; wrench_jacobian (num_instances x 6 x 6).
//
// Over the nodes in contact A p = d, so that A dp = dd: conjugate gradients with a known active set, once per coordinate of the twist.
// Nodes that enter or leave contact carry no force at that moment. The object's surface lies at z = -d(x, y) of P; its point p = (x, y, -d)
// moves with u = v + w x p, so that d changes by -u_z - u_x d_x - u_y d_y. For a skin that relaxes these are the instantaneous changes.
//
// With area sampling A changes with the covered parts of the cells, so that A dp = dd - dA p (elastic_layer/cell_rates.glsl), and d is the
// depth at the centroid of the covered part, which moves.
//
// kLayerTarget holds the changes of pressure dp, kLayerResidual the residual dd - A dp; the solver no longer needs either.

const uint kMaxJacobianIterations = 48;  // iterations of conjugate gradients; a few thousand nodes in contact take half as many
const float kJacobianTolerance = 1e-8;   // squared residual, as a share of the first one
const float kWallSlope = 2.0;            // slope of depth beyond which there is a wall

// Height at a node, kNoHeight outside the nodes that were reached.
float knownHeight(Surface surface, uvec2 node) {
  return isReached(surface, node) ? heightAt(surface, node) : kNoHeight;  // -1 wraps to a large number
}

// Distance along an axis between the centroids of the covered parts of a node's cell and the next one, m.
float distanceBetween(Surface surface, uvec2 node, uvec2 next, uint axis) {
  const float kClosest = 0.25;  // spacings
  float spacing = nodeSpacing()[axis];
  if (!AREA || !isReached(surface, node) || !isReached(surface, next)) return spacing;
  return max(spacing + cellAt(surface, next).center[axis] - cellAt(surface, node).center[axis], kClosest * spacing);
}

// Slope of depth along rows (axis 0) or columns (axis 1): the mean of the one-sided differences, without walls.
float slopeOfDepth(Surface surface, uvec2 node, uint axis) {
  float height = knownHeight(surface, node);
  uvec2 next = axis == 0 ? uvec2(1, 0) : uvec2(0, 1);
  float from = (knownHeight(surface, node - next) - height) / distanceBetween(surface, node - next, node, axis);
  float to = (height - knownHeight(surface, node + next)) / distanceBetween(surface, node, node + next, axis);
  vec2 known = vec2(abs(from) < kWallSlope ? 1.0 : 0.0, abs(to) < kWallSlope ? 1.0 : 0.0);
  if (known.x + known.y == 0.0) return 0.0;
  return ((known.x > 0.0 ? from : 0.0) + (known.y > 0.0 ? to : 0.0)) / (known.x + known.y);
}

// Rate of the overlap at a node as the object moves by v and w, in P, thicknesses per m or rad; 0 beyond the skin's thickness.
float overlapRate(Surface surface, Window window, uvec2 node, float shift, vec3 v, vec3 w) {
  float d = overlapAt(surface, node) + shift;
  if (d >= 1.0) return 0.0;
  vec2 center = vec2(0), center_rate = vec2(0);
  if (AREA) {
    NodeCell cell = cellAt(surface, node);
    center = cell.center;
    center_rate = cell.edge * storedRate(window, node).center;
  }
  vec3 u = v + cross(w, vec3(nodePosition(node) + center, -d * THICKNESS));
  u.xy -= center_rate;
  return -(u.z + u.x * slopeOfDepth(surface, node, 0) + u.y * slopeOfDepth(surface, node, 1)) / THICKNESS;
}

vec4 pressedOver(Window window, uvec2 at) { return whereAbove(readStrip(window, kLayerPressure, at), 0.0); }

// Stores the rates of the cells of a strip for storedRate(). Returns the sum over the nodes of pressure times the velocity of the centroid.
vec2 storeCellRates(Surface surface, Window window, uvec2 at, float shift, vec3 v, vec3 w) {
  vec4 covered = vec4(0), x = vec4(0), y = vec4(0);
  vec2 moved = vec2(0);
  for (uint c = 0; c < kStrip; ++c) {
    uvec2 node = uvec2(at.x, at.y + c);
    if (!isReached(surface, node)) continue;
    CellRate rate = cellRate(surface, node, (overlapAt(surface, node) + shift) * THICKNESS, v, w);
    moved += valueAt(window.layer_start, kLayerPressure, node) * cellAt(surface, node).edge * rate.center;
    covered[c] = rate.covered;
    x[c] = rate.center.x;
    y[c] = rate.center.y;
  }
  writeStrip(window, kCoveredRate, at, covered);
  writeStrip(window, kCentroidRateX, at, x);
  writeStrip(window, kCentroidRateY, at, y);
  return moved;
}

// Stores the rates of all cells of the window; returns the sum of pressure times the velocity of the centroid.
vec2 storeCellRates(Surface surface, Window window, float shift, vec3 v, vec3 w) {
  REDUCE_STRIPS(window, vec4(0), sums.xy += storeCellRates(surface, window, at, shift, v, w))
  return sumOfPartials(window.num_parts).xy;
}

// The pressure at a node that a change of its compliance acts on: with the part of the dent that has the compliance of the part that is
// covered now. Between a dent of a larger part and one of a smaller part there is a kink, at which half of the dent is taken.
float pressureAt(Window window, uvec2 node) {
  float pressure = valueAt(window.layer_start, kLayerPressure, node);
  if (RELAXATION == 0) return pressure;
  const float kNear = 0.01;  // share of the compliance
  float now = valueAt(window.layer_start, kLayerCompliance, node), then = valueAt(window.layer_start, kLayerDentCompliance, node);
  float part = now == 0.0 || now * then < 0.0 ? 0.0 : clamp(0.5 + (abs(then) / abs(now) - 1.0) / (2.0 * kNear), 0.0, 1.0);
  return mix(pressure, valueAt(window.layer_start, kLayerStrain, node), part);
}

// Rate of d - A p at a node in contact, with p held fixed.
float residualRate(Surface surface, Window window, uvec2 node, float shift, vec3 v, vec3 w) {
  float rate = overlapRate(surface, window, node, shift, v, w);
  return AREA ? rate - complianceRate(surface, window, node) * pressureAt(window, node) : rate;
}

// Sets the residual of a strip to the rate of the overlap at the nodes in contact. Returns the squared residual.
float beginRates(Surface surface, Window window, uvec2 at, float shift, vec3 v, vec3 w) {
  vec4 pressed = pressedOver(window, at), rate = vec4(0);
  for (uint c = 0; c < kStrip; ++c) {
    if (pressed[c] > 0.0) rate[c] = residualRate(surface, window, uvec2(at.x, at.y + c), shift, v, w);
  }
  writeStrip(window, kLayerResidual, at, rate);
  return dot(rate, weighted(window, at, rate));
}

// Starts at dp = 0: the residual is the rate of the overlap over the nodes in contact. Returns the squared residual.
float beginRates(Surface surface, Window window, float shift, vec3 v, vec3 w) {
  REDUCE_STRIPS(window, vec4(0), sums.x += beginRates(surface, window, at, shift, v, w))
  float squares = sumOfPartials(window.num_parts).x;
  FOR_EACH_STRIP(window, {
    writeStrip(window, kLayerTarget, at, vec4(0));
    writeStrip(window, kLayerDirection, at, weighted(window, at, readStrip(window, kLayerResidual, at)));
  })
  workgroupBarrierWithBuffers();
  return squares;
}

// Applies A to the direction of a strip at the nodes in contact; returns the curvature along it.
float applyToRates(Window window, uvec2 at) {
  vec4 q = displacementAt(window, at, kLayerDirection) * pressedOver(window, at);
  writeStrip(window, kLayerProduct, at, q);
  return dot(q, readStrip(window, kLayerDirection, at));
}

// Applies A to the direction over the nodes in contact; returns the curvature along it.
float applyToRates(Window window) {
  REDUCE_STRIPS(window, vec4(0), sums.x += applyToRates(window, at))
  return sumOfPartials(window.num_parts).x;
}

// Steps a strip along the direction. Returns its squared residual.
float stepRates(Window window, uvec2 at, float step_length) {
  vec4 residual = readStrip(window, kLayerResidual, at) - readStrip(window, kLayerProduct, at) * step_length;
  writeStrip(window, kLayerTarget, at, readStrip(window, kLayerTarget, at) + readStrip(window, kLayerDirection, at) * step_length);
  writeStrip(window, kLayerResidual, at, residual);
  return dot(residual, weighted(window, at, residual));
}

// One iteration; takes and returns the squared residual.
float iterateRates(Window window, float squared_residual) {
  float curvature = applyToRates(window);
  float step_length = curvature > 0.0 ? squared_residual / curvature : 0.0;
  REDUCE_STRIPS(window, vec4(0), sums.x += stepRates(window, at, step_length))
  float squares = sumOfPartials(window.num_parts).x;
  FOR_EACH_STRIP(window, {
    vec4 residual = weighted(window, at, readStrip(window, kLayerResidual, at));
    writeStrip(window, kLayerDirection, at, residual + readStrip(window, kLayerDirection, at) * (squares / squared_residual));
  })
  workgroupBarrierWithBuffers();
  return squares;
}

// Adds a strip to the sums of changes of pressure and of these times x and y of P.
void addChanges(Surface surface, Window window, uvec2 at, inout vec4 sums) {
  vec4 change = readStrip(window, kLayerTarget, at);
  float x = nodePosition(at).x;
  sums += vec4(sumOf(change), sumOf(change) * x, dot(change, columnPositions(at)), 0);
  if (AREA) {
    StripCells cells = cellsOver(surface, at);
    sums.yz += vec2(dot(change, cells.x), dot(change, cells.y));
  }
}

// Writes the wrench's derivative by coordinate `c` of the sensor's twist. `moved`: the sum of pressure times the velocity of the centroid,
// m per unit. `origin`: of P in S, m.
void writeWrenchJacobian(uint instance, Surface surface, Window window, uint c, vec2 moved, mat3 R_SP, vec3 origin, float node_force) {
  REDUCE_STRIPS(window, vec4(0), addChanges(surface, window, at, sums))
  vec4 sums = (sumOfPartials(window.num_parts) + vec4(0, moved, 0)) * node_force;
  if (gl_LocalInvocationIndex != 0) return;
  vec3 force = R_SP * vec3(0, 0, -sums.x), torque = R_SP * vec3(-sums.z, sums.y, 0) + cross(origin, force);
  for (uint axis = 0; axis < 3; ++axis) {
    wrench_jacobian[instance * kNumWrenchJacobian + 6 * axis + c] = force[axis];
    wrench_jacobian[instance * kNumWrenchJacobian + 6 * (axis + 3) + c] = torque[axis];
  }
}

// Writes the taxels' derivatives by coordinate `c`.
void writeTaxelJacobian(uint instance, Window window, uint c, float node_force) {
  uvec2 margin = uvec2(MARGIN_ROWS, MARGIN_COLS);
  for (uint k = gl_LocalInvocationIndex; k < NUM_TAXELS; k += WORKGROUP) {
    uvec2 first = margin + uvec2(k / NUM_COLS, k % NUM_COLS) * SAMPLES;
    float change = 0.0;
    for (uint a = 0; window.num_strips > 0 && a < SAMPLES; ++a) {
      for (uint b = 0; b < SAMPLES; ++b) {
        uvec2 node = first + uvec2(a, b);
        // Outside the contact the array still holds older values.
        if (valueAt(window.layer_start, kLayerPressure, node) > 0.0) change += valueAt(window.layer_start, kLayerTarget, node);
      }
    }
    taxel_jacobian[(instance * 6 + c) * NUM_TAXELS + k] = change * node_force * spread_scale[k];
  }
}

void writeJacobian(uint instance, Surface surface, Window window, float shift, float node_force) {
  mat3 R_PS = mat3(sensor.X_SC_row0.xyz, sensor.X_SC_row1.xyz, sensor.X_SC_row2.xyz);
  vec3 origin = vec3(sensor.X_SC_row0.w, sensor.X_SC_row1.w, sensor.X_SC_row2.w);
  workgroupBarrierWithBuffers();
  clearSources();  // the nodes in contact become the sources
  FOR_EACH_STRIP(window, if (sumOf(pressedOver(window, at)) > 0.0) addSource(at))
  workgroupBarrierWithBuffers();
  for (uint c = 0; c < 6; ++c) {
    // The objects' motion relative to the sensor under unit twist c of the sensor, about the origin of P.
    vec3 v = vec3(0), w = vec3(0);
    if (c < 3) {
      v[c] = -1.0;
    } else {
      w[c - 3] = -1.0;
    }
    v = R_PS * (v + cross(w, origin));
    w = R_PS * w;
    vec2 moved = vec2(0);
    if (AREA) moved = storeCellRates(surface, window, shift, v, w);
    float first = beginRates(surface, window, shift, v, w);
    float squared_residual = first;
    for (uint n = 0; n < kMaxJacobianIterations && squared_residual > kJacobianTolerance * first; ++n) {
      squared_residual = iterateRates(window, squared_residual);
    }
    workgroupBarrierWithBuffers();
    writeWrenchJacobian(instance, surface, window, c, moved, transpose(R_PS), origin, node_force);
    writeTaxelJacobian(instance, window, c, node_force);
    workgroupBarrierWithBuffers();
  }
}
