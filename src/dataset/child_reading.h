// Reading of files that HDF5 may not survive, in child processes with limited memory and time.
//
//   parent                                 child
//   maps shared memory, fork()  ---->      sets its limits
//   waits for its end, or kills it         HDF5 reads into the shared memory
//   copies the bytes            <----      ends
//
// A damaged file that makes HDF5 crash, hang or ask for too much memory ends the child alone. Files whose checksum matches can be such
// files: an attacker can compute the checksum of a malicious file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>

namespace taxelsim::dataset {

inline constexpr std::uint64_t kChildBytesPerSecond = std::uint64_t{16} << 20;  // of a slow disk

// For an empty file. Time is added for the bytes of file and buffer at kChildBytesPerSecond, and memory for twice the buffer.
struct ChildLimits {
  std::uint64_t bytes = std::uint64_t{512} << 20;
  std::uint64_t seconds = 5;
};

// Calls `read` with a buffer of bytes.size() bytes in a child process, and copies the buffer to `bytes`. `read` may use HDF5, but nothing
// that other threads of this process lock.
//
// Throws Error(kInput) for what `read` throws, and with the file for a child that crashes or needs more than its limits. Throws Error(kIo)
// if there is no child.
void readInChild(const std::filesystem::path& file, std::span<std::byte> bytes, const std::function<void(std::span<std::byte>)>& read,
                 const ChildLimits& limits = {});

}  // namespace taxelsim::dataset
