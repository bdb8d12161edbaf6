#include "base/files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <random>

#include "base/text.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

constexpr std::size_t kMaxWriteBytes = std::size_t{1} << 30;  // bytes; Linux writes at most 2 GiB per call
constexpr const char* kTemporaryMark = ".tmp-";

[[noreturn]] void throwIo(const std::string& action, const std::filesystem::path& file, int code) {
  throw Error(ErrorKind::kIo, "cannot " + action + " " + file.string() + ": " + std::strerror(code));
}

class Descriptor {
 public:
  explicit Descriptor(int value) : value_(value) {}
  ~Descriptor() { close(); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return value_; }
  int close() {
    const int result = value_ >= 0 ? ::close(value_) : 0;
    value_ = -1;
    return result;
  }

 private:
  int value_;
};

void flushDirectory(const std::filesystem::path& directory) {
  Descriptor descriptor(::open(directory.empty() ? "." : directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  // Some file systems do not support fsync of a directory and return EINVAL.
  if (descriptor.get() < 0 || (::fsync(descriptor.get()) != 0 && errno != EINVAL)) throwIo("flush directory", directory, errno);
}

void writeAndFlush(const std::filesystem::path& file, const FileContent& content) {
  // O_EXCL and O_NOFOLLOW: never writes through a link that another user has placed under that name.
  Descriptor descriptor(::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666));
  if (descriptor.get() < 0) throwIo("create", file, errno);
  if (::ftruncate(descriptor.get(), static_cast<off_t>(content.size)) != 0) throwIo("write", file, errno);
  for (auto [offset, bytes] : content.pieces) {
    while (!bytes.empty()) {
      const ssize_t written = ::pwrite(descriptor.get(), bytes.data(), std::min(bytes.size(), kMaxWriteBytes), static_cast<off_t>(offset));
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) throwIo("write", file, errno);
      offset += static_cast<std::uint64_t>(written);
      bytes = bytes.subspan(static_cast<std::size_t>(written));
    }
  }
  if (::fsync(descriptor.get()) != 0) throwIo("flush", file, errno);
  if (descriptor.close() != 0) throwIo("close", file, errno);
}

}  // namespace

void writeFileAtomically(const std::filesystem::path& file, std::span<const std::byte> bytes) {
  writeFileAtomically(file, FileContent{.size = bytes.size(), .pieces = {{.offset = 0, .bytes = bytes}}, .buffer = {}});
}

void writeFileAtomically(const std::filesystem::path& file, const FileContent& content) {
  std::random_device random;
  const std::string number = std::to_string(std::uint64_t{random()} << 32 | random());
  const std::filesystem::path temporary =
      file.parent_path() / std::string(".").append(file.filename().string()).append(kTemporaryMark).append(number);
  try {
    writeAndFlush(temporary, content);
    if (::rename(temporary.c_str(), file.c_str()) != 0) throwIo("rename to", file, errno);
  } catch (...) {
    ::unlink(temporary.c_str());
    throw;
  }
  flushDirectory(file.parent_path());
}

void createDirectories(const std::filesystem::path& directory) {
  std::filesystem::path path;
  for (const std::filesystem::path& name : directory) {
    const std::filesystem::path parent = path;
    path /= name;
    if (name.empty() || ::mkdir(path.c_str(), 0777) == 0) {
      if (!name.empty()) flushDirectory(parent);
      continue;
    }
    const int code = errno;
    std::error_code error;
    if (!std::filesystem::is_directory(path, error)) throwIo("create directory", path, code);
  }
}

std::string inputFileProblem(const std::filesystem::path& file, std::uintmax_t max_bytes) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(file, error);
  if (!std::filesystem::status_known(status)) return "cannot be read: " + error.message();
  if (!std::filesystem::exists(status)) return "no such file";
  if (std::filesystem::is_directory(status)) return "a directory, not a file";
  if (!std::filesystem::is_regular_file(status)) return "not a regular file";
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  if (error) return "its size cannot be read";
  if (size > max_bytes) return std::to_string(size) + " bytes are too many: at most " + std::to_string(max_bytes);
  return {};
}

std::string readTextFile(const std::filesystem::path& file, std::uintmax_t max_bytes) {
  const std::string problem = inputFileProblem(file, max_bytes);
  if (!problem.empty()) throw Error(ErrorKind::kInput, oneLine(file.string() + ": " + problem));
  std::string text(std::filesystem::file_size(file), '\0');
  std::ifstream stream(file, std::ios::binary);
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (stream.bad() || static_cast<std::size_t>(stream.gcount()) != text.size()) throwIo("read", file, errno != 0 ? errno : EIO);
  return text;
}

bool isTemporaryName(const std::string& name) {
  return name.starts_with(".") && name.find(kTemporaryMark) != std::string::npos;
}

std::filesystem::path userCacheDirectory() {
  if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache != nullptr && *cache != '\0')
    return std::filesystem::path(cache) / "taxelsim";
  if (const char* home = std::getenv("HOME"); home != nullptr && *home != '\0') return std::filesystem::path(home) / ".cache" / "taxelsim";
  return {};
}

void removeFile(const std::filesystem::path& file) {
  if (::unlink(file.c_str()) != 0 && errno != ENOENT) throwIo("remove", file, errno);
  flushDirectory(file.parent_path());
}

}  // namespace taxelsim
