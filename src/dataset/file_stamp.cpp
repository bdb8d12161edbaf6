#include "dataset/file_stamp.h"

#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "taxelsim/error.h"

namespace taxelsim::dataset {
namespace {

constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;

std::int64_t nanoseconds(const timespec& time) {
  return time.tv_sec * kNanosecondsPerSecond + time.tv_nsec;
}

}  // namespace

FileStamp stampOf(const std::filesystem::path& file) {
  struct stat status {};
  if (::stat(file.c_str(), &status) != 0)
    throw Error(ErrorKind::kIo, "cannot read the state of " + file.string() + ": " + std::strerror(errno));
  return {.device = status.st_dev,
          .inode = status.st_ino,
          .size = static_cast<std::uint64_t>(status.st_size),
          .changed = std::max(nanoseconds(status.st_mtim), nanoseconds(status.st_ctim))};
}

}  // namespace taxelsim::dataset
