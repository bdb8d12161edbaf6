#version 460
#extension GL_GOOGLE_include_directive : require
// Tactile Jacobian of the law deformation_mask, first half: differentiates deformation_mask.comp. The derivative of a saturated taxel is 0.
//
// An invocation owns one taxel of one instance.
// In:  taxel_jacobian (num_instances x 6 x num_taxels); mask (MASK_SOURCES / 2 x num_taxels): two sources of every taxel; law_state
//      (num_instances x num_taxels): forces after the mask, N. LAW_0: saturation pressure, Pa.
// Out: masked_jacobian (num_instances x 6 x num_taxels).
// Shared memory: none.
// Reference: src/reference/tactile_jacobian.cpp.

#include "passes/declare.glsl"
#include "passes/mask_jacobian.h"

#include "common/instances.glsl"

void main() {
  uint number = workgroupNumber() * WORKGROUP + gl_LocalInvocationIndex;
  uint instance = number / NUM_TAXELS;
  if (!isProcessed(instance)) return;
  uint taxel = number - instance * NUM_TAXELS;
  bool is_saturated = law_state[number].x >= LAW_0 * taxels[taxel].chart.w;
  for (uint k = 0; k < 6; ++k) {
    uint first = (instance * 6 + k) * NUM_TAXELS;
    float sum = 0.0;
    for (uint e = 0; e < MASK_SOURCES / 2u; ++e) {
      uvec4 sources = fourOf(Mask, e * NUM_TAXELS + taxel);
      sum += uintBitsToFloat(sources.y) * taxel_jacobian[first + sources.x];
      sum += uintBitsToFloat(sources.w) * taxel_jacobian[first + sources.z];
    }
    masked_jacobian[first + taxel] = is_saturated ? 0.0 : sum;
  }
}
