#version 460
#extension GL_GOOGLE_include_directive : require
// Tactile Jacobian pass, after the contact pass: derivatives of every tile's wrench by the sensor's twist (v at the origin of S and w, in
// S) while the objects stay. The sensor's twist is minus the objects' twist seen from S.
//
// An invocation owns a tile of one instance.
// In:  tile_changes (num_instances x num_tiles x LANES), as skin/cell_fluxes.glsl leaves them.
// Out: wrench_jacobian (num_instances x num_tiles x 6 x 6), by force and torque, then by twist: N/m, N/rad, N m/m, N m/rad.
// Shared memory: none.
// Deterministic: LANES partial sums are added in their order.
// Reference: src/reference/tactile_jacobian.cpp.

#include "shared/features.h"
#include "passes/declare.glsl"
#include "passes/wrench_jacobian.h"

#include "common/instances.glsl"
#include "common/transform.glsl"
#include "common/patch_pose.glsl"

void writeWrench(uint instance, uint tile_number) {
  uint tile = instance * NUM_TILES + tile_number;
  // In P: row k holds the derivatives of force, x times force and y times force by coordinate k of the object's twist.
  vec3 change[6] = vec3[6](vec3(0), vec3(0), vec3(0), vec3(0), vec3(0), vec3(0));
  if (HAS_FORCES && tile_changes[tile * LANES * kTileChanges] < kNoHeight) {
    for (uint v = 0; v < LANES; ++v) {
      uint first = (tile * LANES + v) * kTileChanges;
      for (uint k = 0; k < 6; ++k)
        change[k] += vec3(tile_changes[first + 3 * k], tile_changes[first + 3 * k + 1], tile_changes[first + 3 * k + 2]);
    }
  }
  Affine X_PS = patchPose(tiles[tile_number].origin.x);
  vec3 origin = originInSensor(X_PS);
  for (uint k = 0; k < 6; ++k) {
    // Unit twist k of the sensor, moved to P.
    vec3 v = vec3(0), w = vec3(0);
    if (k < 3) {
      v[k] = 1.0;
    } else {
      w[k - 3] = 1.0;
    }
    v += cross(w, origin);
    vec3 v_P = vec3(dot(X_PS.row0.xyz, v), dot(X_PS.row1.xyz, v), dot(X_PS.row2.xyz, v));
    vec3 w_P = vec3(dot(X_PS.row0.xyz, w), dot(X_PS.row1.xyz, w), dot(X_PS.row2.xyz, w));
    vec3 sum = -(change[0] * v_P.x + change[1] * v_P.y + change[2] * v_P.z + change[3] * w_P.x + change[4] * w_P.y + change[5] * w_P.z);
    // The skin is pressed along -z of P, with the torque (x, y, 0) x (0, 0, -f).
    vec3 force = -sum.x * X_PS.row2.xyz;
    vec3 torque = toSensor(X_PS, vec3(-sum.z, sum.y, 0)) + cross(origin, force);
    for (uint c = 0; c < 3; ++c) {
      wrench_jacobian[tile * kNumWrenchJacobian + 6 * c + k] = force[c];
      wrench_jacobian[tile * kNumWrenchJacobian + 6 * (c + 3) + k] = torque[c];
    }
  }
}

void main() {
  uint number = workgroupNumber() * WORKGROUP + gl_LocalInvocationIndex;
  uint instance = number / NUM_TILES;
  if (isProcessed(instance)) writeWrench(instance, number - instance * NUM_TILES);
}
