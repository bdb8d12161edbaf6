// The libFuzzer program of the target TAXELSIM_FUZZ_TARGET.
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "fuzz/targets.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const taxelsim::fuzz::Read read = [] {
    for (const auto& target : taxelsim::fuzz::allTargets()) {
      if (target.name == TAXELSIM_FUZZ_TARGET) return target.read;
    }
    std::abort();
  }();
  read({reinterpret_cast<const char*>(data), size});
  return 0;
}
