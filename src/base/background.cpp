#include "base/background.h"

#include <sys/resource.h>

#include <algorithm>
#include <cerrno>

namespace taxelsim {
namespace {

constexpr int kNicer = 10;  // a ninth of the share of an ordinary thread: still enough to go on beside a processor that never rests
constexpr int kNicest = 19;

}  // namespace

void goToBackground() {
  // On Linux niceness is of the thread, not of the process.
  errno = 0;
  const int now = ::getpriority(PRIO_PROCESS, 0);
  if (now == -1 && errno != 0) return;
  ::setpriority(PRIO_PROCESS, 0, std::min(now + kNicer, kNicest));
}

}  // namespace taxelsim
