#version 460
#extension GL_GOOGLE_include_directive : require
// Law deformation_mask, second half: what saturation has cut off is given to all taxels in proportion, so that they carry what contact presses. An
// invocation owns one instance.
//
// In:  law_state (num_instances x num_taxels), .x, N; tile_results: the force of contact. Out: contact_normal, for the spread.
// Twin: src/reference/taxel_laws.cpp.

#include "common/taxel_pass.glsl"

void main() {
  uint instance = invocationNumber();
  if (instance >= step_record.batch.x) return;
  float pressed = 0.0, carried = 0.0;
  for (uint t = 0; t < NUM_TILES; ++t) pressed += tile_results[instance * NUM_TILES + t].torque.w;
  uint first = instance * NUM_TAXELS;
  uint t = 0;
  for (; t < NUM_TAXELS; ++t) carried += law_state[first + t].x;
  checkLoop(t < NUM_TAXELS);
  float scale = carried > 0.0 ? pressed / carried : 0.0;
  for (t = 0; t < NUM_TAXELS; ++t) giveToSpread(instance, t, scale * law_state[first + t].x);
  checkLoop(t < NUM_TAXELS);
  reportUnfinishedLoops();
}
