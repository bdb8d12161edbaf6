#version 460
#extension GL_GOOGLE_include_directive : require
// Law mass_spring_damper, after the contact pass: every taxel is a mass on a spring and a damper, pushed by the force of contact; what it reads is the
// force in its spring. include/taxelsim/sensor.h, MassSpringDamper. An invocation owns one taxel of one instance.
//
// In:  contact_normal (num_instances x num_taxels), N, as the contact pass left it; step_record.law: exp(A dt) of the taxel's motion about rest, by rows.
//      contact_shear (num_instances x num_taxels x 2), N, where it is wanted.
// Out: contact_normal, contact_shear, for the spread; law_state: force in the spring (N) and its rate (N/s).
// Twin: src/reference/taxel_laws.cpp.

#include "common/taxel_pass.glsl"
#include "skin/cone.glsl"

void main() {
  uint number = invocationNumber();
  uint instance = number / NUM_TAXELS;
  if (instance >= step_record.batch.x) return;
  uint taxel = number - instance * NUM_TAXELS;
  float force = contactForce(instance, taxel);
  uint flags = instances[instance].keys.w;
  // At rest the spring carries the load.
  bool at_rest = (flags & (kFlagFirstStep | kFlagLoadDriven)) != 0;
  vec2 off_rest = at_rest ? vec2(0) : law_state[number] - vec2(force, 0);
  vec4 law = step_record.law;
  off_rest = vec2(dot(law.xy, off_rest), dot(law.zw, off_rest));
  vec2 state = vec2(force, 0) + off_rest;
  law_state[number] = state;
  // A spring that swings back past its rest pulls on nothing.
  float reading = max(state.x, 0.0);
  giveToSpread(instance, taxel, reading);
  // While the mass lags behind the force of contact, friction holds no more than what the spring shows of it.
  if (SHEAR) giveShearToSpread(instance, taxel, onCone(contactShear(instance, taxel), FRICTION_COEFFICIENT * reading));
}
