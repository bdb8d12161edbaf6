#version 460
#extension GL_GOOGLE_include_directive : require
// Law deformation_mask, after the contact pass, first half: what contact presses into the surface of one taxel deforms its neighbours, by the mask; a cell
// saturates. include/taxelsim/sensor.h, DeformationMask. An invocation owns one taxel of one instance.
//
// In:  contact_normal (num_instances x num_taxels), N, as the contact pass left it; mask.
// Out: law_state (num_instances x num_taxels), .x: force before it is rescaled, N. LAW_0: saturation pressure, Pa.
// Twin: src/reference/taxel_laws.cpp.

#include "common/taxel_pass.glsl"

void main() {
  uint number = invocationNumber();
  uint instance = number / NUM_TAXELS;
  if (instance >= step_record.batch.x) return;
  uint taxel = number - instance * NUM_TAXELS;
  float force = 0.0;
  for (uint e = 0; e < 9; ++e) {
    vec2 source = mask[e * NUM_TAXELS + taxel];
    force += source.y * contactForce(instance, floatBitsToUint(source.x));
  }
  law_state[number].x = min(force, LAW_0 * taxels[taxel].chart.w);
}
