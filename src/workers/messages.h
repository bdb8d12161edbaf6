// What a worker sends to the process that started it: values in memory order, since both run the same program on one machine.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace taxelsim::workers {

enum class MessageKind : std::uint32_t {
  kProgress,       // one Progress
  kScene,          // text: Scene::resolved
  kLoadMisses,     // (num_objects) LoadMisses
  kContactMisses,  // one ContactMisses
  kVerdicts,       // (num_episodes) Verdict of one controller
  kProblem,        // text of one line: why it did not do its work
  kEnd,            // nothing; the last one of a worker that did its work, or was asked to stop
};

struct Message {
  MessageKind kind = MessageKind::kEnd;
  std::vector<std::byte> bytes;

  std::string text() const { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }

  template <class T>
  std::vector<T> values() const {
    static_assert(std::is_trivially_copyable_v<T>);
    std::vector<T> values(bytes.size() / sizeof(T));
    if (!values.empty()) std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
    return values;
  }
};

// Waits while the pipe is full. Throws Error(kIo).
void send(int descriptor, MessageKind kind, std::span<const std::byte> bytes);

// Waits for the next message; none if the stream ends before it is complete.
std::optional<Message> receive(int descriptor);

}  // namespace taxelsim::workers
