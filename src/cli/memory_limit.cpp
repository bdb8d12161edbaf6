#include "cli/memory_limit.h"

#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <exception>
#include <string>

#include "cli/commands.h"

namespace taxelsim::cli {
namespace {

std::string crash_message;  // made in advance: a signal handler cannot allocate
std::atomic_flag is_explained;

extern "C" void explainCrash(int) {
  while (is_explained.test_and_set()) pause();  // another thread that crashed ends the process
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
  std::set_terminate([] { explainCrash(SIGABRT); });  // instead of a line of the C++ library as well
}

}  // namespace taxelsim::cli
