#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <vector>

#include "taxelsim/characterize.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

// Logarithms of the fitted gains of live taxels.
std::vector<double> logGainsOf(const Characterization& fitted) {
  std::vector<double> logs;
  for (const Estimate& estimate : fitted.estimates)
    if (estimate.determined && estimate.value > 0 && estimate.parameter.starts_with("readout.taxel_gain["))
      logs.push_back(std::log(estimate.value));
  return logs;
}

// Multiplies the gain of all taxels: the curve of `gain` x, with the trigger in newtons of x.
void scaleGain(Readout& readout, double gain) {
  double power = 1;
  if (readout.curve_points.empty())
    for (double& coefficient : readout.curve) coefficient *= power *= gain;
  for (CurvePoint& point : readout.curve_points) point.force /= gain;
  readout.trigger /= gain;
}

// Standard deviation; none of fewer than two values.
std::optional<double> deviationOf(const std::vector<double>& values) {
  if (values.size() < 2) return {};
  const double num = static_cast<double>(values.size());
  double sum = 0, squares = 0;
  for (const double value : values) sum += value, squares += value * value;
  return std::sqrt(std::max(squares - sum * sum / num, 0.0) / (num - 1));
}

}  // namespace

std::optional<double> gainSpreadOf(const Characterization& fitted) {
  return deviationOf(logGainsOf(fitted));
}

Sensor withRandomGains(const Characterization& fitted) {
  const std::vector<double> logs = logGainsOf(fitted);
  const std::optional<double> spread = deviationOf(logs);
  if (!spread) throw Error(ErrorKind::kInput, "the measurements determine the gains of fewer than two taxels: they have no scatter");
  const double mean = std::accumulate(logs.begin(), logs.end(), 0.0) / static_cast<double>(logs.size());
  Sensor sensor = fitted.sensor;
  Readout& readout = sensor.readout;
  readout.taxel_gain.clear();
  readout.taxel_trigger.clear();
  readout.gain_spread = std::min(*spread, kMaxGainSpread);
  scaleGain(readout, std::exp(mean));
  return sensor;
}

}  // namespace taxelsim
