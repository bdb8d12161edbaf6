#include "dataset/directory_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>

#include "taxelsim/error.h"

namespace taxelsim::dataset {
namespace {

[[noreturn]] void throwIo(const std::string& action, const std::filesystem::path& file, int code) {
  throw Error(ErrorKind::kIo, "cannot " + action + " lock file " + file.string() + ": " + std::strerror(code));
}

}  // namespace

DirectoryLock::DirectoryLock(const std::filesystem::path& directory, LockMode mode) : file_(directory / kLockName), mode_(mode) {
  while (true) {
    descriptor_ = ::open(file_.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (descriptor_ < 0) throwIo("create", file_, errno);
    try {
      lock();
    } catch (...) {
      ::close(descriptor_);
      throw;
    }
    // The previous holder may have removed the file between open() and flock(). The lock is then on an unlinked file, and must be retried.
    struct stat locked {
    }, current{};
    if (::fstat(descriptor_, &locked) == 0 && ::stat(file_.c_str(), &current) == 0 && locked.st_ino == current.st_ino &&
        locked.st_dev == current.st_dev)
      return;
    ::close(descriptor_);
  }
}

void DirectoryLock::lock() {
  if (::flock(descriptor_, (mode_ == LockMode::kShared ? LOCK_SH : LOCK_EX) | LOCK_NB) == 0) return;
  if (errno == EWOULDBLOCK) throw Error(ErrorKind::kIo, file_.parent_path().string() + ": another process is writing this data set");
  throwIo("lock", file_, errno);
}

DirectoryLock::~DirectoryLock() {
  if (mode_ == LockMode::kExclusive) ::unlink(file_.c_str());
  ::close(descriptor_);
}

}  // namespace taxelsim::dataset
