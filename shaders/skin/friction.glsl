// Shear with memory: a tangential spring at every sample of the skin, held by the object that touches it, capped by Coulomb's cone;
// include/taxelsim/sensor.h, Friction. Included by contact.comp and elastic_layer.comp, whose names it uses. Twin: src/reference/friction.cpp.
//
// At a sample p = (x, y, -d) of P an object that moves by u in this step drags the end of the spring along by the tangential part of u, so that the
// traction q, which acts on the skin along the object's motion, becomes
//   q + k_t (u_x, u_y),  shortened to mu p where it is longer: the backward Euler step of elastic-perfectly plastic slip (radial return).
// Where contact began within the step only the part of u after touch counts; a sample that nothing touches forgets.
// The law lugre has another rule for the traction, skin/laws/lugre.glsl, and shares the rest.

#include "skin/cone.glsl"

// The rule, which the includer has: shear traction (Pa) under `pressure` (Pa) after the object has moved by `u` (m, along x and y of P), `share` of that in
// touch. `held` is what the sample keeps between steps.
vec2 tractionAfter(inout vec2 held, vec2 u, float share, float pressure);

// That of springs, which keep their traction.
vec2 springTraction(vec2 held, vec2 u, float share, float pressure) {
  return onCone(held + TANGENTIAL_STIFFNESS * share * u, FRICTION_COEFFICIENT * pressure);
}

// Motion of the object in a slot, from p in P to its displacement in P, m; kSlotRows rows a slot.
const uint kSlotRows = 4u;
shared vec4 slot_motions[kKeepsSlots ? kSlotRows << kSlotBits : 1u];
shared vec2 partial_shear[kShears ? LANES : 1u];

struct Motion {
  Affine displacement;
  bool known;
};
Motion only_motion;  // where an instance has one slot

// In the frame of the patch: R_PS D X_SP for the displacement D in S.
Affine motionInPatch(Affine motion) {
  vec3 b = vec3(X_PS.row0.w, X_PS.row1.w, X_PS.row2.w);
  Affine turned;  // D X_SP: a row a of D becomes (a R_SP | t - a R_SP b)
  vec3 a0 = vec3(dot(motion.row0.xyz, X_PS.row0.xyz), dot(motion.row0.xyz, X_PS.row1.xyz), dot(motion.row0.xyz, X_PS.row2.xyz));
  vec3 a1 = vec3(dot(motion.row1.xyz, X_PS.row0.xyz), dot(motion.row1.xyz, X_PS.row1.xyz), dot(motion.row1.xyz, X_PS.row2.xyz));
  vec3 a2 = vec3(dot(motion.row2.xyz, X_PS.row0.xyz), dot(motion.row2.xyz, X_PS.row1.xyz), dot(motion.row2.xyz, X_PS.row2.xyz));
  turned.row0 = vec4(a0, motion.row0.w - dot(a0, b));
  turned.row1 = vec4(a1, motion.row1.w - dot(a1, b));
  turned.row2 = vec4(a2, motion.row2.w - dot(a2, b));
  Affine rotation = X_PS;
  rotation.row0.w = rotation.row1.w = rotation.row2.w = 0.0;
  return compose(rotation, turned);
}

// `moved_z`: how far a load search moves the objects along z of S in this step, m.
Motion motionInSlot(uint slot_index, float moved_z) {
  Affine motion = Affine(motions[slot_index].row0, motions[slot_index].row1, motions[slot_index].row2);
  bool known = motions[slot_index].known.x > 0.0;
  if (known) motion.row2.w += moved_z;
  if (!FLAT) motion = motionInPatch(motion);
  return Motion(motion, known);
}

void loadMotions(uint instance, uint num_slots, float moved_z) {
  if (!kKeepsSlots) {
    only_motion = motionInSlot(instance, moved_z);
    return;
  }
  for (uint slot = gl_LocalInvocationIndex; slot < num_slots; slot += WORKGROUP) {
    Motion motion = motionInSlot(instance * num_slots + slot, moved_z);
    slot_motions[kSlotRows * slot] = motion.displacement.row0;
    slot_motions[kSlotRows * slot + 1] = motion.displacement.row1;
    slot_motions[kSlotRows * slot + 2] = motion.displacement.row2;
    slot_motions[kSlotRows * slot + 3].x = motion.known ? 1.0 : 0.0;
  }
  workgroupBarrier();
}

Motion motionOf(uint slot) {
  if (!kKeepsSlots) return only_motion;
  return Motion(Affine(slot_motions[kSlotRows * slot], slot_motions[kSlotRows * slot + 1], slot_motions[kSlotRows * slot + 2]),
                slot_motions[kSlotRows * slot + 3].x > 0.0);
}

// What a sample keeps, 0 where nothing touched.
vec2 heldAt(uint state_index) {
  uvec2 words = wordsOf(friction_state[state_index]);
  return (words.x & ~kSlotMask) == kNoFrictionState ? vec2(0) : vec2(withoutSlot(words.x), uintBitsToFloat(words.y));
}

// Shear traction (Pa) at the sample p of P under `pressure` (Pa), if the object in `slot` touches there; leaves the sample's state for the next step.
// `kept`: the sample has a state of the step before.
vec2 shearTraction(uint state_index, bool kept, bool touches, uint slot, vec3 p, float pressure) {
  uvec2 before = uvec2(kNoFrictionState, 0u), after = before;
  vec2 q = vec2(0), held = vec2(0);
  if (touches) {
    if (kept) before = wordsOf(friction_state[state_index]);
    bool touched = (before.x & ~kSlotMask) != kNoFrictionState && slotOf(before.x) == slot;
    Motion motion = motionOf(slot);
    if (motion.known) {
      vec3 u = apply(motion.displacement, p);
      float share = !touched && u.z < 0.0 ? clamp(p.z / u.z, 0.0, 1.0) : 1.0;  // skin that bulges meets objects at p.z > 0
      if (touched) held = vec2(withoutSlot(before.x), uintBitsToFloat(before.y));
      q = tractionAfter(held, u.xy, share, pressure);
    }
    after = uvec2(withSlot(held.x, slot), floatBitsToUint(held.y));
  }
  friction_state[state_index] = pairOf(after);
  return q;
}

// The taxels of the patch whose samples have a state, or the nodes of a layer that have one: first row, end row, first col, end col.
uvec4 keptWindow(uint tile_state) { return uvec4(wordsOf(friction_state[tile_state]), wordsOf(friction_state[tile_state + 1])); }

void keepWindow(uint tile_state, uvec4 window) {
  friction_state[tile_state] = pairOf(window.xy);
  friction_state[tile_state + 1] = pairOf(window.zw);
}

bool isKept(uvec2 at, uvec4 window) { return all(greaterThanEqual(at, window.xz)) && all(lessThan(at, window.yw)); }
