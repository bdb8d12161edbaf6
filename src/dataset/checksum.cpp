#include "dataset/checksum.h"

#include <algorithm>
#include <array>
#include <ctime>
#include <map>
#include <mutex>
#include <optional>

#include "base/sha256.h"
#include "dataset/file_stamp.h"
#include "taxelsim/error.h"

namespace taxelsim::dataset {
namespace {

constexpr std::uint64_t kMaxBytes = 1024;  // of a checksum file

std::string digestOf(const FileContent& content) {
  static constexpr std::array<std::byte, 4096> kZeros{};
  Sha256 digest;
  std::uint64_t end = 0;
  const auto addZerosUntil = [&](std::uint64_t offset) {
    while (end < offset) {
      const std::uint64_t count = std::min<std::uint64_t>(offset - end, kZeros.size());
      digest.add(std::span(kZeros).first(count));
      end += count;
    }
  };
  for (const FilePiece& piece : content.pieces) {
    addZerosUntil(piece.offset);
    digest.add(piece.bytes);
    end += piece.bytes.size();
  }
  addZerosUntil(content.size);
  return digest.finish();
}

// The line of sha256sum: the digest, two spaces, the name.
std::string checksumLine(const std::string& digest, const std::filesystem::path& file) {
  return digest + "  " + file.filename().string() + "\n";
}

// Files that this process has verified.
class VerifiedFiles {
 public:
  static VerifiedFiles& instance() {
    static VerifiedFiles files;
    return files;
  }

  // The digest of a file that has not changed since; empty if it is not known.
  std::string find(const std::filesystem::path& file) const {
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error)) return {};
    const FileStamp stamp = stampOf(file);
    const std::lock_guard lock(mutex_);
    const auto found = files_.find(std::filesystem::absolute(file));
    return found != files_.end() && found->second.stamp == stamp ? found->second.digest : std::string();
  }

  void add(const std::filesystem::path& file, const FileStamp& stamp, const std::string& digest) {
    const std::lock_guard lock(mutex_);
    files_[std::filesystem::absolute(file)] = {stamp, digest};
  }

 private:
  struct Entry {
    FileStamp stamp;
    std::string digest;
  };
  mutable std::mutex mutex_;
  std::map<std::filesystem::path, Entry> files_;
};

// ns since 1970 of the clock that local file systems give to files.
std::int64_t fileSystemTime() {
  timespec now{};
  ::clock_gettime(CLOCK_REALTIME_COARSE, &now);
  return now.tv_sec * std::int64_t{1'000'000'000} + now.tv_nsec;
}

}  // namespace

bool isDigest(const std::string& text) {
  return text.size() == kDigestDigits &&
         std::all_of(text.begin(), text.end(), [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); });
}

std::filesystem::path checksumFile(const std::filesystem::path& file) {
  return std::filesystem::path(file).concat(".sha256");
}

std::string writeWithChecksum(const std::filesystem::path& file, const FileContent& content) {
  std::string digest = digestOf(content);
  const std::string line = checksumLine(digest, file);
  writeFileAtomically(checksumFile(file), std::as_bytes(std::span(line)));
  writeFileAtomically(file, content);
  return digest;
}

void removeWithChecksum(const std::filesystem::path& file) {
  removeFile(file);
  removeFile(checksumFile(file));
}

std::string readChecksum(const std::filesystem::path& file) {
  const std::filesystem::path checksum = checksumFile(file);
  std::error_code error;
  if (!std::filesystem::is_regular_file(checksum, error))
    throw Error(ErrorKind::kInput, file.string() + ": its checksum file " + checksum.filename().string() + " is missing");
  const bool is_short = inputFileProblem(checksum, kMaxBytes).empty();
  const std::string line = is_short ? readTextFile(checksum, kMaxBytes) : "";
  std::string digest = line.substr(0, kDigestDigits);
  if (!isDigest(digest) || line != checksumLine(digest, file))
    throw Error(ErrorKind::kInput, checksum.string() + ": is not a line of sha256sum for " + file.filename().string());
  return digest;
}

std::string compareChecksum(const std::filesystem::path& file, const std::atomic<bool>* stop) {
  const std::string digest = readChecksum(file), found = sha256File(file, stop);
  if (found != digest)
    throw Error(ErrorKind::kInput, file.string() + ": its SHA-256 is " + found + ", not " + digest + " as in " +
                                       checksumFile(file).filename().string() + ": the file was changed");
  return digest;
}

std::string verifyChecksum(const std::filesystem::path& file, const std::atomic<bool>* stop) {
  VerifiedFiles& verified = VerifiedFiles::instance();
  if (std::string known = verified.find(file); !known.empty()) return known;
  std::error_code error;
  const std::optional<FileStamp> before = std::filesystem::exists(file, error) ? std::optional(stampOf(file)) : std::nullopt;
  const std::int64_t started = fileSystemTime();
  const std::string digest = compareChecksum(file, stop);
  // A change within the tick of the clock of files in which it was read would not be seen.
  if (before && before->changed < started && stampOf(file) == *before) verified.add(file, *before, digest);
  return digest;
}

}  // namespace taxelsim::dataset
