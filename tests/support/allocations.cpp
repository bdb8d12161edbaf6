// Replaces operator new of the whole program. Not linked into sanitizer builds, which replace it themselves.
#include "support/allocations.h"

#include <new>

#include "support/test.h"

namespace taxelsim::support {
namespace {

thread_local std::uint64_t num_allocations = 0;
thread_local int num_watchers = 0;

void* allocate(std::size_t size, std::size_t alignment) {
  ++num_allocations;
  if (num_watchers > 0 && std::getenv("TAXELSIM_BREAK_ON_ALLOCATION") != nullptr) std::abort();
  // aligned_alloc() needs a multiple of the alignment.
  const std::size_t whole = (size + alignment - 1) / alignment * alignment;
  return alignment <= alignof(std::max_align_t) ? std::malloc(size == 0 ? 1 : size) : std::aligned_alloc(alignment, whole);
}

void* allocateOrThrow(std::size_t size, std::size_t alignment) {
  if (void* memory = allocate(size, alignment)) return memory;
  throw std::bad_alloc();
}

}  // namespace

Device openUnvalidated() {
  constexpr const char* kName = "TAXELSIM_VALIDATION";
  const char* found = std::getenv(kName);
  const std::string value = found != nullptr ? found : "";
  ::unsetenv(kName);
  Device device = Device::open();
  if (!value.empty()) ::setenv(kName, value.c_str(), 1);
  return device;
}

std::uint64_t numAllocations() {
  return num_allocations;
}

NoAllocations::NoAllocations() : before_(num_allocations) {
  ++num_watchers;
}

NoAllocations::~NoAllocations() {
  --num_watchers;
}

}  // namespace taxelsim::support

// All other forms (arrays, nothrow) call these.
void* operator new(std::size_t size) {
  return taxelsim::support::allocateOrThrow(size, alignof(std::max_align_t));
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  return taxelsim::support::allocateOrThrow(size, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
  std::free(memory);
}
