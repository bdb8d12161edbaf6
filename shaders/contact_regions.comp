#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
// Regions pass: which taxels that report are connected, and which of these regions are the largest. Runs before contact_features.comp.
//
// A workgroup has WORKGROUP / TEAM teams; each team processes REPEAT instances in sequence. An invocation owns every TEAM-th taxel of an
// instance.
// In:  image (num_instances x num_taxels), counts, or spread_normal, N, as feature_source says.
// Out: forces, N, and taxel_regions, shared/features.h (num_instances x num_taxels, features/taxel_words.glsl); regions (num_instances x
//      REGIONS), largest first, with kOnlyRegion; features: the number of all regions (num_instances). region_sums (as taxel_regions) is
//      scratch.
// Shared memory: 16 WORKGROUP / TEAM bytes.
// Deterministic: a region is named by its lowest taxel, whatever order taxels are united in; forces are summed as integers.
// Mutable globals: is_clean; any_unfinished_loop (driver/loops.glsl); the words of the rows (features/region_bits.glsl).
// Reference: src/reference/contact_features.cpp.

#include "shared/features.h"
#include "passes/declare.glsl"
#include "passes/contact_regions.h"

const uint kTeams = WORKGROUP / TEAM;
const bool kGrids = NUM_NEIGHBOURS == 0;

bool is_clean;  // whether features are those of the clean forces

// One instance, the same for all invocations of its team.
struct Instance {
  uint number;
  uint first_taxel;  // in image and spread_normal
  uint first_word;   // in forces, taxel_regions and region_sums
  uint end;          // taxels of the instance; 0 where there is nothing to do
};

#include "common/instances.glsl"
#include "driver/arithmetic.glsl"
#include "driver/loops.glsl"
#include "readout/readout.glsl"

// Barrier after which a team's writes to buffers and shared memory are visible to all of it.
void teamBarrier() {
  if (TEAM == 1) return;
  memoryBarrierBuffer();
  memoryBarrierShared();
  barrier();
}

#include "features/taxel_words.glsl"
#include "features/taxel_forces.glsl"
#include "features/regions.glsl"
#include "features/core_taxels.glsl"
#include "features/region_selection.glsl"
#include "features/region_bits.glsl"

// All teams execute the same barriers; a team without an instance of its own (`is_valid` false) writes nothing.
void findRegions(uint number, bool is_valid, uint num_instances) {
  uint lane = gl_LocalInvocationIndex % TEAM, team = gl_LocalInvocationIndex / TEAM;
  bool is_due = is_valid && hasNewValues(number, is_clean);
  Instance instance = Instance(number, number * NUM_TAXELS, 4u * kTaxelFours * number, is_due ? NUM_TAXELS : 0);
  if (kByBits) {
    bool is_stray;
    float peak = writeForcesByBits(instance, is_stray);
    findCoreByBits();
    if (REGIONS == 0) {
      writeCoreByBits(instance);
    } else {
      uint count = findRegionsByBits(instance, peak, is_stray);
      if (is_due) features[FIRST_COUNT * num_instances + number] = float(count);
    }
    return;
  }
  if (TEAM > 1 && lane == 0) peak_bits[team] = num_regions[team] = 0;
  teamBarrier();
  float peak = writeForces(instance, lane, team);
  if (REGIONS > 0) {
    for (uint t = lane; t < instance.end; t += TEAM) {
      if (reports(taxel_regions[instance.first_word + t])) uniteNeighbours(instance.first_word, t);
    }
    teamBarrier();
    sumRegions(instance, lane, peak);
    teamBarrier();
    uint count = selectRegions(instance, lane, team);
    if (lane == 0 && is_due) features[FIRST_COUNT * num_instances + number] = float(count);
  }
  markCore(instance, lane);
}

void main() {
  is_clean = feature_source != 0;
  uint num_instances = step_record.batch.x;
  uint number = workgroupNumber() * REPEAT * kTeams + gl_LocalInvocationIndex / TEAM;
  uint r = 0;
  for (; r < REPEAT; ++r, number += kTeams) {
    findRegions(min(number, num_instances - 1), number < num_instances, num_instances);
    teamBarrier();
  }
  checkLoop(r < REPEAT);
  reportUnfinishedLoops();
}
