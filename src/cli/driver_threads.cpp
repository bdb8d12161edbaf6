#include "cli/driver_threads.h"

#include <algorithm>
#include <cstdlib>
#include <string>
#include <thread>

namespace taxelsim::cli {

void useTwoDriverThreadsPerCore() {
  const unsigned num_threads = 2 * std::max(std::thread::hardware_concurrency(), 1u);
  ::setenv("LP_NUM_THREADS", std::to_string(num_threads).c_str(), 0);
}

}  // namespace taxelsim::cli
