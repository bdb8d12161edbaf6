#include "dataset/checksum.h"

#include <algorithm>
#include <array>

#include "base/sha256.h"
#include "taxelsim/error.h"

namespace taxelsim::dataset {
namespace {

constexpr std::size_t kDigits = 64;
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

}  // namespace

std::filesystem::path checksumFile(const std::filesystem::path& file) {
  return std::filesystem::path(file).concat(".sha256");
}

void writeWithChecksum(const std::filesystem::path& file, const FileContent& content) {
  const std::string line = checksumLine(digestOf(content), file);
  writeFileAtomically(checksumFile(file), std::as_bytes(std::span(line)));
  writeFileAtomically(file, content);
}

void removeWithChecksum(const std::filesystem::path& file) {
  removeFile(file);
  removeFile(checksumFile(file));
}

void verifyChecksum(const std::filesystem::path& file, const std::atomic<bool>* stop) {
  const std::filesystem::path checksum = checksumFile(file);
  std::error_code error;
  if (!std::filesystem::is_regular_file(checksum, error))
    throw Error(ErrorKind::kInput, file.string() + ": its checksum file " + checksum.filename().string() + " is missing");
  const bool is_short = inputFileProblem(checksum, kMaxBytes).empty();
  const std::string line = is_short ? readTextFile(checksum, kMaxBytes) : "";
  const std::string digest = line.substr(0, kDigits);
  const bool is_digest = digest.size() == kDigits &&
                         std::all_of(digest.begin(), digest.end(), [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); });
  if (!is_digest || line != checksumLine(digest, file))
    throw Error(ErrorKind::kInput, checksum.string() + ": is not a line of sha256sum for " + file.filename().string());
  const std::string found = sha256File(file, stop);
  if (found != digest)
    throw Error(ErrorKind::kInput, file.string() + ": its SHA-256 is " + found + ", not " + digest + " as in " +
                                       checksum.filename().string() + ": the file was changed");
}

}  // namespace taxelsim::dataset
