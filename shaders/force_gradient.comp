#version 460
#extension GL_GOOGLE_include_directive : require
// Gradient pass, at the caller's wish after a frame: pulls the gradient of a loss by the forces of taxels, gain x spread_normal, back to
// the six coordinates of the sensor's twist and to the gains. The transpose of the spread is applied to the gradient, once for all
// coordinates; its result weighs the contact forces' derivatives.
//
// TEAM invocations share an instance; a workgroup has WORKGROUP / TEAM teams, and each team processes REPEAT instances in sequence.
// In:  taxel_jacobian (num_instances x 6 x num_taxels), N/m and N/rad; spread_normal (num_instances x num_taxels), N; cotangents and
//      force_cotangents (num_instances x num_taxels), per N.
// Out: twist_gradient (num_instances x 6), per m and per rad; gain_gradient (num_instances x num_taxels).
// Shared memory: 4 PARTIALS bytes.
// Deterministic: sums run over LANES partial sums in a fixed order, whatever the size of team, workgroup and batch.
// Mutable globals: any_unfinished_loop (driver/loops.glsl), small_kernel (features/spread_change.glsl).
// Reference: taxelsim.vjp() (python/taxelsim/gradients.py) contracts the spread forces' derivatives in double precision.

#include "passes/declare.glsl"
#include "passes/force_gradient.h"

const uint kTeams = WORKGROUP / TEAM;

#include "driver/loops.glsl"
#include "features/spread_change.glsl"
#include "features/part_sums.glsl"
#include "features/team_sums.glsl"

// Whether receivers of taxels are known: on a grid, and in lists that equal their transposes.
const bool kPulls = NUM_ROWS > 0 || SYMMETRIC;

// Derivative of the loss by the force of taxel t before the spread; after it where receivers are not known. Per N.
float pulledThroughSpread(uint first_taxel, uint t) {
  if (!kPulls) return force_cotangents[first_taxel + t];
  float sum = 0.0;
  if (NUM_ROWS == 0) {
    for (uint e = 0; e < NUM_ENTRIES; ++e) {
      vec2 entry = spreadEntry(e, t);
      sum += entry.y * force_cotangents[first_taxel + floatBitsToUint(entry.x)];
    }
    return sum;
  }
  const int kRadius = int(KERNEL) / 2;
  ivec2 at = ivec2(t / NUM_COLS, t % NUM_COLS);
  for (int a = -kRadius; a <= kRadius; ++a) {
    for (int b = -kRadius; b <= kRadius; ++b) {
      uvec2 receiver = uvec2(at + ivec2(a, b));  // wraps to large numbers outside
      if (any(greaterThanEqual(receiver, uvec2(NUM_ROWS, NUM_COLS)))) continue;
      sum += kernelAt(a, b) * force_cotangents[first_taxel + receiver.x * NUM_COLS + receiver.y];
    }
  }
  return sum;
}

void addTaxel(uint instance, uint t, inout PartSums sums) {
  float weight = pulledThroughSpread(instance * NUM_TAXELS, t);
  for (uint k = 0; k < 6; ++k) {
    float change = kPulls ? floatOfFours(TaxelJacobian, (instance * 6 + k) * NUM_TAXELS + t) : spreadChange(instance, t, k);
    sums.s[k] += weight * change;
  }
}

// All teams execute the same barriers; a team without an instance of its own (`is_valid` false) writes nothing.
void computeInstance(uint instance, bool is_valid) {
  uint lane = gl_LocalInvocationIndex % TEAM, first_taxel = instance * NUM_TAXELS, end = is_valid ? NUM_TAXELS : 0;
  PartSums total = noSums();
  for (uint v = lane; v < LANES; v += TEAM) {
    PartSums sums = noSums();
    uint t = v;
    for (; t < end; t += LANES) {
      addTaxel(instance, t, sums);
      gain_gradient[first_taxel + t] = cotangents[first_taxel + t] * spread_normal[first_taxel + t];
    }
    checkLoop(t < end);
    addTeam(sums, v, total);
  }
  if (!is_valid || lane != 0) return;
  for (uint k = 0; k < 6; ++k) twist_gradient[6 * instance + k] = total.s[k];
}

void main() {
  uint num_instances = step_record.batch.x;
  loadKernel();
  uint number = workgroupNumber() * REPEAT * kTeams + gl_LocalInvocationIndex / TEAM;
  uint r = 0;
  for (; r < REPEAT; ++r, number += kTeams) computeInstance(min(number, num_instances - 1), number < num_instances);
  checkLoop(r < REPEAT);
  reportUnfinishedLoops();
}
