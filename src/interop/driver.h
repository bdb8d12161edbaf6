// The calls of the driver of a GPU that import memory of another interface, found at run time: no toolkit is needed to build or to run.
//
// CUDA's driver and HIP have the same calls and records under other names. Sources: CUDA Driver API, sections "External Resource
// Interoperability" and "Device Management"; HIP API, section "External Resource Interoperability".
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace taxelsim::interop {

// The interface of a GPU's vendor.
enum class Platform { kCuda, kHip };

using Uuid = std::array<std::uint8_t, 16>;

// CUDA_EXTERNAL_MEMORY_HANDLE_DESC.
struct MemoryHandle {
  std::int32_t type;
  std::int32_t padding;
  std::int32_t descriptor;
  std::int32_t unused[3];
  std::uint64_t bytes;
  std::uint32_t flags;
  std::uint32_t reserved[16];
};
// CUDA_EXTERNAL_MEMORY_BUFFER_DESC.
struct MemoryRange {
  std::uint64_t offset, bytes;
  std::uint32_t flags;
  std::uint32_t reserved[16];
};
// CUDA_EXTERNAL_SEMAPHORE_HANDLE_DESC.
struct alignas(8) SemaphoreHandle {
  std::int32_t type;
  std::int32_t padding;
  std::int32_t descriptor;
  std::int32_t unused[3];
  std::uint32_t flags;
  std::uint32_t reserved[16];
};
// CUDA_EXTERNAL_SEMAPHORE_WAIT_PARAMS and CUDA_EXTERNAL_SEMAPHORE_SIGNAL_PARAMS, of which a timeline uses the value alone.
struct SemaphorePoint {
  std::uint64_t value;
  std::uint32_t reserved[34];
};
static_assert(sizeof(MemoryHandle) == 104 && sizeof(MemoryRange) == 88 && sizeof(SemaphoreHandle) == 96 && sizeof(SemaphorePoint) == 144);

inline constexpr std::int32_t kOpaqueDescriptor = 1;    // CU_EXTERNAL_MEMORY_HANDLE_TYPE_OPAQUE_FD
inline constexpr std::int32_t kTimelineDescriptor = 9;  // CU_EXTERNAL_SEMAPHORE_HANDLE_TYPE_TIMELINE_SEMAPHORE_FD
inline constexpr std::uint32_t kDedicated = 1;          // CUDA_EXTERNAL_MEMORY_DEDICATED

using Address = std::uint64_t;
using Handle = void*;

// Each row: X(field, arguments, name in CUDA, name in HIP). All return 0 for success.
#define TAXELSIM_DRIVER_CALLS(X)                                                                                                       \
  X(init, (unsigned), "cuInit", "hipInit")                                                                                             \
  X(errorText, (int, const char**), "cuGetErrorString", "hipDrvGetErrorString")                                                        \
  X(countDevices, (int*), "cuDeviceGetCount", "hipGetDeviceCount")                                                                     \
  X(device, (int*, int), "cuDeviceGet", "hipDeviceGet")                                                                                \
  X(uuid, (Uuid*, int), "cuDeviceGetUuid_v2", "hipDeviceGetUuid")                                                                      \
  X(retainContext, (Handle*, int), "cuDevicePrimaryCtxRetain", "hipDevicePrimaryCtxRetain")                                            \
  X(releaseContext, (int), "cuDevicePrimaryCtxRelease_v2", "hipDevicePrimaryCtxRelease")                                               \
  X(pushContext, (Handle), "cuCtxPushCurrent_v2", "hipCtxPushCurrent")                                                                 \
  X(popContext, (Handle*), "cuCtxPopCurrent_v2", "hipCtxPopCurrent")                                                                   \
  X(importMemory, (Handle*, const MemoryHandle*), "cuImportExternalMemory", "hipImportExternalMemory")                                 \
  X(mapMemory, (Address*, Handle, const MemoryRange*), "cuExternalMemoryGetMappedBuffer", "hipExternalMemoryGetMappedBuffer")          \
  X(unmapMemory, (Address), "cuMemFree_v2", "hipFree")                                                                                 \
  X(destroyMemory, (Handle), "cuDestroyExternalMemory", "hipDestroyExternalMemory")                                                    \
  X(importSemaphore, (Handle*, const SemaphoreHandle*), "cuImportExternalSemaphore", "hipImportExternalSemaphore")                     \
  X(wait, (const Handle*, const SemaphorePoint*, unsigned, Handle), "cuWaitExternalSemaphoresAsync", "hipWaitExternalSemaphoresAsync") \
  X(signal, (const Handle*, const SemaphorePoint*, unsigned, Handle), "cuSignalExternalSemaphoresAsync",                               \
    "hipSignalExternalSemaphoresAsync")                                                                                                \
  X(destroySemaphore, (Handle), "cuDestroyExternalSemaphore", "hipDestroyExternalSemaphore")                                           \
  X(synchronize, (Handle), "cuStreamSynchronize", "hipStreamSynchronize")                                                              \
  X(copyToHost, (void*, Address, std::size_t), "cuMemcpyDtoH_v2", "hipMemcpyDtoH")

struct Driver {
// NOLINTNEXTLINE(bugprone-macro-parentheses): arguments are a name and a list of types
#define TAXELSIM_CALL(field, arguments, cuda, hip) int(*field) arguments = nullptr;
  TAXELSIM_DRIVER_CALLS(TAXELSIM_CALL)
#undef TAXELSIM_CALL

  // Throws Error(kDevice), which names `call`, unless `result` is 0.
  void check(int result, const char* call) const;
};

// The driver of this process, initialised, which stays loaded. Throws Error(kDevice) where it is not installed or lacks a call.
const Driver& driverOf(Platform platform);

}  // namespace taxelsim::interop
