#version 460
#extension GL_GOOGLE_include_directive : require
// Regions of an image: which taxels that report are connected, and which regions are the largest. Before contact_features.comp.
//
// TEAM invocations share an instance, an invocation owns every TEAM-th taxel; a workgroup has WORKGROUP / TEAM teams, and each does REPEAT instances one
// after another.
// In:  image (num_instances x num_taxels), counts; where CLEAN spread_normal alike, N.
// Out: forces (num_instances x num_taxels), N; taxel_regions alike, shared/features.h; regions (num_instances x REGIONS), largest first; the number of all regions
//      (features, num_instances). region_sums (num_instances x num_taxels) is scratch.
// Shared memory: 16 WORKGROUP / TEAM bytes.
// Deterministic: a region is named by its lowest taxel, whichever order taxels are united in; forces are summed as integers.
// Twin: src/reference/contact_features.cpp.

#include "shared/batch.h"
#include "shared/features.h"
#include "shared/sensor.h"
#include "passes/declare.glsl"
#include "passes/contact_regions.h"

const uint kTeams = WORKGROUP / TEAM;
const bool kGrids = NUM_NEIGHBOURS == 0;

// Of each team: the largest force (as bits), how many regions, the sum (plus 1) and the name of the region that is picked.
shared uint peak_bits[kTeams], num_regions[kTeams], picked_sum[kTeams], picked[kTeams];

// A loop ended before its work was done; see contact.comp.
bool cut_short = false;

#include "common/workgroup.glsl"
#include "common/whole.glsl"
#include "readout/readout.glsl"

// What a team has written is there for all of it.
void together() {
  if (TEAM == 1) return;
  memoryBarrierBuffer();
  memoryBarrierShared();
  barrier();
}

// One instance, as its team sees it.
struct Instance {
  uint number, first_taxel;
  uint end;  // of its taxels: 0 where there is nothing to do
};

bool reports(uint word) { return (word & kNoRegion) != kNoRegion; }

// The taxel that names the region of taxel `t`, as far as taxels are united; every one on the way is moved to the one after the next.
uint regionOf(uint first_taxel, uint t) {
  uint next = taxel_regions[first_taxel + t];
  while (next != t) {
    uint after = taxel_regions[first_taxel + next];
    taxel_regions[first_taxel + t] = after;
    t = next;
    next = after;
  }
  cut_short = cut_short || next != t;
  return t;
}

// The higher of two names gives way to the lower one. Where another invocation was faster, what it has put there is still to be united with the lower one.
void unite(uint first_taxel, uint a, uint b) {
  bool done = false;
  while (!done) {
    a = regionOf(first_taxel, a);
    b = regionOf(first_taxel, b);
    uint high = max(a, b);
    b = min(a, b);
    if (high == b) {
      done = true;
    } else if (TEAM == 1) {
      taxel_regions[first_taxel + high] = b;
      done = true;
    } else {
      a = atomicMin(taxel_regions[first_taxel + high], b);
      done = a == high;
    }
  }
  cut_short = cut_short || !done;
}

// Patch of a taxel, and its row and column there.
struct Place {
  uvec4 grid;  // of the patch
  uvec2 at;
};

Place placeOf(uint t) {
  uvec4 grid = planes[ONE_PATCH ? 0 : uint(taxels[t].readout.z)].grid;
  uint cols = ONE_PATCH && NUM_ROWS > 0 ? NUM_COLS : grid.y;
  return Place(grid, uvec2((t - grid.z) / cols, (t - grid.z) % cols));
}

bool reportsAt(uint first_taxel, uint t) { return reports(taxel_regions[first_taxel + t]); }

// A taxel with those of its neighbours that have lower numbers.
void uniteNeighbours(uint first_taxel, uint t) {
  for (uint e = 0; e < NUM_NEIGHBOURS; ++e) {
    uint other = neighbours[e * NUM_TAXELS + t];
    if (reportsAt(first_taxel, other)) unite(first_taxel, t, other);
  }
  if (!kGrids) return;
  // The one before it in its row and the two beside the one above are connected with that, so that two neighbours at most are left.
  Place place = placeOf(t);
  uint before = t, after = t, above = t - place.grid.y;
  bool has_left = place.at.y > 0, has_row = place.at.x > 0;
  if (has_row && has_left && reportsAt(first_taxel, above - 1)) before = above - 1;
  if (has_left && reportsAt(first_taxel, t - 1)) before = t - 1;
  if (has_row && place.at.y + 1 < place.grid.y && reportsAt(first_taxel, above + 1)) after = above + 1;
  if (has_row && reportsAt(first_taxel, above)) {
    before = above;
    after = t;
  }
  if (before != t) unite(first_taxel, t, before);
  if (after != t) unite(first_taxel, t, after);
}

// Whether a taxel lies so far inside what touches that the spread brings it as much as it takes away, along its row, and then in all: all taxels of its
// patch around it report, and it is not on the border, where what touches may end anywhere.
bool isCoreInRow(uint first_taxel, uint t) {
  Place place = placeOf(t);
  uint row = place.grid.z + place.at.x * place.grid.y;
  uint last = min(place.at.y + place.grid.w, place.grid.y - 1);
  bool core = place.at.y > 0 && place.at.y + 1 < place.grid.y;
  for (uint j = place.at.y - min(place.at.y, place.grid.w); j <= last && core; ++j) core = reportsAt(first_taxel, row + j);
  return core;
}

bool isCore(uint first_taxel, uint t) {
  Place place = placeOf(t);
  uint column = place.grid.z + place.at.y;
  uint last = min(place.at.x + place.grid.w, place.grid.x - 1);
  bool core = place.at.x > 0 && place.at.x + 1 < place.grid.x;
  for (uint i = place.at.x - min(place.at.x, place.grid.w); i <= last && core; ++i) {
    core = (taxel_regions[first_taxel + column + i * place.grid.y] & kCoreInRow) != 0;
  }
  return core;
}

// Force of a taxel; its word says whether it reports.
float forceOf(uint first_taxel, uint t) {
  if (CLEAN) {
    float force = spread_normal[first_taxel + t];
    taxel_regions[first_taxel + t] = force > taxels[t].readout.y ? t : kNoRegion;
    return force;
  }
  uint counts = image[first_taxel + t];
  taxel_regions[first_taxel + t] = counts > 0 ? t : kNoRegion;
  return nominalForce(counts);
}

// Names of regions at their final value, and sums of forces at the taxels that name them.
void sumRegions(Instance of, uint lane, float peak) {
  float steps = peak > 0.0 ? float(FORCE_STEPS) / peak : 0.0;
  for (uint t = lane; t < of.end; t += TEAM) {
    if (!reports(taxel_regions[of.first_taxel + t])) continue;
    uint region = regionOf(of.first_taxel, t);
    taxel_regions[of.first_taxel + t] = region;
    uint share = uint(forces[of.first_taxel + t] * steps + 0.5);
    if (TEAM == 1) {
      region_sums[of.first_taxel + region] += share;
    } else {
      atomicAdd(region_sums[of.first_taxel + region], share);
    }
  }
}

// Names the largest regions, one after another; of two with the same force the one with the lower name first. How many there are in all.
uint pickRegions(Instance of, uint lane, uint team) {
  uint count = 0;
  uint sum = 0xFFFFFFFFu, name = 0;  // of the region picked before, the sum plus 1
  for (uint r = 0; r < REGIONS; ++r) {
    uint best = 0, best_name = kNoRegion;
    if (sum > 0) {
      for (uint t = lane; t < of.end; t += TEAM) {
        if (taxel_regions[of.first_taxel + t] != t) continue;
        if (r == 0) ++count;
        uint other = region_sums[of.first_taxel + t] + 1;
        bool is_left = other < sum || (other == sum && t > name);
        if (is_left && other > best) {
          best = other;
          best_name = t;
        }
      }
    }
    if (TEAM > 1) {
      if (lane == 0) {
        picked_sum[team] = 0;
        picked[team] = kNoRegion;
      }
      together();
      atomicMax(picked_sum[team], best);
      together();
      if (best > 0 && best == picked_sum[team]) atomicMin(picked[team], best_name);
      together();
      best = picked_sum[team];
      best_name = picked[team];
      together();
    }
    sum = best;
    name = best_name;
    if (lane == 0 && of.end > 0) regions[of.number * REGIONS + r] = name;
  }
  if (TEAM == 1) return count;
  atomicAdd(num_regions[team], count);
  together();
  return num_regions[team];
}

// Every team goes the same way through the barriers; one without an instance of its own (`is_there` false) does and writes nothing. Between the sensor's
// own frames measured values stay.
void regionsOf(uint number, bool is_there, uint num_instances) {
  uint lane = gl_LocalInvocationIndex % TEAM, team = gl_LocalInvocationIndex / TEAM;
  bool is_due = is_there && (CLEAN || (instances[number].keys.w & kFlagNewFrame) != 0);
  Instance of = Instance(number, number * NUM_TAXELS, is_due ? NUM_TAXELS : 0);
  if (TEAM > 1 && lane == 0) peak_bits[team] = num_regions[team] = 0;
  together();
  float peak = 0.0;
  for (uint t = lane; t < of.end; t += TEAM) {
    float force = forceOf(of.first_taxel, t);
    forces[of.first_taxel + t] = force;
    if (reports(taxel_regions[of.first_taxel + t])) peak = max(peak, force);
    if (REGIONS > 0) region_sums[of.first_taxel + t] = 0;
  }
  if (TEAM > 1) {
    atomicMax(peak_bits[team], floatBitsToUint(peak));
    together();
    peak = uintBitsToFloat(peak_bits[team]);
  }
  if (REGIONS > 0) {
    for (uint t = lane; t < of.end; t += TEAM) {
      if (reports(taxel_regions[of.first_taxel + t])) uniteNeighbours(of.first_taxel, t);
    }
    together();
    sumRegions(of, lane, peak);
    together();
    uint count = pickRegions(of, lane, team);
    if (lane == 0 && is_due) features[FIRST_COUNT * num_instances + number] = float(count);
  }
  uint t = lane;
  if (kGrids) {
    for (; t < of.end; t += TEAM) {
      uint word = taxel_regions[of.first_taxel + t];
      if (reports(word) && isCoreInRow(of.first_taxel, t)) taxel_regions[of.first_taxel + t] = word | kCoreInRow;
    }
    together();
    for (t = lane; t < of.end; t += TEAM) {
      uint word = taxel_regions[of.first_taxel + t];
      bool in_range = CLEAN || float(image[of.first_taxel + t]) < SATURATION;
      if (in_range && isCore(of.first_taxel, t)) taxel_regions[of.first_taxel + t] = word | kCoreTaxel;
    }
  }
  cut_short = cut_short || (kGrids && t < of.end);
}

void main() {
  uint num_instances = step_record.batch.x;
  uint number = workgroupNumber() * REPEAT * kTeams + gl_LocalInvocationIndex / TEAM;
  uint r = 0;
  for (; r < REPEAT; ++r, number += kTeams) {
    regionsOf(min(number, num_instances - 1), number < num_instances, num_instances);
    together();
  }
  if (cut_short || r < REPEAT) problems[0] = 1;
}
