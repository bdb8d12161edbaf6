#version 460
#extension GL_GOOGLE_include_directive : require
// Law proximity, after the contact pass: taxels answer to depth alone, nothing presses on the sensor. An invocation owns one tile of one instance.
//
// In, out: tile_results: no force, no torque. Twin: src/reference/taxel_laws.cpp.

#include "common/taxel_pass.glsl"

void main() {
  uint number = invocationNumber();
  if (number >= step_record.batch.x * NUM_TILES) return;
  tile_results[number].force.xyz = vec3(0);
  tile_results[number].torque = vec4(0);
}
