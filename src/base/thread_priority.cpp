#include "base/thread_priority.h"

#include <sys/resource.h>

#include <algorithm>
#include <cerrno>

namespace taxelsim {
namespace {

// Linux's scheduler gives such a thread a ninth of the share of a thread at nice 0, so that it still advances on a busy processor.
constexpr int kNiceIncrement = 10;
constexpr int kMaxNice = 19;

}  // namespace

void lowerThreadPriority() {
  // On Linux, PRIO_PROCESS with id 0 addresses the calling thread, not the process.
  errno = 0;
  const int nice = ::getpriority(PRIO_PROCESS, 0);
  if (nice == -1 && errno != 0) return;
  ::setpriority(PRIO_PROCESS, 0, std::min(nice + kNiceIncrement, kMaxNice));
}

}  // namespace taxelsim
