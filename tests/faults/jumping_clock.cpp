// A clock of the day that jumps at every reading, by up to a thousand years either way, for tests: preloaded into a program, its functions
// take precedence over libc's. The monotonic clock stays as it is, as on a machine whose time is set.
#include <sys/syscall.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

#include <atomic>

namespace {

std::atomic<unsigned> num_readings;

long jump() {
  constexpr long kThousandYears = 31'556'952'000;              // s
  const unsigned scrambled = ++num_readings * 2'654'435'761U;  // multiplicative hash: neighbours are far apart
  return static_cast<long>((static_cast<double>(scrambled) / 0x1p31 - 1) * kThousandYears);
}

}  // namespace

extern "C" {
int clock_gettime(clockid_t clock, timespec* now) noexcept {
  const auto status = static_cast<int>(syscall(SYS_clock_gettime, clock, now));
  if (clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE) now->tv_sec += jump();
  return status;
}
int gettimeofday(timeval* now, void* zone) noexcept {
  const auto status = static_cast<int>(syscall(SYS_gettimeofday, now, zone));
  now->tv_sec += jump();
  return status;
}
time_t time(time_t* now) noexcept {
  timespec read{};
  clock_gettime(CLOCK_REALTIME, &read);
  if (now != nullptr) *now = read.tv_sec;
  return read.tv_sec;
}
}
