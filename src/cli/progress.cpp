#include "cli/progress.h"

#include <spdlog/spdlog.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "figures/text.h"

namespace taxelsim::cli {

using namespace figures;

namespace {

constexpr double kLineInterval = 5;  // s between lines in a log
constexpr int kLongestBar = 30;
constexpr int kShortestBar = 5;
constexpr int kUsualWidth = 80;

double fractionOf(const Progress& progress) {
  if (progress.num_episodes == 0) return 0;
  return static_cast<double>(progress.episodes_done) / static_cast<double>(progress.num_episodes);
}

double secondsLeft(const Progress& progress) {
  const auto made = static_cast<double>(progress.episodes_done - std::min(progress.episodes_resumed, progress.episodes_done));
  if (!(made > 0)) return std::numeric_limits<double>::infinity();
  return progress.seconds / made * static_cast<double>(progress.num_episodes - progress.episodes_done);
}

int terminalWidth() {
  winsize size{};
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : kUsualWidth;
}

}  // namespace

std::string progressLine(const Progress& progress) {
  const double rate = progress.seconds > 0 ? static_cast<double>(progress.frames_done) / progress.seconds : 0;
  return fmt::format("{:3.0f} %  {} of {} episodes  {} frames/s  {} left", std::floor(100 * fractionOf(progress)),
                     countText(progress.episodes_done), countText(progress.num_episodes), countText(static_cast<std::uint64_t>(rate)),
                     durationText(secondsLeft(progress)));
}

std::string progressBar(const Progress& progress, int width) {
  const std::string line = progressLine(progress);
  const int length = std::min(kLongestBar, width - static_cast<int>(line.size()) - 4);
  if (length < kShortestBar) return line.substr(0, static_cast<std::size_t>(std::max(width, 0)));
  const auto full = static_cast<std::size_t>(std::lround(fractionOf(progress) * length));
  return "[" + std::string(full, '#') + std::string(static_cast<std::size_t>(length) - full, '.') + "] " + line;
}

ProgressPrinter::ProgressPrinter() : terminal_(isatty(STDERR_FILENO) == 1 && spdlog::should_log(spdlog::level::info)) {}

ProgressPrinter::~ProgressPrinter() {
  clear();
}

void ProgressPrinter::show(const Progress& progress) {
  if (terminal_) {
    std::fprintf(stderr, "\r%s\033[K", progressBar(progress, terminalWidth() - 1).c_str());
    std::fflush(stderr);
    drawn_ = true;
  } else if (progress.seconds >= next_line_) {
    spdlog::info("{}", progressLine(progress));
    next_line_ = progress.seconds + kLineInterval;
  }
}

void ProgressPrinter::clear() {
  if (drawn_) std::fputs("\r\033[K", stderr);
  drawn_ = false;
}

}  // namespace taxelsim::cli
