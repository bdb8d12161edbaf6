// Threads of Mesa's software Vulkan driver.
#pragma once

namespace taxelsim::cli {

// Lets Mesa's software driver start two threads per core: sets LP_NUM_THREADS unless the environment already does. For commands whose host
// threads work while frames are computed; with one driver thread per core, a core that the host occupies would delay every dispatch. No
// value of a frame depends on it. Changes the environment of the process, so only a program may call it, and only before it opens a device
// or starts a thread.
void useTwoDriverThreadsPerCore();

}  // namespace taxelsim::cli
