// Adds the partial sums of the lanes of a team, features/part_sums.glsl, in a fixed order. LANES is a multiple of TEAM.

// Adds the sums of lane `v` and of those of the rest of the team, in their order; every invocation of the team gets the total.
void addTeam(PartSums sums, uint v, inout PartSums total) {
  if (TEAM == 1) {
    for (uint s = 0; s < kMostSums; ++s) total.s[s] += sums.s[s];
    return;
  }
  uint lane = gl_LocalInvocationIndex % TEAM;
  uint first_partial = gl_LocalInvocationIndex / TEAM * kMostSums * TEAM;
  for (uint s = 0; s < kMostSums; ++s) partial[first_partial + s * TEAM + lane] = sums.s[s];
  barrier();
  for (uint n = 0; n < TEAM; ++n) {
    for (uint s = 0; s < kMostSums; ++s) total.s[s] += partial[first_partial + s * TEAM + n];
  }
  barrier();
}
