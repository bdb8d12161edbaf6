// Forces of an image's taxels (N): the clean ones, or those of the counts by the nominal curve (readout/readout.glsl); and the largest of
// them.
// Shared memory: 4 bytes per team.

shared uint peak_bits[kTeams];  // largest force of the team's instance, as bits; 0 at the start

bool reports(uint word) { return (word & kNoRegion) != kNoRegion; }

struct Measured {
  float force;  // N
  bool reports, saturated;
};

Measured measuredAt(Instance instance, uint t) {
  uint word = wordOfFours(Image, instance.first_taxel + t);
  if (is_clean) {
    float force = uintBitsToFloat(word);
    return Measured(force, force > max(taxels[t].readout.y, 0.0), false);
  }
  return Measured(nominalForce(word), word > 0, float(word) >= SATURATION);
}

// Writes the forces of all taxels, and the words in taxel_regions: itself, or kNoRegion where one does not report. Returns the largest
// force of those that do.
float writeForces(Instance instance, uint lane, uint team) {
  float peak = 0.0;
  for (uint t = lane; t < instance.end; t += TEAM) {
    Measured measured = measuredAt(instance, t);
    forces[instance.first_word + t] = measured.force;
    taxel_regions[instance.first_word + t] = measured.reports ? t : kNoRegion;
    if (measured.reports) peak = max(peak, measured.force);
    if (REGIONS > 0) region_sums[instance.first_word + t] = 0;
  }
  if (TEAM > 1) {
    atomicMax(peak_bits[team], floatBitsToUint(peak));
    teamBarrier();
    peak = uintBitsToFloat(peak_bits[team]);
  }
  return peak;
}
