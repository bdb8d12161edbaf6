// Ctrl-C as a wish, not an end.
#pragma once

#include <atomic>

namespace taxelsim::cli {

// From now on the first SIGINT or SIGTERM sets what is returned; the next one ends the process, as it would without us.
const std::atomic<bool>& stopOnSignals();

}  // namespace taxelsim::cli
