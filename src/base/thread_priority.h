// Scheduling priority of threads.
#pragma once

namespace taxelsim {

// Raises the calling thread's nice value by 10 (at most 19), permanently. For threads that compress or write data: with a software Vulkan
// driver they share the processor with the driver's own threads, and pre-empting one of those delays all that wait for it at a barrier.
// Does nothing where the system refuses.
void lowerThreadPriority();

}  // namespace taxelsim
