#include "cli/activity.h"

#include <spdlog/spdlog.h>

#include <chrono>
#include <utility>

#include "cli/progress.h"
#include "cli/status_line.h"
#include "figures/text.h"

namespace taxelsim::cli {

Activity::Activity(std::string what) : what_(std::move(what)), thread_([this] { run(); }) {}

void Activity::next(std::string what) {
  const std::lock_guard lock(mutex_);
  what_ = std::move(what);
  restarted_ = true;
  changed_.notify_one();
}

void Activity::rename(std::string what) {
  const std::lock_guard lock(mutex_);
  what_ = std::move(what);
}

void Activity::end() {
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
    changed_.notify_one();
  }
  if (!thread_.joinable()) return;
  thread_.join();
  StatusLine::instance().clear();
}

void Activity::run() {
  using Clock = std::chrono::steady_clock;
  StatusLine& line = StatusLine::instance();
  const auto period = line.visible() ? std::chrono::milliseconds(500) : std::chrono::milliseconds(kLogInterval);
  std::unique_lock lock(mutex_);
  Clock::time_point start = Clock::now();
  while (!ended_) {
    const bool woken = changed_.wait_for(lock, period, [this] { return ended_ || restarted_; });
    if (ended_) return;
    if (std::exchange(restarted_, false)) start = Clock::now();
    if (woken) continue;
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    const std::string text = what_ + ": " + figures::durationText(seconds);
    if (line.visible()) {
      line.draw(text);
    } else {
      spdlog::info("{}", text);
    }
  }
}

}  // namespace taxelsim::cli
