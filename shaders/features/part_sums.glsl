// Sums over the taxels of a part: one array of values per invocation, and the partial sums of a team in shared memory.
// Shared memory: 4 PARTIALS bytes, PARTIALS = kMostSums LANES per team of more than one invocation.

shared float partial[PARTIALS];

struct PartSums {
  float s[kMostSums];
};

PartSums noSums() {
  PartSums sums;
  for (uint k = 0; k < kMostSums; ++k) sums.s[k] = 0.0;
  return sums;
}
