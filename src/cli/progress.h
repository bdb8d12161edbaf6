// Prints progress: a bar on a terminal, or a line every few seconds and one at the end in a log.
#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "taxelsim/progress.h"

namespace taxelsim::cli {

inline constexpr std::chrono::seconds kLogInterval{5};  // between lines in a log

class ProgressPrinter {
 public:
  ProgressPrinter() = default;
  ~ProgressPrinter() { clear(); }
  ProgressPrinter(const ProgressPrinter&) = delete;
  ProgressPrinter& operator=(const ProgressPrinter&) = delete;

  void show(const Progress& progress);
  // Removes the bar.
  void clear();

 private:
  std::optional<Progress> first_;
  double next_line_ = 0;  // s, of Progress::seconds
  bool ended_ = false;    // whether there was a line with all episodes
};

// "[####......]  40 %  400 of 1,000 episodes  12,345 frames/s  1:23 left", at most `width` characters. Bar, percentage and time left count
// frames: all episodes of a batch end at the same time. `first`: an earlier report of the same run; the time left follows from the frames
// since then, because the first frame waits until the driver has compiled the kernels.
std::string progressBar(const Progress& progress, const Progress& first, int width);
// The same without the bar.
std::string progressLine(const Progress& progress, const Progress& first);

}  // namespace taxelsim::cli
