// Threads that shall not hold up others.
#pragma once

namespace taxelsim {

// Lowers the calling thread's share of a busy processor, for good: what it does may wait. On software Vulkan, where the device is the
// processor, such a thread does not displace the driver's, one of which may hold what all others wait for, and lives on what is left over
// between two kernels. Where the system refuses, nothing changes.
void goToBackground();

}  // namespace taxelsim
