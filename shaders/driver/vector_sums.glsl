// Reductions over a workgroup that is one vector of a software driver, and its lists. IN_VECTOR is false without ONE_VECTOR
// (driver/barrier.glsl).
//
// placeIn() is the next free place for an invocation that adds to the list; `length`, a global of kind LIST_LENGTH, grows. All invocations
// of the workgroup call it. In a vector every lane keeps the length, and a ballot counts: atomic operations are loops over the lanes.
//
// A subgroup's sum visits the lanes once and in their order on lavapipe, as the loop over shared memory does that other workgroups run:
// both give the same bits.
// Included after driver/barrier.glsl.
#ifdef ONE_VECTOR
#extension GL_KHR_shader_subgroup_arithmetic : require
#extension GL_KHR_shader_subgroup_ballot : require
const bool IN_VECTOR = true;
vec4 sumOverVector(vec4 v) { return subgroupAdd(v); }
vec2 sumOverVector(vec2 v) { return subgroupAdd(v); }
float largestOverVector(float v) { return subgroupMax(v); }
uint largestOverVector(uint v) { return subgroupMax(v); }
ivec4 leastOverVector(ivec4 v) { return subgroupMin(v); }
uint placeIn(inout uint length, bool adds) {
  uint adding = subgroupBallot(adds).x, place = length + uint(bitCount(adding & ((1u << gl_LocalInvocationIndex) - 1u)));
  length += uint(bitCount(adding));
  return place;
}
#define LIST_LENGTH
#else
const bool IN_VECTOR = false;
vec4 sumOverVector(vec4 v) { return v; }
vec2 sumOverVector(vec2 v) { return v; }
float largestOverVector(float v) { return v; }
uint largestOverVector(uint v) { return v; }
ivec4 leastOverVector(ivec4 v) { return v; }
#define placeIn(length, adds) ((adds) ? atomicAdd(length, 1u) : 0u)
#define LIST_LENGTH shared
#endif
