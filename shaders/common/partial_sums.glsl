// Reduction over LANES partial sums in a fixed order, so that a sum does not depend on the size of the workgroup. Shared memory: 16 LANES
// bytes.
// Included after driver/vector_sums.glsl. Mutable globals: own_partial.

shared vec4 partial[LANES];

// Whether an invocation keeps its partial sum in a register instead of partial[].
const bool kInRegisters = IN_VECTOR && WORKGROUP == LANES;
vec4 own_partial = vec4(0);

void setPartial(uint v, vec4 sums) {
  if (kInRegisters) {
    own_partial = sums;
  } else {
    partial[v] = sums;
  }
}

// Sum of all partial sums in a fixed order; every invocation gets it.
vec4 sumOfPartials() {
  workgroupBarrier();
  if (kInRegisters) return sumOverVector(own_partial);
  vec4 total = vec4(0);
  for (uint v = 0; v < LANES; ++v) total += partial[v];
  workgroupBarrier();
  return total;
}
