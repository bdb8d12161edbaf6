// Forces of an image's taxels (N): the clean ones, or those of the counts by the nominal curve (readout/readout.glsl); and the largest of them.
// Shared memory: 4 bytes per team.

shared uint peak_bits[kTeams];  // largest force of the team's instance, as bits; 0 at the start

bool reports(uint word) { return (word & kNoRegion) != kNoRegion; }

// Force of a taxel, N. Sets its word in taxel_regions: itself, or kNoRegion where it does not report.
float forceOf(uint first_taxel, uint t) {
  if (CLEAN) {
    float force = spread_normal[first_taxel + t];
    taxel_regions[first_taxel + t] = force > max(taxels[t].readout.y, 0.0) ? t : kNoRegion;
    return force;
  }
  uint counts = image[first_taxel + t];
  taxel_regions[first_taxel + t] = counts > 0 ? t : kNoRegion;
  return nominalForce(counts);
}

// Writes the forces of all taxels; returns the largest force of those that report.
float writeForces(Instance instance, uint lane, uint team) {
  float peak = 0.0;
  for (uint t = lane; t < instance.end; t += TEAM) {
    float force = forceOf(instance.first_taxel, t);
    forces[instance.first_taxel + t] = force;
    if (reports(taxel_regions[instance.first_taxel + t])) peak = max(peak, force);
    if (REGIONS > 0) region_sums[instance.first_taxel + t] = 0;
  }
  if (TEAM > 1) {
    atomicMax(peak_bits[team], floatBitsToUint(peak));
    teamBarrier();
    peak = uintBitsToFloat(peak_bits[team]);
  }
  return peak;
}
