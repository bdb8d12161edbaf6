#version 460
#extension GL_GOOGLE_include_directive : require
// Pass of the law deformation_mask, second half: scales the forces of all taxels so that their sum, reduced by saturation, is the contact force again.
//
// An invocation owns one instance.
// In:  law_state (num_instances x num_taxels), .x, N; tile_results (num_instances x num_tiles): the contact force.
// Out: contact_normal (num_instances x num_taxels), N, for the spread.
// Shared memory: none. Deterministic: taxels are summed in order.
// Twin: src/reference/taxel_laws.cpp.

#include "common/taxel_pass.glsl"

void main() {
  uint instance = invocationNumber();
  if (!isProcessed(instance)) return;
  float pressed = 0.0, carried = 0.0;
  for (uint t = 0; t < NUM_TILES; ++t) pressed += tile_results[instance * NUM_TILES + t].torque.w;
  uint first = instance * NUM_TAXELS;
  uint t = 0;
  for (; t < NUM_TAXELS; ++t) carried += law_state[first + t].x;
  checkLoop(t < NUM_TAXELS);
  float scale = carried > 0.0 ? pressed / carried : 0.0;
  for (t = 0; t < NUM_TAXELS; ++t) writeForce(instance, t, scale * law_state[first + t].x);
  checkLoop(t < NUM_TAXELS);
  reportUnfinishedLoops();
}
