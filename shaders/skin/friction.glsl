// Shear with memory: every sample of the skin has a tangential spring that the object in contact stretches, capped by Coulomb's cone;
// include/taxelsim/sensor.h, Friction. Used by the contact pass and the elastic layer. Reference: src/reference/friction.cpp.
//
// At a sample p = (x, y, -d) of P an object that moves by u in this step drags the end of the spring along by the tangential part of u, so
// that the traction q (Pa), which acts on the skin along the object's motion, becomes
//   q + k_t (u_x, u_y),  shortened to mu p where it is longer: the backward Euler step of elastic-perfectly plastic slip (radial return).
// Where contact began within the step only the part of u after touch counts; the state of a sample that nothing touches is cleared.
// The law lugre has its own rule for the traction (skin/law.glsl) and shares the rest.
//
// The includer defines FRICTION (shear is computed), MANY_SLOTS (several objects may be in contact), FLAT (the patch's frame is the
// sensor's) and the rule
//   vec2 tractionAfter(inout vec2 sample_state, vec2 u, float share, float covered, float pressure, float per_dt)
// for the shear traction (Pa, mean over the cell) under `pressure` (in the same unit) after the object, which covers a part `covered` of
// the cell, has moved by `u` (m, along x and y of P) while a `share` of the step in contact. `sample_state` is kept between steps.
// `per_dt`: 1 / the step's time, 1/s.
// Shared memory: 64 bytes per slot where an instance may touch several objects, and 8 LANES bytes.

#include "driver/arithmetic.glsl"
#include "driver/workgroup.glsl"
#include "common/transform.glsl"
#include "depth/slots.glsl"

const bool kManyMotions = kKeepsSlots && MANY_SLOTS;

// ---- motion of the objects ----

// Motion of the object in a slot: from p in P to its displacement in P, m.
struct Motion {
  Affine displacement;
  bool known;
};

const uint kSlotRows = 4u;  // rows of a slot in slot_motions[]
shared vec4 slot_motions[kManyMotions ? kSlotRows << kSlotBits : 1u];
shared vec2 partial_shear[FRICTION ? LANES : 1u];
vec2 own_shear = vec2(0);

// As setPartial() and sumOfPartials(), which has the barrier, driver/workgroup.glsl.
void setPartialShear(uint v, vec2 shear) {
  if (kInRegisters) {
    own_shear = shear;
  } else {
    partial_shear[v] = shear;
  }
}

vec2 sumOfPartialShears() {
  if (kInRegisters) return sumOverVector(own_shear);
  vec2 shear = vec2(0);
  for (uint v = 0; v < LANES; ++v) shear += partial_shear[v];
  return shear;
}

// In the frame of the patch: R_PS D X_SP for the displacement D in S.
Affine motionInPatch(Affine motion, Affine X_PS) {
  vec3 b = vec3(X_PS.row0.w, X_PS.row1.w, X_PS.row2.w);
  Affine rotated;  // D X_SP: a row a of D becomes (a R_SP | t - a R_SP b)
  vec3 a0 = vec3(dot(motion.row0.xyz, X_PS.row0.xyz), dot(motion.row0.xyz, X_PS.row1.xyz), dot(motion.row0.xyz, X_PS.row2.xyz));
  vec3 a1 = vec3(dot(motion.row1.xyz, X_PS.row0.xyz), dot(motion.row1.xyz, X_PS.row1.xyz), dot(motion.row1.xyz, X_PS.row2.xyz));
  vec3 a2 = vec3(dot(motion.row2.xyz, X_PS.row0.xyz), dot(motion.row2.xyz, X_PS.row1.xyz), dot(motion.row2.xyz, X_PS.row2.xyz));
  rotated.row0 = vec4(a0, motion.row0.w - dot(a0, b));
  rotated.row1 = vec4(a1, motion.row1.w - dot(a1, b));
  rotated.row2 = vec4(a2, motion.row2.w - dot(a2, b));
  Affine rotation = X_PS;
  rotation.row0.w = rotation.row1.w = rotation.row2.w = 0.0;
  return compose(rotation, rotated);
}

// `moved_z`: by how much a load search moves the objects along z of S in this step, m.
Motion motionInSlot(uint slot_index, float moved_z, Affine X_PS) {
  uint row = 4 * slot_index;
  Affine motion = Affine(floatsOfFour(Motions, row), floatsOfFour(Motions, row + 1), floatsOfFour(Motions, row + 2));
  bool known = floatsOfFour(Motions, row + 3).x > 0.0;
  if (known) motion.row2.w += moved_z;
  if (!FLAT) motion = motionInPatch(motion, X_PS);
  return Motion(motion, known);
}

// Loads the motions of an instance into shared memory with kManyMotions; otherwise returns the only one.
Motion loadMotions(uint instance, uint num_slots, float moved_z, Affine X_PS) {
  if (!kManyMotions) return motionInSlot(instance * num_slots, moved_z, X_PS);
  for (uint k = gl_LocalInvocationIndex; k < num_slots; k += WORKGROUP) {
    float number = floatsOfFour(Motions, 4 * (instance * num_slots + k) + 3).y;
    if (number < 0.0) continue;
    uint slot = uint(wholeNumber(number));
    Motion motion = motionInSlot(instance * num_slots + k, moved_z, X_PS);
    slot_motions[kSlotRows * slot] = motion.displacement.row0;
    slot_motions[kSlotRows * slot + 1] = motion.displacement.row1;
    slot_motions[kSlotRows * slot + 2] = motion.displacement.row2;
    slot_motions[kSlotRows * slot + 3].x = motion.known ? 1.0 : 0.0;
  }
  workgroupBarrier();
  return Motion(Affine(vec4(0), vec4(0), vec4(0)), false);
}

Motion motionOf(uint slot, Motion only_motion) {
  if (!kManyMotions) return only_motion;
  return Motion(Affine(slot_motions[kSlotRows * slot], slot_motions[kSlotRows * slot + 1], slot_motions[kSlotRows * slot + 2]),
                slot_motions[kSlotRows * slot + 3].x > 0.0);
}

// ---- state of the samples ----

// Two words, along x and y of P: the traction (Pa), or for the law lugre the bristle deflection in units of friction; the slot in the
// lowest bits of x. kNoFrictionState without contact.

bool hasContact(uvec2 words) { return (words.x & ~kSlotMask) != kNoFrictionState; }
vec2 shearOf(uvec2 words) { return vec2(withoutSlot(words.x), uintBitsToFloat(words.y)); }

// Shear traction (Pa) at the sample p of P under `pressure` (Pa), if the object in `slot` touches it and covers
// `covered` of its cell; updates the sample's state. `only_motion`: as loadMotions() returned it.
// Without branches (driver/README.md).
vec2 shearTraction(inout uvec2 words, bool touches, uint slot, Motion only_motion, vec3 p, float covered, float pressure, float per_dt) {
  Motion motion = motionOf(slot, only_motion);
  bool known = motion.known, same_slot = slotOf(words.x) == slot;  // locals, because glslang branches on && with other operands
  bool drags = touches && known, touched = hasContact(words) && same_slot;
  vec3 u = apply(motion.displacement, p);
  float share = !touched && u.z < 0.0 ? clamp(p.z / u.z, 0.0, 1.0) : 1.0;  // skin that bulges touches objects at p.z > 0
  vec2 sample_state = mix(vec2(0), shearOf(words), bvec2(touched));
  vec2 q = tractionAfter(sample_state, u.xy, share, covered, pressure, per_dt);
  sample_state = mix(vec2(0), sample_state, bvec2(drags));
  words = mix(uvec2(kNoFrictionState, 0u), uvec2(withSlot(sample_state.x, slot), floatBitsToUint(sample_state.y)), bvec2(touches));
  return mix(vec2(0), q, bvec2(drags));
}
