#version 460
#extension GL_GOOGLE_include_directive : require
// Tactile Jacobian pass, first step, after the contact pass: derivatives of every taxel's contact force and of every tile's wrench by the sensor's twist (v at
// the origin of S and w, in S) while the objects stay. The sensor's twist is minus the objects' twist seen from S.
//
// An invocation owns a taxel of one instance, and the tile of the same number.
// In:  contact_cells (num_instances x num_taxels), tile_changes (num_instances x num_tiles x LANES), as skin/cell_fluxes.glsl leaves them.
// Out: taxel_jacobian (num_instances x 6 x num_taxels), N/m and N/rad, over the part of the spread's kernel that stays on the sensor where SCALED;
//      wrench_jacobian (num_instances x num_tiles x 6 x 6), by force and torque, then by twist: N/m, N/rad, N m/m, N m/rad.
// Shared memory: none.
// Deterministic: LANES partial sums are added in their order.
// Twin: src/reference/tactile_jacobian.cpp.

#include "shared/batch.h"
#include "shared/features.h"
#include "shared/sensor.h"
#include "passes/declare.glsl"
#include "passes/taxel_jacobian.h"

#include "common/workgroup.glsl"
#include "common/instances.glsl"
#include "common/transform.glsl"

bool isTouched(uint taxel) { return contact_cells[taxel].high_y.w != 0.0; }

Affine patchPose(uint patch_number) { return Affine(patches[patch_number].row0, patches[patch_number].row1, patches[patch_number].row2); }

// A vector in P, and the origin of P, in S.
vec3 toSensor(Affine X_PS, vec3 v) { return X_PS.row0.xyz * v.x + X_PS.row1.xyz * v.y + X_PS.row2.xyz * v.z; }
vec3 originInSensor(Affine X_PS) { return -toSensor(X_PS, vec3(X_PS.row0.w, X_PS.row1.w, X_PS.row2.w)); }

// Derivatives of a taxel's force by the object's twist in P: v, then w.
void taxelChange(uint first_taxel, uint in_sensor, uvec4 grid, out vec3 by_v, out vec3 by_w) {
  vec3 side[4] = vec3[4](vec3(0), vec3(0), vec3(0), vec3(0));
  vec3 slope = vec3(0);
  uint taxel = first_taxel + in_sensor;
  uvec2 at = uvec2((in_sensor - grid.z) / grid.y, (in_sensor - grid.z) % grid.y);
  if (isTouched(taxel)) {
    CellRecord cell = contact_cells[taxel];
    side = vec3[4](cell.low_x.xyz, cell.high_x.xyz, cell.low_y.xyz, cell.high_y.xyz);
    slope = vec3(cell.low_x.w, cell.high_x.w, cell.low_y.w);
  }
  if (at.x > 0 && isTouched(taxel - grid.y)) side[0] += contact_cells[taxel - grid.y].high_x.xyz;
  if (at.x + 1 < grid.x && isTouched(taxel + grid.y)) side[1] += contact_cells[taxel + grid.y].low_x.xyz;
  if (at.y > 0 && isTouched(taxel - 1)) side[2] += contact_cells[taxel - 1].high_y.xyz;
  if (at.y + 1 < grid.y && isTouched(taxel + 1)) side[3] += contact_cells[taxel + 1].low_y.xyz;
  vec3 through_x = side[1] - side[0], through_y = side[3] - side[2];  // of f, G, f times the coordinate along the side
  by_v = vec3(-through_x.x, -through_y.x, -slope.x);
  by_w = vec3(-slope.z - through_y.y, slope.y + through_x.y, through_x.z - through_y.z);
}

void writeTaxel(uint instance, uint in_sensor) {
  uint patch_number = uint(taxels[in_sensor].readout.z);
  Affine X_PS = patchPose(patch_number);
  vec3 by_v, by_w;
  taxelChange(instance * NUM_TAXELS, in_sensor, patches[patch_number].grid, by_v, by_w);
  // The sensor's v at the origin of P is v + w x p, so that force . (w x p) = w . (p x force).
  vec3 v = -toSensor(X_PS, by_v);
  vec3 w = -toSensor(X_PS, by_w) + cross(originInSensor(X_PS), v);
  float scale = SCALED ? spread_scale[in_sensor] : 1.0;
  for (uint k = 0; k < 3; ++k) {
    taxel_jacobian[(instance * 6 + k) * NUM_TAXELS + in_sensor] = scale * v[k];
    taxel_jacobian[(instance * 6 + 3 + k) * NUM_TAXELS + in_sensor] = scale * w[k];
  }
}

void writeWrench(uint instance, uint tile_number) {
  uint tile = instance * NUM_TILES + tile_number;
  // In P: row k holds the derivatives of force, x times force and y times force by coordinate k of the object's twist.
  vec3 change[6] = vec3[6](vec3(0), vec3(0), vec3(0), vec3(0), vec3(0), vec3(0));
  if (HAS_FORCES && tile_changes[tile * LANES * kTileChanges] < kNoHeight) {
    for (uint v = 0; v < LANES; ++v) {
      uint first = (tile * LANES + v) * kTileChanges;
      for (uint k = 0; k < 6; ++k) change[k] += vec3(tile_changes[first + 3 * k], tile_changes[first + 3 * k + 1], tile_changes[first + 3 * k + 2]);
    }
  }
  Affine X_PS = patchPose(tiles[tile_number].place.x);
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
  uint instance = number / NUM_TAXELS;
  if (!isProcessed(instance)) return;
  uint taxel = number - instance * NUM_TAXELS;
  writeTaxel(instance, taxel);
  if (taxel < NUM_TILES) writeWrench(instance, taxel);
}
