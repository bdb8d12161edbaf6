#version 460
#extension GL_GOOGLE_include_directive : require
// Tactile Jacobian of the law deformation_mask, second half: differentiates the scale of deformation_mask.comp. With scale = pressed /
// carried, the derivative of scale r is scale r' + scale' r.
//
// An invocation owns one coordinate of the twist of one instance.
// In:  masked_jacobian (num_instances x 6 x num_taxels): r'; law_state (num_instances x num_taxels): r, N; tile_results (num_instances x
//      num_tiles): pressed, N.
// In, out: taxel_jacobian (num_instances x 6 x num_taxels), for the spread.
// Shared memory: none. Deterministic: taxels are summed in order.
// Reference: src/reference/tactile_jacobian.cpp.

#include "passes/declare.glsl"
#include "passes/rescale_jacobian.h"

#include "common/instances.glsl"
#include "driver/loops.glsl"

void main() {
  uint number = workgroupNumber() * WORKGROUP + gl_LocalInvocationIndex;
  uint instance = number / 6;
  if (!isProcessed(instance)) return;
  float pressed = 0.0, carried = 0.0, pressed_change = 0.0, carried_change = 0.0;
  for (uint t = 0; t < NUM_TILES; ++t) pressed += tileResult(instance * NUM_TILES + t).torque.w;
  uint first = number * NUM_TAXELS, first_taxel = instance * NUM_TAXELS;
  uint t = 0;
  for (; t < NUM_TAXELS; ++t) {
    carried += law_state[first_taxel + t].x;
    pressed_change += taxel_jacobian[first + t];
    carried_change += masked_jacobian[first + t];
  }
  checkLoop(t < NUM_TAXELS);
  float scale = carried > 0.0 ? pressed / carried : 0.0;
  float scale_change = carried > 0.0 ? (pressed_change - scale * carried_change) / carried : 0.0;
  for (t = 0; t < NUM_TAXELS; ++t) {
    float change = scale * masked_jacobian[first + t] + scale_change * law_state[first_taxel + t].x;
    taxel_jacobian[first + t] = SCALED ? change * spread_scale[t] : change;
  }
  checkLoop(t < NUM_TAXELS);
  reportUnfinishedLoops();
}
