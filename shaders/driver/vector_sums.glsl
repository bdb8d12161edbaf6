// Reductions over a workgroup that is one vector of a software driver. IN_VECTOR is false without LOCKSTEP (driver/barrier.glsl).
//
// A subgroup's sum visits the lanes once and in their order on lavapipe, as the loop over shared memory does that other workgroups run: both give the same bits.
// Included after driver/barrier.glsl.
#ifdef LOCKSTEP
#extension GL_KHR_shader_subgroup_arithmetic : require
const bool IN_VECTOR = true;
vec4 sumOverVector(vec4 v) { return subgroupAdd(v); }
vec2 sumOverVector(vec2 v) { return subgroupAdd(v); }
float largestOverVector(float v) { return subgroupMax(v); }
uint largestOverVector(uint v) { return subgroupMax(v); }
ivec4 leastOverVector(ivec4 v) { return subgroupMin(v); }
#else
const bool IN_VECTOR = false;
vec4 sumOverVector(vec4 v) { return v; }
vec2 sumOverVector(vec2 v) { return v; }
float largestOverVector(float v) { return v; }
uint largestOverVector(uint v) { return v; }
ivec4 leastOverVector(ivec4 v) { return v; }
#endif
