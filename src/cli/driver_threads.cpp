#include "cli/driver_threads.h"

#include <cstdlib>
#include <string>

#include "base/processors.h"

namespace taxelsim::cli {

void setDriverThreads(int num_processes) {
  static const bool is_given = std::getenv("LP_NUM_THREADS") != nullptr;
  if (is_given) return;
  const int num_processors = usableProcessors() / num_processes;
  const int num_threads = num_processes > 1 && num_processors <= 1 ? 1 : 2 * num_processors;
  ::setenv("LP_NUM_THREADS", std::to_string(num_threads).c_str(), 1);
}

}  // namespace taxelsim::cli
