#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
// Tactile Jacobian pass, last step: differentiates total force, centre of pressure and edge angle of the sensor and its patches by the six
// coordinates of the sensor's twist. Runs after the image pass; of clean forces, or of what the readout makes of them before noise.
//
// TEAM invocations share a part (one row of an instance); a workgroup has WORKGROUP / TEAM teams, and each team processes REPEAT parts in
// sequence. Parts of the same kind of all instances are consecutive.
// In:  spread_normal (num_instances x num_taxels), N; taxel_jacobian (num_instances x 6 x num_taxels); wrench_jacobian (num_instances x
//      num_tiles x 6 x 6).
// Out: features (block after block, each num_instances x num_rows x components x 6, then the wrench's, shared/features.h).
// Shared memory: 4 PARTIALS bytes.
// Deterministic: sums run over LANES partial sums in a fixed order, whatever the size of team and workgroup.
// Mutable globals: any_unfinished_loop (driver/loops.glsl), small_kernel (features/spread_change.glsl).
// Reference: src/reference/feature_jacobian.cpp.

#include "shared/features.h"
#include "shared/random.h"
#include "passes/declare.glsl"
#include "passes/tactile_jacobian.h"
const float BIAS = 0.0;  // for readout/imperfections.glsl; offsets do not enter the derivatives

const uint kTeams = WORKGROUP / TEAM;

#include "driver/arithmetic.glsl"
#include "common/instances.glsl"
#include "common/philox.glsl"
#include "driver/loops.glsl"
#include "readout/imperfections.glsl"
#include "features/axes.glsl"
#include "features/jacobian_parts.glsl"
#include "features/spread_change.glsl"
#include "features/part_sums.glsl"
#include "features/team_sums.glsl"
#include "features/jacobian_sums.glsl"

// All teams execute the same barriers; a team without a part of its own (`is_valid` false) writes nothing.
void computePart(uint number, bool is_valid, uint num_instances) {
  const float kMinForce = 1e-20;  // N; smaller forces are no contact, so that quotients stay finite
  uint instance = number % num_instances, which = number / num_instances;
  bool is_due = is_valid && hasNewValues(instance, CLEAN);
  bool writes = is_due && gl_LocalInvocationIndex % TEAM == 0;
  Part part = loadPart(instance, which, is_due);
  PlaneRecord plane = planeRecord(part.plane);
  PartSums first = sumPart(kSumsFirst, part, vec3(0), 0);
  float force = first.s[0];
  bool touches = force > kMinForce;
  vec3 center = vec3(0), second = vec3(0);
  if (touches) center = vec3(first.s[1], first.s[2], first.s[3]) / force;
  PartSums about = sumPart(kSumsSecond, part, center, 0);
  if (touches) second = vec3(about.s[0], about.s[1], about.s[2]) / force;
  Axes axes = axesOf(second);
  uint num_rows = num_instances * kRows;
  uint row = instance * kRows + which;
  Changes changes = sumChanges(part, center);
  for (uint k = 0; k < 6; ++k) {
    Change change = noChange();
    if (touches) change = changeOf(changes.by[k], force, second, axes);
    if (writes) {
      writeChange(row, num_rows, k, plane, change);
      if (kOnePatch) writeChange(row + 1, num_rows, k, plane, change);
    }
    if (!CLEAN) continue;
    // Only the sensor has a wrench.
    PartSums wrench = sumPart(kSumsWrench, part, vec3(0), k);
    uint first_wrench = kNumJacobian * num_rows + kNumWrenchJacobian * instance + k;
    for (uint c = 0; c < 6; ++c) {
      if (writes && which == 0) features[first_wrench + 6 * c] = wrench.s[c];
    }
  }
}

void main() {
  uint num_instances = step_record.batch.x;
  uint num_parts = num_instances * kParts;
  loadKernel();
  uint number = workgroupNumber() * REPEAT * kTeams + gl_LocalInvocationIndex / TEAM;
  uint r = 0;
  for (; r < REPEAT; ++r, number += kTeams) computePart(min(number, num_parts - 1), number < num_parts, num_instances);
  checkLoop(r < REPEAT);
  reportUnfinishedLoops();
}
