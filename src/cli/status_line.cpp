#include "cli/status_line.h"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdio>
#include <memory>
#include <string>

#include "base/text.h"

namespace taxelsim::cli {

namespace {

constexpr int kUsualWidth = 80;

}  // namespace

StatusLine& StatusLine::instance() {
  static StatusLine line;
  return line;
}

StatusLine::StatusLine() : visible_(isatty(STDERR_FILENO) == 1 && spdlog::should_log(spdlog::level::info)) {}

void StatusLine::draw(const std::string& text) {
  const std::lock_guard lock(mutex_);
  if (!visible_) return;
  std::fprintf(stderr, "\r%s\033[K", oneLine(text).substr(0, static_cast<std::size_t>(width() - 1)).c_str());
  std::fflush(stderr);
}

void StatusLine::clear() {
  const std::lock_guard lock(mutex_);
  clearLocked();
}

void StatusLine::clearLocked() {
  if (visible_) std::fputs("\r\033[K", stderr);  // what another process has drawn, too
}

int StatusLine::width() {
  winsize size{};
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : kUsualWidth;
}

// Holds the lock of the status line while it writes, so that a redraw cannot split a message.
class LogSink : public spdlog::sinks::sink {
 public:
  void log(const spdlog::details::log_msg& message) override {
    StatusLine& line = StatusLine::instance();
    const std::lock_guard lock(line.mutex_);
    line.clearLocked();
    std::fflush(stdout);  // what was printed before the message comes before it
    const std::string text = oneLine({message.payload.data(), message.payload.size()});
    spdlog::details::log_msg line_of_text = message;
    line_of_text.payload = text;
    stderr_.log(line_of_text);
  }
  void flush() override { stderr_.flush(); }
  void set_pattern(const std::string& pattern) override { stderr_.set_pattern(pattern); }
  void set_formatter(std::unique_ptr<spdlog::formatter> formatter) override { stderr_.set_formatter(std::move(formatter)); }

 private:
  spdlog::sinks::stderr_color_sink_mt stderr_;
};

std::shared_ptr<spdlog::sinks::sink> makeLogSink() {
  return std::make_shared<LogSink>();
}

}  // namespace taxelsim::cli
