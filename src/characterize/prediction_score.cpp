#include "characterize/prediction_score.h"

#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "base/constants.h"
#include "base/median.h"

namespace taxelsim {
namespace {

// x and y of the centre of the counts, m; NaN for an image of zeros.
std::array<double, 2> centreOf(const std::vector<Vector3>& positions, std::span<const double> counts) {
  double x = 0, y = 0, sum = 0;
  for (std::size_t t = 0; t < counts.size(); ++t) x += counts[t] * positions[t][0], y += counts[t] * positions[t][1], sum += counts[t];
  return {x / sum, y / sum};
}

double medianOrNan(std::vector<double> values) {
  std::erase_if(values, [](double value) { return !std::isfinite(value); });
  return values.empty() ? kNaN : medianOf(std::move(values));
}

}  // namespace

PredictionScore scoreOf(std::span<const double> predicted, std::span<const double> real, double full_scale) {
  std::vector<double> differences;  // where either is above 0
  double difference = 0, predicted_sum = 0, real_sum = 0, predicted_active = 0, real_active = 0;
  for (std::size_t k = 0; k < real.size(); ++k) {
    const double off = std::abs(predicted[k] - real[k]);
    if (predicted[k] > 0 || real[k] > 0) differences.push_back(off / full_scale);
    difference += off, predicted_sum += predicted[k], real_sum += real[k];
    predicted_active += predicted[k] > 0 ? 1 : 0, real_active += real[k] > 0 ? 1 : 0;
  }
  const auto ratio = [](double a, double b) { return b > 0 ? a / b : kNaN; };
  return {.measurement = {},
          .load = 0,
          .median_difference = medianOrNan(std::move(differences)),
          .relative_l1 = ratio(difference, real_sum),
          .sum_ratio = ratio(predicted_sum, real_sum),
          .center_distance = kNaN,
          .active_ratio = ratio(predicted_active, real_active)};
}

PredictionScore scoreOfImage(const Sensor& sensor, std::span<const double> predicted, std::span<const double> real) {
  PredictionScore score = scoreOf(predicted, real, (1 << sensor.readout.adc_bits) - 1);
  const std::vector<Vector3> positions = taxelPositions(sensor);
  const std::array<double, 2> a = centreOf(positions, predicted), b = centreOf(positions, real);
  score.center_distance = std::hypot(a[0] - b[0], a[1] - b[1]);
  return score;
}

PredictionScore scoreOfMeanPress(const Sensor& sensor, std::span<const std::vector<double>> others, std::span<const double> real) {
  const auto count = static_cast<double>(others.size());  // without others 0 / 0 is NaN
  std::vector<double> mean(real.size());
  for (std::size_t t = 0; t < mean.size(); ++t) {
    for (const std::vector<double>& image : others) mean[t] += image[t];
    mean[t] /= count;
  }
  PredictionScore score = scoreOfImage(sensor, mean, real);
  const double part = std::sqrt(count / (count + 1));
  score.median_difference *= part;
  score.relative_l1 *= part;
  score.sum_ratio = 1 + part * (score.sum_ratio - 1);
  score.center_distance *= part;
  score.active_ratio = kNaN;
  return score;
}

PredictionScore medianScore(const Predictor& predictor, double from, double to) {
  std::vector<double> m1, m4, sum, centre, active;
  for (const PredictionScore& score : predictor.scores) {
    if (!(score.load >= from && score.load < to)) continue;
    m1.push_back(score.median_difference);
    m4.push_back(score.relative_l1);
    sum.push_back(std::abs(score.sum_ratio - 1));
    centre.push_back(score.center_distance);
    active.push_back(std::abs(score.active_ratio - 1));
  }
  return {.measurement = {},
          .load = from,
          .median_difference = medianOrNan(std::move(m1)),
          .relative_l1 = medianOrNan(std::move(m4)),
          .sum_ratio = medianOrNan(std::move(sum)),
          .center_distance = medianOrNan(std::move(centre)),
          .active_ratio = medianOrNan(std::move(active))};
}

}  // namespace taxelsim
