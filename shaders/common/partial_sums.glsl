// Reduction over the lanes of a workgroup in a fixed order, so that sums do not depend on the workgroup's size. Needs `shared vec4 partial[LANES]`.

// Total of partial[] in a fixed order; every invocation gets it.
vec4 sumOfPartials() {
  workgroupBarrier();
  vec4 total = vec4(0);
  for (uint v = 0; v < LANES; ++v) total += partial[v];
  workgroupBarrier();
  return total;
}
