// Shear of an elastic layer: skin/friction.glsl at every node under pressure, of taxels and margin alike. Forces in N, in P. Reference:
// src/reference/friction.cpp.

// Springs, whose state is their traction.
vec2 tractionAfter(inout vec2 traction, vec2 u, float share, float covered, float pressure, float per_dt) {
  return traction = onCone(traction + TANGENTIAL_STIFFNESS * covered * share * u, FRICTION_COEFFICIENT * pressure);
}

#include "skin/friction.glsl"

struct Shear {
  vec2 force;   // on the sensor along x and y of P, N
  vec3 torque;  // about P's origin, in P, N m
};

// Index of the friction state of an instance: the rectangle of nodes that have a state (first row, end row; first col, end col), then
// nodes.
uint frictionStart(uint instance) { return instance * (kFrictionHeader + NODE_ROWS * NODE_COLS); }
uint shearState(uint instance, uvec2 node) { return frictionStart(instance) + kFrictionHeader + node.x * NODE_COLS + node.y; }

// Shear traction of a node inside the rectangle that this step has stored, Pa.
vec2 tractionAt(uint instance, uvec2 node) {
  uvec2 words = friction_state[shearState(instance, node)];
  return hasContact(words) ? shearOf(words) : vec2(0);
}

// The rectangle of nodes outside which there is no pressure: first row, end row, first col, end col.
uvec4 pressedNodes(Window window) {
  clearSources();
  FOR_EACH_STRIP(window, if (largestOf(readStrip(window, kLayerPressure, at)) > 0.0) addSource(at))
  workgroupBarrierWithBuffers();
  uvec2 rows = sourceRows();
  if (rows.x == rows.y) return uvec4(0);
  uint strips = 0;
  for (uint row = rows.x; row < rows.y; ++row) strips |= source_strips[row];
  uvec2 cols = rangeOf(strips, kStripsPerBit, kRowStrips) * kStrip;
  return uvec4(rows, cols.x, min(cols.y, NODE_COLS));
}

// `pressed`: as pressedNodes() returns it. `shift`: of the solution, thicknesses. `moved_z`: by how much a load search has moved the
// objects along z of S in this step, m. `node_force`: force of a node under the pressure 1, N.
Shear shearNodes(uint instance, uint num_slots, Surface surface, uint layer_start, uvec4 pressed, float shift, float moved_z,
                 float node_force) {
  uint start = frictionStart(instance);
  uvec4 state_window = uvec4(friction_state[start], friction_state[start + 1]);
  Affine X_PS = inverseOf(Affine(sensor.X_SC_row0, sensor.X_SC_row1, sensor.X_SC_row2));
  Motion only_motion = loadMotions(instance, num_slots, moved_z, X_PS);
  uvec2 first = pressed.xz, count = pressed.yw - first;
  for (uint v = gl_LocalInvocationIndex; v < LANES; v += WORKGROUP) {
    vec2 force = vec2(0);
    vec3 torque = vec3(0);
    uint k = v;
    for (; k < count.x * count.y; k += LANES) {
      uvec2 node = first + cellNumbered(k, count.y);
      float pressure = valueAt(layer_start, kLayerPressure, node) * (node_force / nodeArea());
      NodeCell cell = cellAt(surface, node);
      uint slot = cell.edge > 0.0 ? cell.slot : slotOf(heightWordAt(surface, node));
      vec3 p = vec3(nodePosition(node) + cell.center, -(overlapAt(surface, node) + shift) * THICKNESS);
      float covered = cell.share > 0.0 ? cell.share : 1.0;  // skin that bulges meets a surface above it
      uvec2 words = isInside(node, state_window) ? friction_state[shearState(instance, node)] : uvec2(kNoFrictionState, 0u);
      vec2 q = shearTraction(words, pressure > 0.0, slot, only_motion, p, covered, pressure, 0.0);
      friction_state[shearState(instance, node)] = words;
      force += q;
      torque += cross(p, vec3(q, 0));
    }
    checkLoop(k < count.x * count.y);
    setPartial(v, vec4(torque, 0));
    setPartialShear(v, force);
  }
  Shear shear;
  shear.torque = sumOfPartials(LANES).xyz * nodeArea();
  shear.force = sumOfPartialShears() * nodeArea();
  if (gl_LocalInvocationIndex == 0) {
    friction_state[start] = pressed.xy;
    friction_state[start + 1] = pressed.zw;
  }
  return shear;
}
