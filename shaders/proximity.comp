#version 460
#extension GL_GOOGLE_include_directive : require
// Pass of the law proximity, after the contact pass: readings follow from depth, and the sensor feels no force.
//
// An invocation owns one tile of one instance.
// In, out: tile_results (num_instances x num_tiles): clears force and torque.
// Shared memory: none.
// Reference: src/reference/taxel_laws.cpp.

#include "common/taxel_pass.glsl"

void main() {
  uint number = invocationNumber();
  if (!isProcessed(number / NUM_TILES)) return;
  tile_results[number].force.xyz = vec3(0);
  tile_results[number].torque = vec4(0);
}
