// Processors of the threads that Mesa's software driver computes with (docs/notes/decisions/0025-driver-threads.md).
#pragma once

#include <array>

namespace taxelsim::gpu {

// Recognises the threads that a driver starts during the lifetime of an object: they inherit the name of the calling thread, which the
// object changes and restores. Use it in one thread.
class DriverThreads {
 public:
  DriverThreads();
  ~DriverThreads();
  DriverThreads(const DriverThreads&) = delete;
  DriverThreads& operator=(const DriverThreads&) = delete;

  // Binds each thread that computes to one of the processors of the calling thread's affinity mask. Does nothing unless the driver has
  // started exactly one such thread per processor, at least two, or where the system refuses.
  void bindToProcessors() const;

 private:
  static constexpr int kNameBytes = 16;  // of Linux, with the final 0
  std::array<char, kNameBytes> name_{}, name_before_{};
};

}  // namespace taxelsim::gpu
