// A stand-in for libcuda.so.1 and libamdhip64.so, for machines without a GPU: memory that software Vulkan has exported is mapped into this
// process. It counts what it has handed out, records what streams were told, and fails on demand.
//
// Mesa's software driver exports memory as a memfd whose data begins at byte 4096 (measured on 22.3.6 and 25.0.7).
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdint>
#include <cstring>
#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "interop/driver.h"

using namespace taxelsim::interop;

// The driver's calls under their names; those of HIP are the same functions.
extern "C" {
#define DECLARE(field, arguments, cuda, hip) \
  int field##Call arguments asm(cuda);       \
  int field##HipCall arguments asm(hip) __attribute__((alias(cuda)));
TAXELSIM_DRIVER_CALLS(DECLARE)
#undef DECLARE
}

namespace {

constexpr off_t kFirstByte = 4096;
constexpr int kInvalidValue = 1, kInvalidHandle = 400;  // CUDA_ERROR_...
constexpr int kFirstDevice = 70;                        // numbers of devices are not their ordinals

struct Memory {
  int descriptor;
  std::uint64_t bytes;
};

struct Standin {
  std::mutex mutex;
  std::vector<Uuid> devices;
  std::map<Handle, Memory> memory;
  std::map<Address, std::uint64_t> mapped;  // bytes
  std::map<Handle, int> semaphores;         // descriptors
  int contexts = 0;
  std::string failing, events, text;
  std::uintptr_t last_handle = 0;

  Handle newHandle() { return reinterpret_cast<Handle>(++last_handle); }
};

Standin& standin() {
  static Standin only;
  return only;
}

thread_local int entered = 0;  // contexts on the stack of this thread

// `call(standin)`, unless it was told to fail.
template <typename Call>
int run(const char* name, Call call) {
  Standin& s = standin();
  const std::lock_guard lock(s.mutex);
  return s.failing == name ? kInvalidValue : call(s);
}

int record(Standin& s, const char* call, std::uint64_t value, Handle stream) {
  s.events += std::string(call) + " " + std::to_string(value) + " " + std::to_string(reinterpret_cast<std::uintptr_t>(stream)) + "\n";
  return 0;
}

}  // namespace

int initCall(unsigned) {
  return run("init", [](Standin&) { return 0; });
}
int errorTextCall(int, const char** text) {
  *text = "as the test wished";
  return 0;
}
int countDevicesCall(int* count) {
  return run("countDevices", [&](Standin& s) { return *count = static_cast<int>(s.devices.size()), 0; });
}
int deviceCall(int* device, int ordinal) {
  return run("device", [&](Standin&) { return *device = kFirstDevice + ordinal, 0; });
}
int uuidCall(Uuid* uuid, int device) {
  return run("uuid", [&](Standin& s) { return *uuid = s.devices[static_cast<std::size_t>(device - kFirstDevice)], 0; });
}
int retainContextCall(Handle* context, int) {
  return run("retainContext", [&](Standin& s) { return *context = s.newHandle(), ++s.contexts, 0; });
}
int releaseContextCall(int) {
  return run("releaseContext", [](Standin& s) { return --s.contexts, 0; });
}
int pushContextCall(Handle) {
  return run("pushContext", [](Standin&) { return ++entered, 0; });
}
int popContextCall(Handle*) {
  return run("popContext", [](Standin&) { return --entered, 0; });
}

int importMemoryCall(Handle* memory, const MemoryHandle* handle) {
  return run("importMemory", [&](Standin& s) {
    struct stat file {};
    const bool is_valid = entered > 0 && handle->type == kOpaqueDescriptor && handle->flags == kDedicated &&
                          ::fstat(handle->descriptor, &file) == 0 && file.st_size >= kFirstByte + static_cast<off_t>(handle->bytes);
    if (!is_valid) return kInvalidValue;
    *memory = s.newHandle();
    s.memory[*memory] = {handle->descriptor, handle->bytes};
    return 0;
  });
}
int mapMemoryCall(Address* address, Handle memory, const MemoryRange* range) {
  return run("mapMemory", [&](Standin& s) {
    const auto found = s.memory.find(memory);
    if (found == s.memory.end()) return kInvalidHandle;
    if (range->offset + range->bytes > found->second.bytes) return kInvalidValue;
    const off_t offset = kFirstByte + static_cast<off_t>(range->offset);
    void* const data = ::mmap(nullptr, range->bytes, PROT_READ | PROT_WRITE, MAP_SHARED, found->second.descriptor, offset);
    if (data == MAP_FAILED) return kInvalidValue;
    *address = reinterpret_cast<Address>(data);
    s.mapped[*address] = range->bytes;
    return 0;
  });
}
int unmapMemoryCall(Address address) {
  return run("unmapMemory", [&](Standin& s) {
    const auto found = s.mapped.find(address);
    if (found == s.mapped.end()) return kInvalidHandle;
    ::munmap(reinterpret_cast<void*>(address), found->second);
    s.mapped.erase(found);
    return 0;
  });
}
int destroyMemoryCall(Handle memory) {
  return run("destroyMemory", [&](Standin& s) {
    const auto found = s.memory.find(memory);
    if (found == s.memory.end()) return kInvalidHandle;
    ::close(found->second.descriptor);
    s.memory.erase(found);
    return 0;
  });
}

int importSemaphoreCall(Handle* semaphore, const SemaphoreHandle* handle) {
  return run("importSemaphore", [&](Standin& s) {
    if (entered == 0 || handle->type != kTimelineDescriptor) return kInvalidValue;
    *semaphore = s.newHandle();
    s.semaphores[*semaphore] = handle->descriptor;
    return 0;
  });
}
int waitCall(const Handle* semaphore, const SemaphorePoint* point, unsigned count, Handle stream) {
  return run("wait", [&](Standin& s) {
    return count == 1 && s.semaphores.contains(*semaphore) ? record(s, "wait", point->value, stream) : kInvalidHandle;
  });
}
int signalCall(const Handle* semaphore, const SemaphorePoint* point, unsigned count, Handle stream) {
  return run("signal", [&](Standin& s) {
    return count == 1 && s.semaphores.contains(*semaphore) ? record(s, "signal", point->value, stream) : kInvalidHandle;
  });
}
int destroySemaphoreCall(Handle semaphore) {
  return run("destroySemaphore", [&](Standin& s) {
    const auto found = s.semaphores.find(semaphore);
    if (found == s.semaphores.end()) return kInvalidHandle;
    ::close(found->second);
    s.semaphores.erase(found);
    return 0;
  });
}

int synchronizeCall(Handle stream) {
  return run("synchronize", [&](Standin& s) { return entered == 0 ? kInvalidValue : record(s, "synchronize", 0, stream); });
}
int copyToHostCall(void* to, Address from, std::size_t bytes) {
  return run("copyToHost", [&](Standin&) {
    if (entered == 0) return kInvalidValue;
    std::memcpy(to, reinterpret_cast<const void*>(from), bytes);
    return 0;
  });
}

// The interface of the tests.
extern "C" {
// The devices that the driver shows, by UUID.
void standinSetDevices(const Uuid* devices, int count) {
  const std::lock_guard lock(standin().mutex);
  standin().devices.assign(devices, devices + count);
}
// The call that fails from now on, a field of TAXELSIM_DRIVER_CALLS; empty: none.
void standinFail(const char* call) {
  const std::lock_guard lock(standin().mutex);
  standin().failing = call;
}
// Memory, mappings, semaphores and contexts that have not been given back.
int standinNumHeld() {
  const std::lock_guard lock(standin().mutex);
  const Standin& s = standin();
  return static_cast<int>(s.memory.size() + s.mapped.size() + s.semaphores.size()) + s.contexts;
}
// Contexts that this thread has entered and not left.
int standinNumEntered() {
  return entered;
}
// Lines "call value stream" since the last time.
const char* standinEvents() {
  const std::lock_guard lock(standin().mutex);
  standin().text = std::exchange(standin().events, {});
  return standin().text.c_str();
}
}
