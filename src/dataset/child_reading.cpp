#include "dataset/child_reading.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <memory>
#include <new>
#include <string>

#include "base/text.h"
#include "dataset/hdf5.h"
#include "taxelsim/error.h"

namespace taxelsim::dataset {
namespace {

using Clock = std::chrono::steady_clock;

// The start of the shared memory; the buffer follows.
struct alignas(64) Report {
  bool is_done = false;
  std::array<char, kMaxMessageBytes + 1> problem{};  // empty if there is none
};

class SharedMemory {
 public:
  explicit SharedMemory(std::size_t num_bytes) : num_bytes_(num_bytes) {
    memory_ = ::mmap(nullptr, size(), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (memory_ == MAP_FAILED) throw std::bad_alloc();
    new (memory_) Report();
  }
  ~SharedMemory() { ::munmap(memory_, size()); }
  SharedMemory(const SharedMemory&) = delete;
  SharedMemory& operator=(const SharedMemory&) = delete;

  Report& report() const { return *static_cast<Report*>(memory_); }
  std::span<std::byte> buffer() const { return {static_cast<std::byte*>(memory_) + sizeof(Report), num_bytes_}; }

 private:
  std::size_t size() const { return sizeof(Report) + num_bytes_; }

  std::size_t num_bytes_;
  void* memory_;
};

[[noreturn]] void throwIo(const std::filesystem::path& file, int code) {
  throw Error(ErrorKind::kIo, file.string() + ": cannot start a process to read it: " + std::strerror(code));
}

// Bytes of the address space of this process. Drivers of GPUs reserve much of it.
std::uint64_t addressSpace() {
  std::ifstream statm("/proc/self/statm");
  std::uint64_t pages = 0;
  statm >> pages;
  return pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

void limitThisProcess(std::uint64_t max_address_space, std::uint64_t max_seconds) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  std::signal(SIGINT, SIG_IGN);  // Ctrl-C is for the parent, and is no fault of the file
  for (const int signal : {SIGTERM, SIGSEGV, SIGBUS, SIGABRT}) std::signal(signal, SIG_DFL);
  const auto limit = [](__rlimit_resource resource, std::uint64_t value) {
    const rlimit both{value, value};
    ::setrlimit(resource, &both);
  };
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_CPU, max_seconds);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // these reserve terabytes as they run
  limit(RLIMIT_AS, max_address_space);
#else
  static_cast<void>(max_address_space);
#endif
}

[[noreturn]] void runChild(const SharedMemory& memory, const std::function<void(std::span<std::byte>)>& read) {
  std::string problem;
  try {
    read(memory.buffer());
  } catch (const std::bad_alloc&) {
    problem = "it claims more than fits into the memory for it";
  } catch (const std::exception& error) {
    problem = messageLine(error.what());
  }
  std::copy(problem.begin(), problem.end(), memory.report().problem.begin());
  memory.report().is_done = true;
  ::_exit(0);
}

// Waits until the other end of the pipe is closed, which the end of the child does. False if that takes too long.
bool waitForEnd(int pipe_end, Clock::time_point deadline) {
  while (true) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()).count();
    if (left <= 0) return false;
    pollfd waiting{pipe_end, POLLIN, 0};
    if (::poll(&waiting, 1, static_cast<int>(left)) > 0) return true;
  }
}

}  // namespace

void readInChild(const std::filesystem::path& file, std::span<std::byte> bytes, const std::function<void(std::span<std::byte>)>& read,
                 const ChildLimits& limits) {
  const SharedMemory memory(bytes.size());
  std::error_code error;
  const std::uintmax_t file_bytes = std::filesystem::file_size(file, error);
  const std::uint64_t seconds = limits.seconds + (bytes.size() + (error ? 0 : file_bytes)) / kChildBytesPerSecond;
  const std::uint64_t max_address_space = addressSpace() + 2 * bytes.size() + limits.bytes;
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) throwIo(file, errno);
  const pid_t child = forkWithHdf5();
  if (child == 0) {
    limitThisProcess(max_address_space, seconds);
    runChild(memory, read);
  }
  const int code = errno;
  ::close(ends[1]);
  const bool has_ended = child > 0 && waitForEnd(ends[0], Clock::now() + std::chrono::seconds(seconds));
  ::close(ends[0]);
  if (child < 0) throwIo(file, code);
  if (!has_ended) ::kill(child, SIGKILL);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
  const auto fail = [&](const std::string& problem) {
    throw Error(ErrorKind::kInput, file.string() + ": broken or hostile file: " + problem);
  };
  if (!has_ended || (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU))
    fail("reading it took more than " + std::to_string(seconds) + " s");
  if (!memory.report().is_done)
    fail("HDF5 crashed on it" + (WIFSIGNALED(status) ? " (signal " + std::to_string(WTERMSIG(status)) + ")" : std::string()));
  if (const std::string problem = memory.report().problem.data(); !problem.empty()) throw Error(ErrorKind::kInput, problem);
  std::copy(memory.buffer().begin(), memory.buffer().end(), bytes.begin());
}

}  // namespace taxelsim::dataset
