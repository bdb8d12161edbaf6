// Reduction over LANES partial sums in a fixed order, so that a sum does not depend on the size of the workgroup. Shared memory: 16 LANES bytes.

shared vec4 partial[LANES];

// Sum of partial[] in a fixed order; every invocation gets it.
vec4 sumOfPartials() {
  workgroupBarrier();
  vec4 total = vec4(0);
  for (uint v = 0; v < LANES; ++v) total += partial[v];
  workgroupBarrier();
  return total;
}
