// Where the invocations of a workgroup wait for each other. Included before anything but lib/pairs.glsl, for its extension.
#extension GL_KHR_shader_subgroup_basic : require
#include "lib/specialization.glsl"

// In lockstep there is nothing to wait for; the barriers that are left only keep a compiler from remembering what was in memory before.

// All are here, and what they wrote to shared memory is there for all.
void workgroupBarrier() {
  if (LOCKSTEP) {
    subgroupMemoryBarrierShared();
  } else {
    barrier();
  }
}

// The same of buffers, too.
void workgroupBarrierWithBuffers() {
  if (LOCKSTEP) {
    subgroupMemoryBarrier();
  } else {
    memoryBarrierBuffer();
    memoryBarrierShared();
    barrier();
  }
}
