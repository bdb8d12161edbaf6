// Forces of regions, and the selection of the largest. Forces are summed as integers, shares of the largest force in FORCE_STEPS steps, so
// that the order of additions does not matter. Reference: src/reference/contact_features.cpp.
// Shared memory: 12 bytes per team.

shared uint num_regions[kTeams];                     // regions of the team's instance
shared uint selected_sum[kTeams], selected[kTeams];  // sum plus 1, and name, of the region that is being selected

// Names every taxel's region, and sums the forces of a region at the taxel that names it.
void sumRegions(Instance instance, uint lane, float peak) {
  float steps = peak > 0.0 ? float(FORCE_STEPS) / peak : 0.0;
  for (uint t = lane; t < instance.end; t += TEAM) {
    if (!reports(taxel_regions[instance.first_word + t])) continue;
    uint region = findRoot(instance.first_word, t);
    taxel_regions[instance.first_word + t] = region;
    uint share = uint(forces[instance.first_word + t] * steps + 0.5);
    if (TEAM == 1) {
      region_sums[instance.first_word + region] += share;
    } else {
      atomicAdd(region_sums[instance.first_word + region], share);
    }
  }
}

// Writes the names of the REGIONS largest regions, by falling force, then by rising name. Returns the number of all regions.
uint selectRegions(Instance instance, uint lane, uint team) {
  uint count = 0;
  uint sum = 0xFFFFFFFFu, name = 0;  // sum plus 1, and name, of the region selected before
  for (uint r = 0; r < REGIONS; ++r) {
    uint best = 0, best_name = kNoRegion;
    if (sum > 0) {
      for (uint t = lane; t < instance.end; t += TEAM) {
        if (taxel_regions[instance.first_word + t] != t) continue;
        if (r == 0) ++count;
        uint other = region_sums[instance.first_word + t] + 1;
        bool is_left = other < sum || (other == sum && t > name);
        if (is_left && other > best) {
          best = other;
          best_name = t;
        }
      }
    }
    if (TEAM > 1) {
      if (lane == 0) {
        selected_sum[team] = 0;
        selected[team] = kNoRegion;
      }
      teamBarrier();
      atomicMax(selected_sum[team], best);
      teamBarrier();
      if (best > 0 && best == selected_sum[team]) atomicMin(selected[team], best_name);
      teamBarrier();
      best = selected_sum[team];
      best_name = selected[team];
      teamBarrier();
    }
    sum = best;
    name = best_name;
    if (lane == 0 && instance.end > 0) regions[instance.number * REGIONS + r] = name;
  }
  if (TEAM == 1) return count;
  atomicAdd(num_regions[team], count);
  teamBarrier();
  return num_regions[team];
}
