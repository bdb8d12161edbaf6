// Threads that shall not hold up others.
#pragma once

namespace taxelsim {

// Lowers the calling thread's share of a busy processor, for good: what it does may wait, what the device or the controllers do may not. On
// software Vulkan, where the device is the processor, such a thread lives on what is left over between two kernels. Where the system
// refuses, nothing changes.
void goToBackground();

}  // namespace taxelsim
