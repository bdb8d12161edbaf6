// The last line of the terminal, which progress redraws in place.
#pragma once

#include <spdlog/common.h>

#include <memory>
#include <mutex>
#include <string>

namespace taxelsim::cli {

// Thread-safe.
class StatusLine {
 public:
  static StatusLine& instance();

  // Whether stderr is a terminal and messages of level info are shown; where it is false, nothing is drawn.
  bool visible() const { return visible_; }

  // Replaces the line by `text`, without its end if the terminal is narrower.
  void draw(const std::string& text);
  void clear();

  // Width of the terminal, in characters.
  static int width();

 private:
  friend class LogSink;
  StatusLine();
  void clearLocked();

  std::mutex mutex_;
  bool visible_;
};

// Log messages on stderr, in colour, above the status line.
std::shared_ptr<spdlog::sinks::sink> makeLogSink();

}  // namespace taxelsim::cli
