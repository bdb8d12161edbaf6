// A pipe between two processes.
#pragma once

#include <utility>

namespace taxelsim::workers {

// Owner of a file descriptor, which programs that are started do not inherit.
class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor() { close(); }
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }

  int number() const { return number_; }  // -1: none
  void close();

 private:
  int number_ = -1;
};

struct Pipe {
  Descriptor read, write;
};

// Both numbers are above those of the standard streams. Throws Error(kIo).
Pipe makePipe();

}  // namespace taxelsim::workers
