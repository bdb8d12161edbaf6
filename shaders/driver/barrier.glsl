// Where the invocations of a workgroup wait for each other. Included before anything but driver/pairs.glsl, for its extension.
//
// With LOCKSTEP, for workgroups that are one vector of a software driver, whose lanes go step by step together, there is nothing to wait for; the barriers
// that are left only keep a compiler from remembering what was in memory before. Compiled apart: SwiftShader takes minutes over a constant in its place.

// All are here, and what they wrote to shared memory is there for all; the second: and what they wrote to buffers.
#ifdef LOCKSTEP
#extension GL_KHR_shader_subgroup_basic : require
void workgroupBarrier() { subgroupMemoryBarrierShared(); }
void workgroupBarrierWithBuffers() { subgroupMemoryBarrier(); }
#else
void workgroupBarrier() { barrier(); }
void workgroupBarrierWithBuffers() {
  memoryBarrierBuffer();
  memoryBarrierShared();
  barrier();
}
#endif
