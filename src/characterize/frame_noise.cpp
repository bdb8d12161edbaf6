#include "characterize/frame_noise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "characterize/clipped_mean.h"
#include "characterize/creep.h"
#include "characterize/stamp_model.h"
#include "characterize/statistics.h"

namespace taxelsim {
namespace {

constexpr double kCreepsSlowly = 3;       // s after contact
constexpr std::size_t kFramesPerLag = 4;  // frames of a series for each frame of its longest lag
constexpr std::size_t kLeastFrames = 12;  // a shorter series is left out

double meanOfSecondDifferences(const std::vector<double>& series, std::size_t lag) {
  double sum = 0;
  const std::size_t count = series.size() - 2 * lag;
  for (std::size_t k = 0; k < count; ++k) sum += std::pow(series[k] - 2 * series[k + lag] + series[k + 2 * lag], 2);
  return sum / static_cast<double>(count);
}

// Least squares over lags 1, 2, 4, ... with weights 1 / lag: intercept and slope per frame of the second differences.
std::array<double, 2> lineOver(const std::vector<double>& series) {
  double weights = 0, lags = 0, squares = 0, values = 0, products = 0;
  for (std::size_t lag = 1; kFramesPerLag * lag <= series.size(); lag *= 2) {
    const double x = static_cast<double>(lag), weight = 1 / x, y = meanOfSecondDifferences(series, lag);
    weights += weight, lags += weight * x, squares += weight * x * x, values += weight * y, products += weight * x * y;
  }
  const double slope = (weights * products - lags * values) / (weights * squares - lags * lags);
  return {(values - slope * lags) / weights, slope};
}

struct MeanOfSeries {
  double mean = 0, half = 0;
};

MeanOfSeries meanOfSeries(const std::vector<double>& values) {
  const auto count = static_cast<double>(values.size());
  if (values.size() < 2) return {values.empty() ? 0 : values.front(), std::numeric_limits<double>::infinity()};
  double mean = 0, squares = 0;
  for (const double value : values) mean += value / count;
  for (const double value : values) squares += std::pow(value - mean, 2);
  return {mean, studentFactor(values.size() - 1) * std::sqrt(squares / (count - 1) / count)};
}

}  // namespace

FrameNoise frameNoiseOf(std::span<const Stamp> stamps, double top) {
  std::vector<double> variances, walks;
  for (const Stamp& stamp : stamps) {
    const Images& images = stamp.data->images;
    const Onset onset = onsetOf(stamp.sum);
    std::size_t first = onset.first_row;
    while (first < onset.end_row && images.time[first] < onset.start + kCreepsSlowly) ++first;
    if (onset.end_row < first + kLeastFrames) continue;
    const double dt = (images.time[onset.end_row - 1] - images.time[first]) / static_cast<double>(onset.end_row - 1 - first);
    for (std::size_t t = 0; t < images.num_taxels; ++t) {
      std::vector<double> series;
      for (std::size_t row = first; row < onset.end_row; ++row) series.push_back(images.counts[row * images.num_taxels + t]);
      if (std::any_of(series.begin(), series.end(), [&](double counts) { return counts <= 0 || counts >= top; })) continue;
      const std::array<double, 2> line = lineOver(series);
      variances.push_back(line[0] / 6 - kLeastNoise * kLeastNoise);
      walks.push_back(line[1] / 2 / dt);
    }
  }
  const MeanOfSeries white = meanOfSeries(variances), walk = meanOfSeries(walks);
  return {.variance = white.mean, .variance_half = white.half, .walk = walk.mean, .walk_half = walk.half, .num_series = walks.size()};
}

}  // namespace taxelsim
