// SHA-256 digests that identify content and detect damage.
#pragma once

#include <atomic>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

namespace taxelsim {

// A digest of bytes that are added one part after another.
class Sha256 {
 public:
  Sha256();
  ~Sha256();
  Sha256(const Sha256&) = delete;
  Sha256& operator=(const Sha256&) = delete;

  void add(std::span<const std::byte> bytes);
  // The digest as 64 lower-case hexadecimal digits. May be called once.
  std::string finish();

 private:
  struct Context;
  std::unique_ptr<Context> context_;
};

// The digest as 64 lower-case hexadecimal digits.
std::string sha256Hex(std::span<const std::byte> bytes);

// Thrown by sha256File() after *stop became true.
struct Stopped {};

// The digest of a regular file, read in blocks of 1 MiB. Throws Error(kInput) when there is no regular file of that name, Error(kIo) when
// it cannot be read, and Stopped after the next block when *stop becomes true.
std::string sha256File(const std::filesystem::path& file, const std::atomic<bool>* stop = nullptr);

}  // namespace taxelsim
