#version 460
#extension GL_GOOGLE_include_directive : require
// Tactile Jacobian pass, first step, after the contact pass: derivatives of every taxel's contact force by the sensor's twist (v at the
// origin of S and w, in S) while the objects stay. The sensor's twist is minus the objects' twist seen from S.
//
// An invocation owns a taxel of one instance.
// In:  contact_cells (num_instances x num_taxels), as skin/cell_fluxes.glsl leaves them.
// Out: taxel_jacobian (num_instances x 6 x num_taxels), N/m and N/rad, over the part of the spread's kernel that stays on the sensor where
//      SCALED.
// Shared memory: none.
// Reference: src/reference/tactile_jacobian.cpp.

#include "shared/features.h"
#include "passes/declare.glsl"
#include "passes/taxel_jacobian.h"

#include "common/instances.glsl"
#include "common/transform.glsl"
#include "common/patch_pose.glsl"

// Rows of a CellRecord.
const uint kLowX = 0u, kHighX = 1u, kLowY = 2u, kHighY = 3u;

vec4 cellRow(uint taxel, uint row) { return floatsOfFour(ContactCells, 4 * taxel + row); }

// Integrals along a side of a taxel next to this one; 0 for a taxel whose record was not written.
vec3 sideOf(bool is_there, uint taxel, uint row) {
  if (!is_there || cellRow(taxel, kHighY).w == 0.0) return vec3(0);
  return cellRow(taxel, row).xyz;
}

// Derivatives of a taxel's force by the object's twist in P: v, then w.
void taxelChange(uint first_taxel, uint in_sensor, uvec4 grid, out vec3 by_v, out vec3 by_w) {
  uint taxel = first_taxel + in_sensor;
  uvec2 at = uvec2((in_sensor - grid.z) / grid.y, (in_sensor - grid.z) % grid.y);
  vec4 low_x = vec4(0), high_x = vec4(0), low_y = vec4(0), high_y = cellRow(taxel, kHighY);
  if (high_y.w != 0.0) {
    low_x = cellRow(taxel, kLowX);
    high_x = cellRow(taxel, kHighX);
    low_y = cellRow(taxel, kLowY);
  } else {
    high_y = vec4(0);
  }
  vec3 slope = vec3(low_x.w, high_x.w, low_y.w);
  low_x.xyz += sideOf(at.x > 0, taxel - grid.y, kHighX);
  high_x.xyz += sideOf(at.x + 1 < grid.x, taxel + grid.y, kLowX);
  low_y.xyz += sideOf(at.y > 0, taxel - 1, kHighY);
  high_y.xyz += sideOf(at.y + 1 < grid.y, taxel + 1, kLowY);
  vec3 through_x = high_x.xyz - low_x.xyz, through_y = high_y.xyz - low_y.xyz;  // of f, G, f times the coordinate along the side
  by_v = vec3(-through_x.x, -through_y.x, -slope.x);
  by_w = vec3(-slope.z - through_y.y, slope.y + through_x.y, through_x.z - through_y.z);
}

void writeTaxel(uint instance, uint in_sensor) {
  uint patch_number = NUM_ROWS > 0 ? 0u : uint(taxels[in_sensor].readout.z);
  Affine X_PS = patchPose(patch_number);
  vec3 by_v, by_w;
  taxelChange(instance * NUM_TAXELS, in_sensor, patchRecord(patch_number).grid, by_v, by_w);
  // The sensor's v at the origin of P is v + w x p, so that force . (w x p) = w . (p x force).
  vec3 v = -toSensor(X_PS, by_v);
  vec3 w = -toSensor(X_PS, by_w) + cross(originInSensor(X_PS), v);
  float scale = SCALED ? spread_scale[in_sensor] : 1.0;
  for (uint k = 0; k < 3; ++k) {
    taxel_jacobian[(instance * 6 + k) * NUM_TAXELS + in_sensor] = scale * v[k];
    taxel_jacobian[(instance * 6 + 3 + k) * NUM_TAXELS + in_sensor] = scale * w[k];
  }
}

void main() {
  uint number = workgroupNumber() * WORKGROUP + gl_LocalInvocationIndex;
  uint instance = number / NUM_TAXELS;
  if (isProcessed(instance)) writeTaxel(instance, number - instance * NUM_TAXELS);
}
