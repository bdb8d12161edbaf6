#version 460
#extension GL_GOOGLE_include_directive : require
// Tactile Jacobian pass, option: derivatives of every taxel's force after the point spread function by the sensor's twist.
//
// An invocation owns a taxel of one instance.
// In:  taxel_jacobian (num_instances x 6 x num_taxels), N/m and N/rad.
// Out: spread_jacobian (num_instances x 6 x num_taxels), N/m and N/rad.
// Shared memory: none.
// Mutable global: small_kernel (features/spread_change.glsl).
// Reference: src/reference/tactile_jacobian.cpp.

#include "passes/declare.glsl"
#include "passes/spread_jacobian.h"

#include "common/instances.glsl"
#include "features/spread_change.glsl"

void main() {
  uint number = workgroupNumber() * WORKGROUP + gl_LocalInvocationIndex;
  uint instance = number / NUM_TAXELS;
  if (!isProcessed(instance)) return;
  uint taxel = number - instance * NUM_TAXELS;
  loadKernel();
  for (uint k = 0; k < 6; ++k) spread_jacobian[(instance * 6 + k) * NUM_TAXELS + taxel] = spreadChange(instance, taxel, k);
}
