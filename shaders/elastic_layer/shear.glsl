// Shear of an elastic layer, by skin/friction.glsl at every node under pressure, of taxels and margin alike. Included by elastic_layer.comp, whose names it
// uses. Twin: src/reference/friction.cpp.

struct Shear {
  vec2 force;   // on the sensor along x and y of P, N
  vec3 torque;  // about P's origin, in P, N m
};

vec2 nodeSpacing() { return vec2(PITCH_X, PITCH_Y) / float(SAMPLES); }
float nodeArea() { return nodeSpacing().x * nodeSpacing().y; }
vec2 nodePosition(uvec2 node) { return (vec2(node) - 0.5 * vec2(NODE_ROWS - 1u, NODE_COLS - 1u)) * nodeSpacing(); }

uint frictionStart(uint instance) { return instance * (kFrictionHeader + NODE_ROWS * NODE_COLS); }
uint shearState(uint instance, uvec2 node) { return frictionStart(instance) + kFrictionHeader + node.x * NODE_COLS + node.y; }

// The rectangle of nodes outside which there is no pressure: first row, end row, first col, end col.
uvec4 pressedNodes() {
  clearSources();
  uint k = gl_LocalInvocationIndex;
  for (; k < num_strips; k += WORKGROUP) {
    uvec2 at = stripAt(k);
    if (largestOf(readStrip(kLayerPressure, at)) > 0.0) addSource(at);
  }
  cut_short = cut_short || k < num_strips;
  meet();
  uint row = source_rows[0], end = source_rows[1];
  uvec4 pressed = uvec4(row, end, NODE_COLS, 0);
  for (; row < end; ++row) pressed.zw = uvec2(min(pressed.z, source_first[row] * kStrip), max(pressed.w, source_end[row] * kStrip));
  cut_short = cut_short || row < end;
  pressed.w = min(pressed.w, NODE_COLS);
  return pressed.x < pressed.y ? pressed : uvec4(0);
}

// `shift`: as of the solution; `moved_z`: how far a load search has moved the objects along z of S in this step, m.
Shear shearNodes(uint instance, uint num_slots, Surface surface, uvec4 pressed, float shift, float moved_z) {
  uvec4 kept = keptWindow(frictionStart(instance));
  X_PS = inverseOf(Affine(sensor.X_SC_row0, sensor.X_SC_row1, sensor.X_SC_row2));
  loadMotions(instance, num_slots, moved_z);
  uvec2 first = pressed.xz, count = pressed.yw - first;
  for (uint v = gl_LocalInvocationIndex; v < LANES; v += WORKGROUP) {
    vec2 force = vec2(0);
    vec3 torque = vec3(0);
    uint k = v;
    for (; k < count.x * count.y; k += LANES) {
      uvec2 node = first + cellNumbered(k, count.y);
      float pressure = valueAt(kLayerPressure, node) * (node_force / nodeArea());
      uint slot = slotOf(heights[surface.first_height + node.x * NODE_COLS + node.y]);
      vec3 p = vec3(nodePosition(node), -(overlapAt(surface, node) + shift) * THICKNESS);
      vec2 q = shearTraction(shearState(instance, node), isKept(node, kept), pressure > 0.0, slot, p, pressure);
      force += q;
      torque += cross(p, vec3(q, 0));
    }
    cut_short = cut_short || k < count.x * count.y;
    partial[v] = vec4(torque, 0);
    partial_shear[v] = force;
  }
  Shear shear;
  shear.torque = sumOfPartials(LANES).xyz * nodeArea();
  shear.force = vec2(0);
  for (uint v = 0; v < LANES; ++v) shear.force += partial_shear[v];
  shear.force *= nodeArea();
  if (gl_LocalInvocationIndex == 0) keepWindow(frictionStart(instance), pressed);
  return shear;
}
