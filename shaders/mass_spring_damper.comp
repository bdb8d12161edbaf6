#version 460
#extension GL_GOOGLE_include_directive : require
// Pass of the law mass_spring_damper, after the contact pass: every taxel is a mass on a spring and a damper, pushed by the contact force;
// its reading is the force in its spring. include/taxelsim/sensor.h, MassSpringDamper.
//
// An invocation owns one taxel of one instance.
// In:  contact_normal (num_instances x num_taxels), N, of the contact pass; contact_shear (num_instances x num_taxels x 2), N, with SHEAR;
//      step_record.law: exp(A dt) of the taxel's motion about rest, by rows.
// Out: contact_normal, contact_shear, for the spread; law_state (num_instances x num_taxels): force in the spring (N) and its rate (N/s),
//      kept between steps.
// Shared memory: none.
// Reference: src/reference/taxel_laws.cpp.

#include "common/taxel_pass.glsl"
#include "common/transform.glsl"

void main() {
  uint number = invocationNumber();
  uint instance = number / NUM_TAXELS;
  if (!isProcessed(instance)) return;
  uint taxel = number - instance * NUM_TAXELS;
  float force = contactForce(instance, taxel);
  uint flags = instanceRecord(instance).keys.w;
  // At rest the spring carries the load.
  bool at_rest = (flags & (kFlagFirstStep | kFlagLoadDriven)) != 0;
  vec2 off_rest = at_rest ? vec2(0) : law_state[number] - vec2(force, 0);
  vec4 law = step_record.law;
  off_rest = vec2(dot(law.xy, off_rest), dot(law.zw, off_rest));
  vec2 state = vec2(force, 0) + off_rest;
  law_state[number] = state;
  // A spring that swings past its rest position does not pull.
  float reading = max(state.x, 0.0);
  writeForce(instance, taxel, reading);
  // While the mass lags behind the contact force, friction is limited by the force in the spring.
  if (SHEAR) writeShear(instance, taxel, onCone(contactShear(instance, taxel), FRICTION_COEFFICIENT * reading));
}
