// Fits gains to images under a pressure that is the same everywhere. Press p has the force A_p on each taxel; a taxel t reads
//   gain_t A_p share_t e^(scatter_tp) + noise,
// share_t being what the point spread function leaves of a uniform field, below 1 at most near the border. In logarithms of forces,
//   y_tp = log A_p + log gain_t + scatter + noise / (output's growth with the logarithm of the force),
// which weighted means along rows and columns solve in turn. The scatter per taxel and press is estimated from the residuals.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <utility>

#include "base/text.h"
#include "characterize/clipped_mean.h"
#include "characterize/fits.h"
#include "characterize/limits.h"
#include "characterize/statistics.h"
#include "reference/psf.h"
#include "reference/readout.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

constexpr double kClearOfNoise = 4;  // standard deviations that a reading must be above 0
// Scatter per taxel and press where one press cannot show it: between repeated presses of a real finger (docs/notes/validation.md).
constexpr double kUsualScatter = 0.04;
constexpr double kKnown = 1e6;  // degrees of freedom of intervals by a scatter that is not estimated
constexpr int kRounds = 50;

// One press: mean counts of each taxel over its frames.
struct MeanImage {
  std::vector<double> counts;  // (num_taxels)
  double frames = 0;
  double pressure = 0;  // Pa, 0 if not measured
};

struct Presses {
  std::vector<MeanImage> images;
  double noise = 0;  // counts, of a frame
};

Presses pressesOf(Measured measurements, double known_noise) {
  Presses presses;
  double squares = 0, freedom = 0;
  for (const Measurement* measurement : measurements) {
    const auto& uniform = std::get<UniformPress>(measurement->data);
    const std::size_t num_taxels = uniform.images.num_taxels, num_rows = uniform.images.counts.size() / num_taxels;
    std::map<int, std::vector<std::size_t>> rows;
    for (std::size_t row = 0; row < num_rows; ++row)
      rows[uniform.press.empty() ? static_cast<int>(row) : uniform.press[row]].push_back(row);
    for (const auto& [press, of_press] : rows) {
      MeanImage image{.counts = std::vector<double>(num_taxels), .frames = static_cast<double>(of_press.size())};
      for (const std::size_t row : of_press) {
        if (!uniform.pressure.empty()) image.pressure += uniform.pressure[row] / image.frames;
        for (std::size_t t = 0; t < num_taxels; ++t) image.counts[t] += uniform.images.counts[row * num_taxels + t] / image.frames;
      }
      for (const std::size_t row : of_press) {
        for (std::size_t t = 0; t < num_taxels; ++t) {
          if (image.counts[t] > kStill) squares += std::pow(uniform.images.counts[row * num_taxels + t] - image.counts[t], 2);
        }
      }
      freedom += (image.frames - 1) * static_cast<double>(std::count_if(image.counts.begin(), image.counts.end(),
                                                                        [](double counts) { return counts > kStill; }));
      presses.images.push_back(std::move(image));
    }
  }
  presses.noise = std::max(kLeastNoise, freedom > 0 ? std::sqrt(squares / freedom) : known_noise);
  return presses;
}

// A reading as the logarithm of a force.
struct LogReading {
  std::size_t press = 0, taxel = 0;
  double value = 0;
  double noise_variance = 0;
  double weight = 0;
  bool is_outlier = false;
};

class UniformFit {
 public:
  UniformFit(const Presses& presses, const Sensor& sensor);

  void solve();
  bool isRead(std::size_t taxel) const { return num_read_[taxel] >= leastRead(); }
  std::size_t numOutliers() const {
    return static_cast<std::size_t>(std::count_if(readings_.begin(), readings_.end(), [](const LogReading& r) { return r.is_outlier; }));
  }

  std::vector<double> log_gain;    // (num_taxels)
  std::vector<double> log_force;   // (presses)
  std::vector<double> gain_error;  // (num_taxels): standard deviation of log_gain
  std::vector<char> dead;          // (num_taxels)
  double scatter = 0;              // standard deviation per taxel and press
  std::size_t num_readings = 0;
  double freedom = 0;

 private:
  // Presses with a reading that a gain needs.
  std::size_t leastRead() const { return std::min<std::size_t>(log_force.size(), 2); }
  void weigh();
  void alternate();
  double residual(const LogReading& reading) const { return reading.value - log_force[reading.press] - log_gain[reading.taxel]; }

  std::vector<LogReading> readings_;
  std::vector<std::size_t> num_read_;  // (num_taxels)
};

UniformFit::UniformFit(const Presses& presses, const Sensor& sensor) {
  const auto num_taxels = static_cast<std::size_t>(numTaxels(sensor));
  log_gain.assign(num_taxels, 0), gain_error.assign(num_taxels, 0), dead.assign(num_taxels, 1), num_read_.assign(num_taxels, 0);
  log_force.assign(presses.images.size(), 0);
  const std::vector<double> share = reference::spread(sensor, std::vector<double>(num_taxels, 1.0));
  for (std::size_t p = 0; p < presses.images.size(); ++p) {
    const MeanImage& image = presses.images[p];
    const double noise = presses.noise / std::sqrt(image.frames);
    for (std::size_t t = 0; t < num_taxels; ++t) {
      const double counts = image.counts[t];
      if (counts > kStill) dead[t] = 0;
      // A mean that noise clips at an end of the range is biased.
      if (counts < kClearOfNoise * presses.noise || counts > sensor.readout.saturation - kClearOfNoise * presses.noise) continue;
      const double trigger = reference::triggerOf(sensor.readout, t) - sensor.readout.trigger;
      const double force = nominalForce(sensor.readout, counts) + trigger;
      if (!(force > 0)) continue;  // below the output at rest
      const double growth = (nominalForce(sensor.readout, counts + 0.5) - nominalForce(sensor.readout, counts - 0.5)) / force;
      readings_.push_back({.press = p, .taxel = t, .value = std::log(force / share[t]), .noise_variance = std::pow(noise * growth, 2)});
    }
  }
  for (const LogReading& reading : readings_) ++num_read_[reading.taxel];
  std::erase_if(readings_, [&](const LogReading& reading) { return !isRead(reading.taxel); });
}

// Weighted means of presses and of taxels in turn, until the gains rest.
void UniformFit::alternate() {
  constexpr int kMost = 200;
  constexpr double kRests = 1e-12;
  for (int round = 0; round < kMost; ++round) {
    const auto update = [&](std::vector<double>& values, const std::vector<double>& others, auto index, auto other) {
      std::vector<double> sum(values.size()), weight(values.size());
      for (const LogReading& r : readings_) {
        sum[index(r)] += r.weight * (r.value - others[other(r)]);
        weight[index(r)] += r.weight;
      }
      double most = 0;
      for (std::size_t k = 0; k < values.size(); ++k) {
        if (!(weight[k] > 0)) continue;
        most = std::max(most, std::abs(sum[k] / weight[k] - values[k]));
        values[k] = sum[k] / weight[k];
      }
      return most;
    };
    const auto press = [](const LogReading& r) { return r.press; };
    const auto taxel = [](const LogReading& r) { return r.taxel; };
    update(log_force, log_gain, press, taxel);
    if (update(log_gain, log_force, taxel, press) < kRests) break;
  }
}

void UniformFit::weigh() {
  for (LogReading& r : readings_) r.weight = r.is_outlier ? 0 : 1 / (scatter * scatter + r.noise_variance);
}

void UniformFit::solve() {
  constexpr double kConverged = 1e-6;
  scatter = kUsualScatter;
  for (int round = 0; round < kRounds; ++round) {
    weigh();
    alternate();
    // Scatter at which the weighted squares are what their degrees of freedom say; by bisection.
    std::vector<double> num_used(log_gain.size()), press_used(log_force.size());
    double used = 0;
    for (const LogReading& r : readings_) {
      if (r.is_outlier) continue;
      ++used, num_used[r.taxel] = 1, press_used[r.press] = 1;
    }
    double spent = -1;
    for (const double one : num_used) spent += one;
    for (const double one : press_used) spent += one;
    freedom = log_force.size() == 1 ? kKnown : used - spent;
    if (log_force.size() == 1) break;
    if (!(freedom >= 1)) return;
    const auto squares = [&](double trial) {
      double sum = 0;
      for (const LogReading& r : readings_) {
        if (!r.is_outlier) sum += std::pow(residual(r), 2) / (trial * trial + r.noise_variance);
      }
      return sum;
    };
    double low = 0, high = 10;
    for (int step = 0; step < 60; ++step) {
      const double middle = (low + high) / 2;
      (squares(middle) > freedom ? low : high) = middle;
    }
    const double before = std::exchange(scatter, (low + high) / 2);
    bool changed = false;
    for (LogReading& r : readings_) {
      const bool is_outlier = std::abs(residual(r)) > kOutlier * std::sqrt(scatter * scatter + r.noise_variance);
      changed = changed || is_outlier != r.is_outlier;
      r.is_outlier = is_outlier;
    }
    if (!changed && std::abs(scatter - before) < kConverged) break;
  }
  std::vector<double> weight(log_gain.size());
  for (const LogReading& r : readings_) weight[r.taxel] += r.weight, num_readings += 1;
  for (std::size_t t = 0; t < weight.size(); ++t) {
    gain_error[t] = weight[t] > 0 ? 1 / std::sqrt(weight[t]) : std::numeric_limits<double>::infinity();
  }
}

std::string percent(double fraction) {
  return numberText(std::round(fraction * 1e3) / 10) + " %";
}

// Scatter of the gains of presses, where their pressures are known.
void reportPresses(const Presses& presses, const UniformFit& fit, Characterization& result) {
  std::vector<double> off;
  for (std::size_t p = 0; p < presses.images.size(); ++p) {
    if (presses.images[p].pressure > 0) off.push_back(fit.log_force[p] - std::log(presses.images[p].pressure));
  }
  if (off.size() < 3 || off.size() < presses.images.size()) return;
  double mean = 0, squares = 0;
  const auto count = static_cast<double>(off.size());
  for (const double value : off) mean += value / count;
  for (const double value : off) squares += (value - mean) * (value - mean);
  const double spread = std::sqrt(squares / (count - 1));
  const double factor = std::exp(studentFactor(off.size() - 1) / std::sqrt(2 * (count - 1)));
  result.estimates.push_back({.parameter = "readout.press_gain_spread",
                              .unit = "",
                              .determined = true,
                              .value = spread,
                              .low = spread / factor,
                              .high = spread * factor,
                              .remark = "between " + std::to_string(off.size()) + " uniform presses"});
  result.sensor.readout.press_gain_spread = std::min(spread, kMaxGainSpread);
  const GridPatch& patch = result.sensor.patches[0];
  result.remarks.push_back("uniform presses: force read / (pressure x area of a taxel) has a mean of " +
                           numberText(std::round(std::exp(mean) / (patch.pitch[0] * patch.pitch[1]) * 1e3) / 1e3));
}

}  // namespace

ReadoutCovariance fitUniformPress(Measured measurements, Characterization& result) {
  const Presses presses = pressesOf(measurements, result.sensor.readout.noise);
  const std::string file = measurements.front()->file.generic_string();
  UniformFit fit(presses, result.sensor);
  const auto num_taxels = static_cast<std::size_t>(numTaxels(result.sensor));
  double count = 0;
  for (std::size_t t = 0; t < num_taxels; ++t) count += fit.isRead(t) ? 1 : 0;
  if (count < 2) {
    throw Error(ErrorKind::kInput, file + ": " + numberText(count) + " taxels read between 0 and saturation" +
                                       (presses.images.size() > 1 ? " in two presses" : "") + ", at least two are needed");
  }
  fit.solve();
  if (!(fit.freedom >= 1)) throw Error(ErrorKind::kInput, file + ": too few readings between 0 and saturation for intervals");
  double mean = 0;
  for (std::size_t t = 0; t < num_taxels; ++t) mean += fit.isRead(t) ? std::exp(fit.log_gain[t]) / count : 0;
  double mean_variance = 0;  // of the logarithm of the mean
  for (std::size_t t = 0; t < num_taxels; ++t) {
    if (fit.isRead(t)) mean_variance += std::pow(std::exp(fit.log_gain[t]) / (mean * count) * fit.gain_error[t], 2);
  }
  std::vector<double>& gains = result.sensor.readout.taxel_gain;
  gains.assign(num_taxels, 1);
  ReadoutCovariance covariance(num_taxels, {0, 0, 0, 0});
  const double factor = studentFactor(static_cast<std::size_t>(fit.freedom));
  std::size_t num_missing = 0;
  for (std::size_t t = 0; t < num_taxels; ++t) {
    if (fit.dead[t] != 0) {
      gains[t] = 0;
      result.dead_taxels.push_back(static_cast<int>(t));
    } else if (!fit.isRead(t)) {
      ++num_missing;
    } else {
      gains[t] = std::exp(fit.log_gain[t]) / mean;
      const double part = gains[t] / count;  // of the mean
      const double error = gains[t] * std::sqrt(std::max(0.0, (1 - 2 * part) * fit.gain_error[t] * fit.gain_error[t] + mean_variance));
      covariance[t][0] = error * error;
      result.estimates.push_back({.parameter = "readout.taxel_gain[" + std::to_string(t) + "]",
                                  .unit = "",
                                  .determined = std::isfinite(error),
                                  .value = gains[t],
                                  .low = gains[t] - factor * error,
                                  .high = gains[t] + factor * error,
                                  .remark = ""});
    }
  }
  if (num_missing > 0) {
    result.remarks.push_back(std::to_string(num_missing) + " taxels read 0 or are saturated under the uniform presses: their gain stays 1");
  }
  result.remarks.push_back("uniform presses: scatter of " + percent(fit.scatter) + " per taxel and press" +
                           (presses.images.size() > 1 ? "" : " assumed, since one press does not show it") + ", next to " +
                           numberText(std::round(presses.noise * 10) / 10) + " counts of noise");
  reportPresses(presses, fit, result);
  result.fits.push_back({.measurement = namesOf(measurements),
                         .unit = "% of a reading",
                         .rms = 100 * fit.scatter,
                         .num_rows = fit.num_readings,
                         .num_outliers = fit.numOutliers()});
  return covariance;
}

}  // namespace taxelsim
