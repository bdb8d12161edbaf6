// The tactile Jacobian of an elastic layer: how its forces change as the sensor moves and the objects stay. Included by elastic_layer.comp, whose names it
// uses. Twin: src/reference/layer_rates.cpp.
//
// Over the nodes in contact A p = d, so that A dp = dd: conjugate gradients again, over nodes that are known by now, once for each coordinate of the twist.
// Nodes that come or go carry nothing at that moment. The object's surface lies at z = -d(x, y) of P; its point p = (x, y, -d) moves with u = v + w x p, so
// that d changes by -u_z - u_x d_x - u_y d_y. Of a skin that relaxes these are the changes at once.
//
// kLayerTarget takes the changes of pressure dp, kLayerResidual what they miss; the two are free once all else is told.

const uint kMostRounds = 48;         // of conjugate gradients; of a few thousand nodes in contact half as many suffice
const float kRoundsEnd = 1e-8;       // squares that are left, of those at the beginning
const float kSteepest = 2.0;         // slopes of depth beyond which there is a wall

// Height at a node, kMiss where it is not known.
float knownHeight(Surface surface, uvec2 node) {
  uvec4 reached = surface.reached;
  bool inside = node.x >= reached.x && node.x < reached.y && node.y >= reached.z && node.y < reached.w;  // before 0 is far behind the end
  return inside ? withoutSlot(heights[surface.first_height + node.x * NODE_COLS + node.y]) : kMiss;
}

// Of depth, along rows (axis 0) or columns: the mean of what the neighbours on both sides tell, walls left out.
float slopeOfDepth(Surface surface, uvec2 node, uint axis) {
  float spacing = nodeSpacing()[axis], height = knownHeight(surface, node);
  uvec2 next = axis == 0 ? uvec2(1, 0) : uvec2(0, 1);
  float from = (knownHeight(surface, node - next) - height) / spacing, to = (height - knownHeight(surface, node + next)) / spacing;
  vec2 known = vec2(abs(from) < kSteepest ? 1.0 : 0.0, abs(to) < kSteepest ? 1.0 : 0.0);
  if (known.x + known.y == 0.0) return 0.0;
  return ((known.x > 0.0 ? from : 0.0) + (known.y > 0.0 ? to : 0.0)) / (known.x + known.y);
}

// How fast the overlap at a node grows as the object moves by v and w, in P, thicknesses per m or rad. Beyond the skin's thickness it does not.
float overlapRate(Surface surface, uvec2 node, float shift, vec3 v, vec3 w) {
  float d = overlapAt(surface, node) + shift;
  if (d >= 1.0) return 0.0;
  vec3 u = v + cross(w, vec3(nodePosition(node), -d * THICKNESS));
  return -(u.z + u.x * slopeOfDepth(surface, node, 0) + u.y * slopeOfDepth(surface, node, 1)) / THICKNESS;
}

Strip pressedOver(uvec2 at) { return whereAbove(readStrip(kLayerPressure, at), 0.0); }

// Rates of overlap over the nodes in contact become what is missed, and the first direction; no pressure changes yet. Returns the sum of their squares.
float beginRates(Surface surface, float shift, vec3 v, vec3 w) {
  for (uint part = gl_LocalInvocationIndex; part < num_parts; part += WORKGROUP) {
    float squares = 0.0;
    uint k = part;
    for (; k < num_strips; k += LANES) {
      uvec2 at = stripAt(k);
      Strip pressed = pressedOver(at), rate = strip(0.0);
      for (uint c = 0; c < kStrip; ++c) {
        bool touches = (c < 4 ? pressed.low[c] : pressed.high[c - 4]) > 0.0;
        float value = touches ? overlapRate(surface, uvec2(at.x, at.y * kStrip + c), shift, v, w) : 0.0;
        if (c < 4) rate.low[c] = value; else rate.high[c - 4] = value;
      }
      writeStrip(kLayerTarget, at, strip(0.0));
      writeStrip(kLayerResidual, at, rate);
      writeStrip(kLayerDirection, at, rate);
      squares += dotOf(rate, rate);
    }
    cut_short = cut_short || k < num_strips;
    partial[part] = vec4(squares, 0, 0, 0);
  }
  return sumOfPartials(num_parts).x;
}

// One step along the direction; returns the squares that are left, of `squares` before it.
float stepRates(float squares) {
  for (uint part = gl_LocalInvocationIndex; part < num_parts; part += WORKGROUP) {
    float curvature = 0.0;
    uint k = part;
    for (; k < num_strips; k += LANES) {
      uvec2 at = stripAt(k);
      Strip q = productOf(displacementAt(at, kLayerDirection), pressedOver(at));
      writeStrip(kLayerProduct, at, q);
      curvature += dotOf(q, readStrip(kLayerDirection, at));
    }
    cut_short = cut_short || k < num_strips;
    partial[part] = vec4(curvature, 0, 0, 0);
  }
  float curvature = sumOfPartials(num_parts).x;
  float step_length = curvature > 0.0 ? squares / curvature : 0.0;
  for (uint part = gl_LocalInvocationIndex; part < num_parts; part += WORKGROUP) {
    float left = 0.0;
    uint k = part;
    for (; k < num_strips; k += LANES) {
      uvec2 at = stripAt(k);
      Strip missed = minus(readStrip(kLayerResidual, at), scaled(readStrip(kLayerProduct, at), step_length));
      writeStrip(kLayerTarget, at, sumOf(readStrip(kLayerTarget, at), scaled(readStrip(kLayerDirection, at), step_length)));
      writeStrip(kLayerResidual, at, missed);
      left += dotOf(missed, missed);
    }
    cut_short = cut_short || k < num_strips;
    partial[part] = vec4(left, 0, 0, 0);
  }
  float left = sumOfPartials(num_parts).x;
  uint k = gl_LocalInvocationIndex;
  for (; k < num_strips; k += WORKGROUP) {
    uvec2 at = stripAt(k);
    writeStrip(kLayerDirection, at, sumOf(readStrip(kLayerResidual, at), scaled(readStrip(kLayerDirection, at), left / squares)));
  }
  cut_short = cut_short || k < num_strips;
  meet();
  return left;
}

// What the changes of pressure mean for the wrench, by coordinate `c` of the sensor's twist.
void keepWrenchChange(uint instance, uint c, mat3 R_SP, vec3 origin) {
  vec2 spacing = nodeSpacing();
  for (uint part = gl_LocalInvocationIndex; part < num_parts; part += WORKGROUP) {
    vec3 sums = vec3(0);  // changes of pressure, these times x and y of P
    uint k = part;
    for (; k < num_strips; k += LANES) {
      uvec2 at = stripAt(k);
      Strip change = readStrip(kLayerTarget, at);
      vec2 corner = nodePosition(uvec2(at.x, at.y * kStrip));
      Strip along = Strip(corner.y + vec4(0, 1, 2, 3) * spacing.y, corner.y + vec4(4, 5, 6, 7) * spacing.y);
      sums += vec3(sumOf(change), sumOf(change) * corner.x, dotOf(change, along));
    }
    cut_short = cut_short || k < num_strips;
    partial[part] = vec4(sums, 0);
  }
  vec4 sums = sumOfPartials(num_parts) * node_force;
  if (gl_LocalInvocationIndex != 0) return;
  vec3 force = R_SP * vec3(0, 0, -sums.x), torque = R_SP * vec3(-sums.z, sums.y, 0) + cross(origin, force);
  for (uint axis = 0; axis < 3; ++axis) {
    wrench_jacobian[instance * kNumWrenchJacobian + 6 * axis + c] = force[axis];
    wrench_jacobian[instance * kNumWrenchJacobian + 6 * (axis + 3) + c] = torque[axis];
  }
}

// The same for every taxel.
void keepTaxelChanges(uint instance, uint c) {
  uvec2 margin = uvec2(MARGIN_ROWS, MARGIN_COLS);
  for (uint k = gl_LocalInvocationIndex; k < NUM_TAXELS; k += WORKGROUP) {
    uvec2 first = margin + uvec2(k / NUM_COLS, k % NUM_COLS) * SAMPLES;
    float change = 0.0;
    for (uint a = 0; num_strips > 0 && a < SAMPLES; ++a) {
      for (uint b = 0; b < SAMPLES; ++b) {
        uvec2 node = first + uvec2(a, b);
        // Beside the contact the array holds what it did before.
        if (valueAt(kLayerPressure, node) > 0.0) change += valueAt(kLayerTarget, node);
      }
    }
    taxel_jacobian[(instance * 6 + c) * NUM_TAXELS + k] = change * node_force * spread_scale[k];
  }
}

void keepJacobian(uint instance, Surface surface, float shift) {
  mat3 R_PS = mat3(sensor.X_SC_row0.xyz, sensor.X_SC_row1.xyz, sensor.X_SC_row2.xyz);
  vec3 origin = vec3(sensor.X_SC_row0.w, sensor.X_SC_row1.w, sensor.X_SC_row2.w);
  meet();
  clearSources();
  uint k = gl_LocalInvocationIndex;
  for (; k < num_strips; k += WORKGROUP) {
    if (sumOf(pressedOver(stripAt(k))) > 0.0) addSource(stripAt(k));
  }
  cut_short = cut_short || k < num_strips;
  meet();
  for (uint c = 0; c < 6; ++c) {
    // Unit twist c of the sensor, moved to P; seen from there the objects go the other way.
    vec3 v = vec3(0), w = vec3(0);
    if (c < 3) {
      v[c] = -1.0;
    } else {
      w[c - 3] = -1.0;
    }
    float first = beginRates(surface, shift, R_PS * (v + cross(w, origin)), R_PS * w);
    float squares = first;
    for (uint round = 0; round < kMostRounds && squares > kRoundsEnd * first; ++round) squares = stepRates(squares);
    meet();
    keepWrenchChange(instance, c, transpose(R_PS), origin);
    keepTaxelChanges(instance, c);
    meet();
  }
}
