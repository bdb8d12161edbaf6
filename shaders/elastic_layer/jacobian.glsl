// The tactile Jacobian of an elastic layer: how its forces change as the sensor moves and the objects stay. Twin: src/reference/layer_rates.cpp.
// Out: taxel_jacobian (num_instances x 6 x num_taxels), N/m and N/rad; wrench_jacobian (num_instances x 6 x 6).
//
// Over the nodes in contact A p = d, so that A dp = dd: conjugate gradients with a known active set, once per coordinate of the twist. Nodes that enter or
// leave contact carry no force at that moment. The object's surface lies at z = -d(x, y) of P; its point p = (x, y, -d) moves with u = v + w x p, so that d
// changes by -u_z - u_x d_x - u_y d_y. For a skin that relaxes these are the instantaneous changes.
//
// kLayerTarget holds the changes of pressure dp, kLayerResidual the residual dd - A dp; the solver no longer needs either.

const uint kMaxJacobianIterations = 48;  // of conjugate gradients; a few thousand nodes in contact take half as many
const float kJacobianTolerance = 1e-8;   // squared residual, as a share of the first one
const float kWallSlope = 2.0;            // slope of depth beyond which there is a wall

// Height at a node, kMiss outside the nodes that were reached.
float knownHeight(Surface surface, uvec2 node) {
  uvec4 reached = surface.reached;
  bool inside = node.x >= reached.x && node.x < reached.y && node.y >= reached.z && node.y < reached.w;  // -1 wraps to a large number
  return inside ? heightAt(surface, node) : kMiss;
}

// Slope of depth along rows (axis 0) or columns (axis 1): the mean of the one-sided differences, without walls.
float slopeOfDepth(Surface surface, uvec2 node, uint axis) {
  float spacing = nodeSpacing()[axis], height = knownHeight(surface, node);
  uvec2 next = axis == 0 ? uvec2(1, 0) : uvec2(0, 1);
  float from = (knownHeight(surface, node - next) - height) / spacing, to = (height - knownHeight(surface, node + next)) / spacing;
  vec2 known = vec2(abs(from) < kWallSlope ? 1.0 : 0.0, abs(to) < kWallSlope ? 1.0 : 0.0);
  if (known.x + known.y == 0.0) return 0.0;
  return ((known.x > 0.0 ? from : 0.0) + (known.y > 0.0 ? to : 0.0)) / (known.x + known.y);
}

// Rate of the overlap at a node as the object moves by v and w, in P, thicknesses per m or rad; 0 beyond the skin's thickness.
float overlapRate(Surface surface, uvec2 node, float shift, vec3 v, vec3 w) {
  float d = overlapAt(surface, node) + shift;
  if (d >= 1.0) return 0.0;
  vec3 u = v + cross(w, vec3(nodePosition(node), -d * THICKNESS));
  return -(u.z + u.x * slopeOfDepth(surface, node, 0) + u.y * slopeOfDepth(surface, node, 1)) / THICKNESS;
}

Strip pressedOver(Window window, uvec2 at) { return whereAbove(readStrip(window, kLayerPressure, at), 0.0); }

// Makes the nodes in contact the sources.
void addPressedSources(Window window) {
  clearSources();
  uint k = gl_LocalInvocationIndex;
  for (; k < window.num_strips; k += WORKGROUP) {
    if (sumOf(pressedOver(window, stripAt(window, k))) > 0.0) addSource(stripAt(window, k));
  }
  checkLoop(k < window.num_strips);
  workgroupBarrierWithBuffers();
}

// Starts at dp = 0: residual and direction are the rates of overlap over the nodes in contact. Returns the squared residual.
float beginRates(Surface surface, Window window, float shift, vec3 v, vec3 w) {
  for (uint part = gl_LocalInvocationIndex; part < window.num_parts; part += WORKGROUP) {
    float squares = 0.0;
    uint k = part;
    for (; k < window.num_strips; k += LANES) {
      uvec2 at = stripAt(window, k);
      Strip pressed = pressedOver(window, at), rate = strip(0.0);
      for (uint c = 0; c < kStrip; ++c) {
        bool touches = (c < 4 ? pressed.low[c] : pressed.high[c - 4]) > 0.0;
        float value = touches ? overlapRate(surface, uvec2(at.x, at.y * kStrip + c), shift, v, w) : 0.0;
        if (c < 4) rate.low[c] = value; else rate.high[c - 4] = value;
      }
      writeStrip(window, kLayerTarget, at, strip(0.0));
      writeStrip(window, kLayerResidual, at, rate);
      writeStrip(window, kLayerDirection, at, rate);
      squares += dotOf(rate, rate);
    }
    checkLoop(k < window.num_strips);
    partial[part] = vec4(squares, 0, 0, 0);
  }
  return sumOfPartials(window.num_parts).x;
}

// Applies A to the direction over the nodes in contact; returns the curvature along it.
float applyToRates(Window window) {
  for (uint part = gl_LocalInvocationIndex; part < window.num_parts; part += WORKGROUP) {
    float curvature = 0.0;
    uint k = part;
    for (; k < window.num_strips; k += LANES) {
      uvec2 at = stripAt(window, k);
      Strip q = productOf(displacementAt(window, at, kLayerDirection), pressedOver(window, at));
      writeStrip(window, kLayerProduct, at, q);
      curvature += dotOf(q, readStrip(window, kLayerDirection, at));
    }
    checkLoop(k < window.num_strips);
    partial[part] = vec4(curvature, 0, 0, 0);
  }
  return sumOfPartials(window.num_parts).x;
}

// One iteration; takes and returns the squared residual.
float stepRates(Window window, float squared_residual) {
  float curvature = applyToRates(window);
  float step_length = curvature > 0.0 ? squared_residual / curvature : 0.0;
  for (uint part = gl_LocalInvocationIndex; part < window.num_parts; part += WORKGROUP) {
    float squares = 0.0;
    uint k = part;
    for (; k < window.num_strips; k += LANES) {
      uvec2 at = stripAt(window, k);
      Strip residual = minus(readStrip(window, kLayerResidual, at), scaled(readStrip(window, kLayerProduct, at), step_length));
      writeStrip(window, kLayerTarget, at, sumOf(readStrip(window, kLayerTarget, at), scaled(readStrip(window, kLayerDirection, at), step_length)));
      writeStrip(window, kLayerResidual, at, residual);
      squares += dotOf(residual, residual);
    }
    checkLoop(k < window.num_strips);
    partial[part] = vec4(squares, 0, 0, 0);
  }
  float squares = sumOfPartials(window.num_parts).x;
  uint k = gl_LocalInvocationIndex;
  for (; k < window.num_strips; k += WORKGROUP) {
    uvec2 at = stripAt(window, k);
    Strip direction = sumOf(readStrip(window, kLayerResidual, at), scaled(readStrip(window, kLayerDirection, at), squares / squared_residual));
    writeStrip(window, kLayerDirection, at, direction);
  }
  checkLoop(k < window.num_strips);
  workgroupBarrierWithBuffers();
  return squares;
}

// Writes the wrench's derivative by coordinate `c` of the sensor's twist. `origin`: of P in S, m.
void writeWrenchJacobian(uint instance, Window window, uint c, mat3 R_SP, vec3 origin, float node_force) {
  for (uint part = gl_LocalInvocationIndex; part < window.num_parts; part += WORKGROUP) {
    vec3 sums = vec3(0);  // changes of pressure, these times x and y of P
    uint k = part;
    for (; k < window.num_strips; k += LANES) {
      uvec2 at = stripAt(window, k);
      Strip change = readStrip(window, kLayerTarget, at);
      float x = nodePosition(uvec2(at.x, at.y * kStrip)).x;
      sums += vec3(sumOf(change), sumOf(change) * x, dotOf(change, columnPositions(at)));
    }
    checkLoop(k < window.num_strips);
    partial[part] = vec4(sums, 0);
  }
  vec4 sums = sumOfPartials(window.num_parts) * node_force;
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
  addPressedSources(window);
  for (uint c = 0; c < 6; ++c) {
    // The objects' motion relative to the sensor under unit twist c of the sensor, about the origin of P.
    vec3 v = vec3(0), w = vec3(0);
    if (c < 3) {
      v[c] = -1.0;
    } else {
      w[c - 3] = -1.0;
    }
    float first = beginRates(surface, window, shift, R_PS * (v + cross(w, origin)), R_PS * w);
    float squared_residual = first;
    for (uint n = 0; n < kMaxJacobianIterations && squared_residual > kJacobianTolerance * first; ++n) {
      squared_residual = stepRates(window, squared_residual);
    }
    workgroupBarrierWithBuffers();
    writeWrenchJacobian(instance, window, c, transpose(R_PS), origin, node_force);
    writeTaxelJacobian(instance, window, c, node_force);
    workgroupBarrierWithBuffers();
  }
}
