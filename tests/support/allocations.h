// Number of calls of operator new by this thread, in programs that link allocations.cpp. Calls of malloc() by C libraries, such as the
// driver, do not count.
#pragma once

#include <cstdint>

#include "taxelsim/device.h"

namespace taxelsim::support {

// A device without the validation layer, whatever TAXELSIM_VALIDATION is: the layer allocates in every call.
Device openUnvalidated();

// Since the start of the thread.
std::uint64_t numAllocations();

// Counts allocations during its lifetime. TAXELSIM_BREAK_ON_ALLOCATION=1 aborts at the first, for a debugger.
class NoAllocations {
 public:
  NoAllocations();
  ~NoAllocations();
  NoAllocations(const NoAllocations&) = delete;
  NoAllocations& operator=(const NoAllocations&) = delete;
  // Since construction.
  std::uint64_t count() const { return numAllocations() - before_; }

 private:
  std::uint64_t before_;
};

}  // namespace taxelsim::support
