// Graceful shutdown on SIGINT and SIGTERM.
#pragma once

#include <atomic>

namespace taxelsim::cli {

// Installs handlers: the first SIGINT or SIGTERM sets the returned flag, the second one ends the process.
const std::atomic<bool>& stopOnSignals();

}  // namespace taxelsim::cli
