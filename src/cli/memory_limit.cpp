#include "cli/memory_limit.h"

#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <string>

#include "cli/commands.h"

namespace taxelsim::cli {
namespace {

std::string crash_message;  // made in advance: a signal handler cannot allocate

extern "C" void explainCrash(int) {
  [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, crash_message.data(), crash_message.size());
  _exit(kExitDevice);
}

}  // namespace

void explainCrashesUnderMemoryLimit() {
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return;
  crash_message = "taxelsim: crashed, probably because a driver or library found no memory: the address space is limited to " +
                  std::to_string(limit.rlim_cur >> 20) + " MiB (ulimit -v); raise the limit\n";
  for (const int signal : {SIGSEGV, SIGBUS, SIGABRT}) std::signal(signal, explainCrash);
}

}  // namespace taxelsim::cli
