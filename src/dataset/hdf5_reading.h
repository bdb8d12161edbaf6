// How the readers of shards and views call HDF5.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>

namespace taxelsim::dataset {

enum class Isolation {
  kNone,   // HDF5 reads in this process
  kChild,  // in a child process (child_reading.h)
};

// Calls `read` with a buffer of bytes.size() bytes, in an Hdf5Session; its bytes end up in `bytes`. Throws Error(kInput), "FILE: broken or
// foreign WHAT: problem; remedy", for an Hdf5Error, and what readInChild() throws.
void readHdf5(const std::filesystem::path& file, const std::string& what, const std::string& remedy, Isolation isolation,
              std::span<std::byte> bytes, const std::function<void(std::span<std::byte>)>& read);

// A file, and a buffer for what `read` reads from it.
struct Hdf5Read {
  std::filesystem::path file;
  std::span<std::byte> bytes;
  std::function<void(std::span<std::byte>)> read;
};

// Reads all files in one child process: a process for each takes longer than reading a small file. Returns false if one of them fails, or
// if all of them take more than a second beyond the time for their bytes; no bytes are valid then, and readHdf5() of each file, with the
// limits of a file, finds which one and why. Throws Error(kIo) if there is no child.
bool readHdf5Together(std::span<const Hdf5Read> reads);

// Throws Error(kInput) if the file is too small for the ends of so many episodes, before anything of that size is allocated.
void checkCounts(const std::filesystem::path& file, std::uint64_t num_episodes);

// Bytes of a buffer as the ends of episodes.
std::span<std::uint64_t> episodeEnds(std::span<std::byte> bytes);

}  // namespace taxelsim::dataset
