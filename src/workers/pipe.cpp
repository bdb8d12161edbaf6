#include "workers/pipe.h"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <string>

#include "taxelsim/error.h"

namespace taxelsim::workers {
namespace {

[[noreturn]] void fail() {
  throw Error(ErrorKind::kIo, std::string("cannot create a pipe: ") + std::strerror(errno));
}

// A standard stream that is closed would leave its number to the pipe.
Descriptor aboveStandardStreams(const Descriptor& end) {
  Descriptor copy(::fcntl(end.number(), F_DUPFD_CLOEXEC, STDERR_FILENO + 1));
  if (copy.number() < 0) fail();
  return copy;
}

}  // namespace

void Descriptor::close() {
  if (number_ >= 0) ::close(std::exchange(number_, -1));
}

Pipe makePipe() {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) fail();
  const Descriptor read(ends[0]), write(ends[1]);
  return {.read = aboveStandardStreams(read), .write = aboveStandardStreams(write)};
}

}  // namespace taxelsim::workers
