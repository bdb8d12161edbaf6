#include "dataset/hdf5_reading.h"

#include <algorithm>
#include <system_error>
#include <vector>

#include "dataset/child_reading.h"
#include "dataset/hdf5.h"
#include "taxelsim/error.h"

namespace taxelsim::dataset {
namespace {

constexpr const char* kReadFailed = "file read failed";  // in HDF5's message: the system refused a read, the file may be intact
constexpr std::uint64_t kSecondsTogether = 1;            // limit for empty files; a file that hangs takes this and then its own limit

}  // namespace

void readHdf5(const std::filesystem::path& file, const std::string& what, const std::string& remedy, Isolation isolation,
              std::span<std::byte> bytes, const std::function<void(std::span<std::byte>)>& read) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) throw Error(ErrorKind::kInput, file.string() + ": is not a regular file");
  const auto readHere = [&](std::span<std::byte> buffer) {
    try {
      const Hdf5Session session;
      read(buffer);
    } catch (const Hdf5Error& problem) {
      if (std::string(problem.what()).find(kReadFailed) != std::string::npos)
        throw Error(ErrorKind::kIo, file.string() + ": " + problem.what());
      throw Error(ErrorKind::kInput, file.string() + ": broken or foreign " + what + ": " + problem.what() + "; " + remedy);
    }
  };
  if (isolation == Isolation::kChild) return readInChild(file, bytes, readHere);
  readHere(bytes);
}

bool readHdf5Together(std::span<const Hdf5Read> reads) {
  std::size_t num_bytes = 0;
  std::uint64_t file_bytes = 0;
  for (const Hdf5Read& one : reads) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(one.file, error)) return false;
    file_bytes += std::filesystem::file_size(one.file, error);
    if (error) return false;
    num_bytes += one.bytes.size();
  }
  std::vector<std::byte> all(num_bytes);
  const auto readAll = [&](std::span<std::byte> buffer) {
    const Hdf5Session session;
    for (const Hdf5Read& one : reads) {
      one.read(buffer.first(one.bytes.size()));
      buffer = buffer.subspan(one.bytes.size());
    }
  };
  try {
    readInChild(reads.front().file, all, readAll, {.seconds = kSecondsTogether + file_bytes / kChildBytesPerSecond});
  } catch (const Error& error) {
    if (error.kind() == ErrorKind::kIo) throw;
    return false;
  }
  std::size_t at = 0;
  for (const Hdf5Read& one : reads) {
    std::copy_n(all.begin() + static_cast<std::ptrdiff_t>(at), one.bytes.size(), one.bytes.begin());
    at += one.bytes.size();
  }
  return true;
}

void checkCounts(const std::filesystem::path& file, std::uint64_t num_episodes) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  if (error) throw Error(ErrorKind::kIo, file.string() + ": its size cannot be read: " + error.message());
  if (num_episodes > size / sizeof(std::uint64_t))
    throw Error(ErrorKind::kInput, file.string() + ": has " + std::to_string(size) + " bytes, too few for the " +
                                       std::to_string(num_episodes) + " episodes of the manifest");
}

std::span<std::uint64_t> episodeEnds(std::span<std::byte> bytes) {
  return {reinterpret_cast<std::uint64_t*>(bytes.data()), bytes.size() / sizeof(std::uint64_t)};
}

}  // namespace taxelsim::dataset
