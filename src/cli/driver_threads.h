// Threads of Mesa's software Vulkan driver.
#pragma once

namespace taxelsim::cli {

// Sets LP_NUM_THREADS for this process and those that it starts, unless the user has set it: the threads of Mesa's software driver in each
// of `num_processes` that run at once.
//
// One process gets two threads per usable processor, for commands whose host threads work while frames are computed: with one thread per
// processor, a processor that the host occupies would delay every dispatch. Several processes divide them; a process with one processor
// gets one thread, since the others use the processor while the host works.
//
// Results do not depend on it. Changes the environment of the process: call it only in a program without other threads, before opening a
// device.
void setDriverThreads(int num_processes);

}  // namespace taxelsim::cli
