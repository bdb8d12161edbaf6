// Prints progress: a bar on a terminal, or a line every few seconds in a log.
#pragma once

#include <string>

#include "taxelsim/progress.h"

namespace taxelsim::cli {

class ProgressPrinter {
 public:
  // Draws a bar if stderr is a terminal.
  ProgressPrinter();
  ~ProgressPrinter();
  ProgressPrinter(const ProgressPrinter&) = delete;
  ProgressPrinter& operator=(const ProgressPrinter&) = delete;

  void show(const Progress& progress);
  // Removes the bar.
  void clear();

 private:
  bool terminal_;
  bool drawn_ = false;
  double next_line_ = 0;  // s, of Progress::seconds
};

// "[####......]  40 %  400 of 1,000 episodes  12,345 frames/s  1:23 left", at most `width` characters.
std::string progressBar(const Progress& progress, int width);
// The same without the bar.
std::string progressLine(const Progress& progress);

}  // namespace taxelsim::cli
