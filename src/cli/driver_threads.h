// Threads of Mesa's software Vulkan driver.
#pragma once

namespace taxelsim::cli {

// Makes Mesa's software driver start two threads per core: sets LP_NUM_THREADS unless it is set already. For commands whose host threads
// work while frames are computed: with one driver thread per core, a core that the host occupies would delay every dispatch. Results do not
// depend on it. Changes the environment of the process: call it only in a program, before opening a device or starting a thread.
void useTwoDriverThreadsPerCore();

}  // namespace taxelsim::cli
