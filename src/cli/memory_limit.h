// Crashes of drivers and libraries that do not check their allocations, under a limit of the address space (ulimit -v).
#pragma once

namespace taxelsim::cli {

// If the address space is limited, a crash from now on prints one line that names the limit and exits with kExitDevice. Without a limit,
// crashes stay signals, for debuggers and core dumps.
void explainCrashesUnderMemoryLimit();

}  // namespace taxelsim::cli
