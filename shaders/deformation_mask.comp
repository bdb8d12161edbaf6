#version 460
#extension GL_GOOGLE_include_directive : require
// Pass of the law deformation_mask, after the contact pass, first half: the force on a taxel also deforms its neighbours, by a mask, and every taxel saturates.
// include/taxelsim/sensor.h, DeformationMask.
//
// An invocation owns one taxel of one instance.
// In:  contact_normal (num_instances x num_taxels), N, of the contact pass; mask (MASK_SOURCES / 2 x num_taxels): two sources of every taxel. LAW_0: saturation pressure, Pa.
// Out: law_state (num_instances x num_taxels), .x: force before rescale.comp, N.
// Shared memory: none.
// Twin: src/reference/taxel_laws.cpp.

#include "common/taxel_pass.glsl"

void main() {
  uint number = invocationNumber();
  uint instance = number / NUM_TAXELS;
  if (!isProcessed(instance)) return;
  uint taxel = number - instance * NUM_TAXELS;
  float force = 0.0;
  for (uint e = 0; e < MASK_SOURCES / 2u; ++e) {
    uvec4 sources = fourOf(Mask, e * NUM_TAXELS + taxel);
    force += uintBitsToFloat(sources.y) * contactForce(instance, sources.x);
    force += uintBitsToFloat(sources.w) * contactForce(instance, sources.z);
  }
  law_state[number].x = min(force, LAW_0 * taxels[taxel].chart.w);
}
