#include "cli/progress.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "cli/status_line.h"
#include "figures/text.h"

namespace taxelsim::cli {

using namespace figures;

namespace {

constexpr int kLongestBar = 30;
constexpr int kShortestBar = 5;

// Fraction of the run, with the episodes that were found on disk.
double fractionOf(const Progress& progress) {
  if (progress.num_episodes == 0) return 0;
  const double resumed = static_cast<double>(progress.episodes_resumed) / static_cast<double>(progress.num_episodes);
  if (progress.num_frames == 0) return resumed;
  return resumed + (1 - resumed) * static_cast<double>(progress.frames_done) / static_cast<double>(progress.num_frames);
}

double secondsLeft(const Progress& progress, const Progress& first) {
  if (progress.frames_done <= first.frames_done) return std::numeric_limits<double>::infinity();
  const double seconds_per_frame = (progress.seconds - first.seconds) / static_cast<double>(progress.frames_done - first.frames_done);
  return seconds_per_frame * static_cast<double>(progress.num_frames - std::min(progress.frames_done, progress.num_frames));
}

}  // namespace

std::string progressLine(const Progress& progress, const Progress& first) {
  const double rate = progress.seconds > 0 ? static_cast<double>(progress.frames_done) / progress.seconds : 0;
  return fmt::format("{:3.0f} %  {} of {} episodes  {} frames/s  {} left", std::floor(100 * fractionOf(progress)),
                     countText(progress.episodes_done), countText(progress.num_episodes), countText(static_cast<std::uint64_t>(rate)),
                     durationText(secondsLeft(progress, first)));
}

std::string progressBar(const Progress& progress, const Progress& first, int width) {
  const std::string line = progressLine(progress, first);
  const int length = std::min(kLongestBar, width - static_cast<int>(line.size()) - 4);
  if (length < kShortestBar) return line.substr(0, static_cast<std::size_t>(std::max(width, 0)));
  const auto full = static_cast<std::size_t>(std::lround(fractionOf(progress) * length));
  return "[" + std::string(full, '#') + std::string(static_cast<std::size_t>(length) - full, '.') + "] " + line;
}

void ProgressPrinter::show(const Progress& progress) {
  StatusLine& line = StatusLine::instance();
  if (!first_) first_ = progress;
  if (line.visible()) {
    line.draw(progressBar(progress, *first_, StatusLine::width() - 1));
    return;
  }
  const bool is_end = progress.num_episodes > 0 && progress.episodes_done == progress.num_episodes && !ended_;
  if (progress.seconds < next_line_ && !is_end) return;
  spdlog::info("{}", progressLine(progress, *first_));
  next_line_ = progress.seconds + static_cast<double>(kLogInterval.count());
  ended_ = ended_ || is_end;
}

void ProgressPrinter::clear() {
  StatusLine::instance().clear();
}

}  // namespace taxelsim::cli
