#include <algorithm>
#include <cmath>

#include "characterize/creep.h"
#include "characterize/statistics.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

constexpr double kUnloaded = 0.05;  // of the level under load
constexpr std::size_t kLeastOnsetRows = 8;

}  // namespace

Onset onsetOf(const CreepSeries& series, double level) {
  const std::vector<double>& values = series.values;
  const auto fail = [&](const std::string& what) { throw Error(ErrorKind::kInput, series.file + ": " + what); };
  // The top 5 % of the rows may be outliers.
  std::vector<double> sorted = values;
  std::sort(sorted.begin(), sorted.end());
  const double top = sorted[static_cast<std::size_t>(0.95 * static_cast<double>(sorted.size() - 1))];
  if (!(top > 0)) fail("no contact: the output never rises for three rows");
  const double loaded = medianOf({std::upper_bound(sorted.begin(), sorted.end(), top / 2), sorted.end()});
  const double half = (level > 0 ? level : loaded) / 2;
  const auto above = [&](std::size_t row) { return values[row] >= half; };
  std::size_t row = 0;
  while (row + 2 < values.size() && !(above(row) && above(row + 1) && above(row + 2))) ++row;
  if (row + 2 >= values.size()) fail("no contact: the output never rises for three rows");
  if (row == 0) fail("the recording begins under load: rows before contact are needed");
  std::size_t last = values.size() - 1;
  while (!(above(last) && above(last - 1))) --last;
  const auto num_above = static_cast<std::size_t>(std::count_if(values.begin() + static_cast<std::ptrdiff_t>(row),
                                                                values.begin() + static_cast<std::ptrdiff_t>(last) + 1,
                                                                [&](double value) { return value >= half; }));
  if (10 * num_above < 9 * (last + 1 - row)) fail("the output does not rise once and stay: apply one load, once");
  std::size_t start = row - 1;
  while (start > 0 && values[start] > kUnloaded * loaded) --start;
  if (values[start] > kUnloaded * loaded) fail("the recording begins under load: rows before contact are needed");

  Onset onset;
  const double share = (half - values[row - 1]) / (values[row] - values[row - 1]);
  onset.time = series.time[row - 1] + std::clamp(share, 0.0, 1.0) * (series.time[row] - series.time[row - 1]);
  onset.start = series.time[start];
  const double rise = onset.time - onset.start;
  onset.deviation = std::hypot((series.time[row] - series.time[row - 1]) / std::sqrt(12.0), start + 1 < row ? rise / 10 : 0);
  onset.first_row = row;
  while (onset.first_row <= last && series.time[onset.first_row] < onset.time + 2 * rise) ++onset.first_row;
  // The load is removed within the recording: assumes that unloading takes as long as loading.
  onset.end_row = last + 1;
  if (last + 3 < values.size()) {
    while (onset.end_row > onset.first_row && series.time[onset.end_row - 1] > series.time[last] - 2 * rise) --onset.end_row;
  }
  if (onset.end_row < onset.first_row + kLeastOnsetRows) {
    fail(std::to_string(onset.end_row - std::min(onset.end_row, onset.first_row)) + " rows under the full load found, at least " +
         std::to_string(kLeastOnsetRows) + " needed");
  }
  return onset;
}

}  // namespace taxelsim
