// Threads of Mesa's software Vulkan driver.
#pragma once

namespace taxelsim::cli {

// Sets LP_NUM_THREADS for this process and those that it starts, unless the user has set it: the threads of Mesa's software driver in each
// of `num_processes` that run at once. They divide the usable processors; the driver itself knows no quota of a control group.
//
// Results do not depend on it. Changes the environment of the process: call it only in a program without other threads, before opening a
// device.
void setDriverThreads(int num_processes);

}  // namespace taxelsim::cli
