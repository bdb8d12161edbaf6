// Work of all invocations of a workgroup together: barriers, reductions, lists.
//
// With ONE_VECTOR a workgroup is one vector of a software driver, whose lanes run in lockstep and need not wait; the remaining memory
// barriers only keep the compiler from reusing old values. ONE_VECTOR is a macro: SwiftShader takes minutes to compile a specialization
// constant in its place. A subgroup's sum visits the lanes once and in their order on lavapipe, as the loop over shared memory does that
// other workgroups run: both give the same bits. A ballot counts, because atomic operations are loops over the lanes.
// Shared memory: 16 LANES bytes.
// Mutable globals: own_partial.
#ifndef DRIVER_WORKGROUP_GLSL
#define DRIVER_WORKGROUP_GLSL
// After the barrier, all writes of the workgroup to shared memory are visible to all of it; after the second one, its writes to buffers as
// well.
#ifdef ONE_VECTOR
#extension GL_KHR_shader_subgroup_basic : require
void workgroupBarrier() { subgroupMemoryBarrierShared(); }
void workgroupBarrierWithBuffers() { subgroupMemoryBarrier(); }
#else
void workgroupBarrier() { barrier(); }
void workgroupBarrierWithBuffers() {
  memoryBarrierBuffer();
#ifdef TEXEL_BUFFERS
  memoryBarrierImage();  // driver/texels.glsl
#endif
  memoryBarrierShared();
  barrier();
}
#endif

// ---- reductions over a workgroup that is one vector; not called without IN_VECTOR ----

#ifdef ONE_VECTOR
#extension GL_KHR_shader_subgroup_arithmetic : require
#extension GL_KHR_shader_subgroup_ballot : require
const bool IN_VECTOR = true;
vec4 sumOverVector(vec4 v) { return subgroupAdd(v); }
vec2 sumOverVector(vec2 v) { return subgroupAdd(v); }
float largestOverVector(float v) { return subgroupMax(v); }
uint largestOverVector(uint v) { return subgroupMax(v); }
ivec4 leastOverVector(ivec4 v) { return subgroupMin(v); }
// Index of the entry that this invocation appends to a list; `length`, a global of kind LIST_LENGTH, grows. All invocations call it.
uint appended(inout uint length, bool adds) {
  uint adding = subgroupBallot(adds).x, index = length + uint(bitCount(adding & ((1u << gl_LocalInvocationIndex) - 1u)));
  length += uint(bitCount(adding));
  return index;
}
#define LIST_LENGTH
#else
const bool IN_VECTOR = false;
vec4 sumOverVector(vec4 v) { return v; }
vec2 sumOverVector(vec2 v) { return v; }
float largestOverVector(float v) { return v; }
uint largestOverVector(uint v) { return v; }
ivec4 leastOverVector(ivec4 v) { return v; }
#define appended(length, adds) ((adds) ? atomicAdd(length, 1u) : 0u)
#define LIST_LENGTH shared
#endif

// ---- reduction over LANES partial sums in a fixed order, so that a sum does not depend on the size of the workgroup ----

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
#endif
