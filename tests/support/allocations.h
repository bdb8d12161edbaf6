// How often the calling thread asks for memory by operator new, in programs that are linked with allocations.cpp. What C libraries, the
// driver among them, take by malloc() does not count.
#pragma once

#include <cstdint>

#include "taxelsim/device.h"

namespace taxelsim::support {

// A device without the validation layer, whatever TAXELSIM_VALIDATION says: the layer takes memory for every call.
Device openUnvalidated();

// Since the thread began.
std::uint64_t numAllocations();

// TAXELSIM_BREAK_ON_ALLOCATION=1 stops the program at the first one that is counted while one of these lives, for a debugger to say whose
// it is.
class NoAllocations {
 public:
  NoAllocations();
  ~NoAllocations();
  NoAllocations(const NoAllocations&) = delete;
  NoAllocations& operator=(const NoAllocations&) = delete;
  // Since this was made.
  std::uint64_t count() const { return numAllocations() - before_; }

 private:
  std::uint64_t before_;
};

}  // namespace taxelsim::support
