#include "cli/driver_threads.h"

#include <algorithm>
#include <cstdlib>
#include <string>

#include "base/processors.h"

namespace taxelsim::cli {

void setDriverThreads(int num_processes) {
  static const bool is_given = std::getenv("LP_NUM_THREADS") != nullptr;
  if (is_given) return;
  const int num_threads = std::max(1, usableProcessors() / num_processes);
  ::setenv("LP_NUM_THREADS", std::to_string(num_threads).c_str(), 1);
}

}  // namespace taxelsim::cli
