// Shows a run: the seconds until its first frame, then its progress.
#pragma once

#include <spdlog/spdlog.h>

#include <utility>

#include "cli/activity.h"
#include "cli/progress.h"
#include "figures/text.h"

namespace taxelsim::cli {

class RunDisplay {
 public:
  // Before the first frame.
  Activity& activity() { return activity_; }

  void show(const Progress& progress) {
    activity_.end();
    if (!std::exchange(is_shown_, true) && progress.episodes_resumed > 0)
      spdlog::info("{} episodes found on disk", figures::countText(progress.episodes_resumed));
    printer_.show(progress);
  }

  void end() {
    activity_.end();
    printer_.clear();
  }

 private:
  Activity activity_{"preparing the simulation"};
  ProgressPrinter printer_;
  bool is_shown_ = false;
};

}  // namespace taxelsim::cli
