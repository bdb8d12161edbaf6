#include "gpu/driver_threads.h"

#include <pthread.h>
#include <sched.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

namespace taxelsim::gpu {
namespace {

// Mesa starts a thread that submits, one per processor that draws, one per processor that computes, and possibly one that writes the shader
// cache. Those that draw and that write give themselves other names as soon as they run; this is the beginning of the former.
constexpr const char* kDrawingThread = "llvmpipe-";

// Numbers and names of this process's threads, the oldest first as long as Linux has not used up its numbers.
std::vector<std::pair<pid_t, std::string>> threadsOfProcess() {
  std::vector<std::pair<pid_t, std::string>> threads;
  std::error_code error;
  for (std::filesystem::directory_iterator entry("/proc/self/task", error), end; !error && entry != end; entry.increment(error)) {
    std::string name;
    if (std::ifstream stream(entry->path() / "comm"); std::getline(stream, name)) {
      threads.emplace_back(std::atoi(entry->path().filename().c_str()), name);
    }
  }
  std::sort(threads.begin(), threads.end());
  return threads;
}

std::vector<int> processorsOf(const cpu_set_t& mask) {
  std::vector<int> processors;
  for (int i = 0; i < CPU_SETSIZE; ++i) {
    if (CPU_ISSET(i, &mask)) processors.push_back(i);
  }
  return processors;
}

}  // namespace

DriverThreads::DriverThreads() {
  static std::atomic<unsigned> number = 0;  // a name for each object: threads of another device are not counted
  std::snprintf(name_.data(), name_.size(), "taxelsim-%06u", number++ % 1000000);
  ::pthread_getname_np(::pthread_self(), name_before_.data(), name_before_.size());
  ::pthread_setname_np(::pthread_self(), name_.data());
}

DriverThreads::~DriverThreads() {
  ::pthread_setname_np(::pthread_self(), name_before_.data());
}

void DriverThreads::bindToProcessors() const {
  cpu_set_t allowed;
  if (::sched_getaffinity(0, sizeof(allowed), &allowed) != 0) return;  // also on machines of more than CPU_SETSIZE processors
  const std::vector<int> processors = processorsOf(allowed);
  const std::size_t count = processors.size(), num_without_writer = 1 + 2 * count;
  std::vector<pid_t> started;
  for (const auto& [id, name] : threadsOfProcess()) {
    const bool has_our_name = name == name_.data() && id != ::gettid();
    if (has_our_name || (!started.empty() && name.starts_with(kDrawingThread))) started.push_back(id);
  }
  if (count < 2 || started.size() < num_without_writer || started.size() > num_without_writer + 1) return;
  for (std::size_t i = 0; i < count; ++i) {
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(processors[i], &one);
    ::sched_setaffinity(started[1 + count + i], sizeof(one), &one);
  }
}

}  // namespace taxelsim::gpu
