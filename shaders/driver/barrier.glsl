// Barriers of a workgroup. Included before anything else, because of its extension.
//
// With ONE_VECTOR a workgroup is one vector of a software driver, whose lanes run in lockstep and need not wait; the remaining memory
// barriers only keep the compiler from reusing old values. ONE_VECTOR is a macro: SwiftShader takes minutes to compile a specialization
// constant in its place.

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
