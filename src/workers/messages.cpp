#include "workers/messages.h"

#include <unistd.h>

#include <cerrno>
#include <string>

#include "taxelsim/error.h"

namespace taxelsim::workers {
namespace {

struct Header {
  MessageKind kind = MessageKind::kEnd;
  std::uint64_t num_bytes = 0;
};

void writeAll(int descriptor, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written > 0)
      bytes = bytes.subspan(static_cast<std::size_t>(written));
    else if (errno != EINTR)
      throw Error(ErrorKind::kIo, std::string("cannot report to the process that started this worker: ") + std::strerror(errno));
  }
}

// False if the stream ends before.
bool readAll(int descriptor, std::span<std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t num_read = ::read(descriptor, bytes.data(), bytes.size());
    if (num_read > 0)
      bytes = bytes.subspan(static_cast<std::size_t>(num_read));
    else if (num_read == 0 || errno != EINTR)
      return false;
  }
  return true;
}

}  // namespace

void send(int descriptor, MessageKind kind, std::span<const std::byte> bytes) {
  const Header header{.kind = kind, .num_bytes = bytes.size()};
  writeAll(descriptor, std::as_bytes(std::span(&header, 1)));
  writeAll(descriptor, bytes);
}

std::optional<Message> receive(int descriptor) {
  Header header;
  if (!readAll(descriptor, std::as_writable_bytes(std::span(&header, 1)))) return {};
  Message message{.kind = header.kind, .bytes = std::vector<std::byte>(header.num_bytes)};
  if (!readAll(descriptor, message.bytes)) return {};
  return message;
}

}  // namespace taxelsim::workers
