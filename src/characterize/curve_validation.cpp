#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include "base/median.h"
#include "characterize/prediction_score.h"
#include "characterize/validation_parts.h"
#include "reference/lag.h"
#include "reference/psf.h"
#include "reference/readout.h"

namespace taxelsim {
namespace {

constexpr double kLoaded = 0.2,
                 kCycleEnd = 0.1;  // of the largest force: a cycle begins when the force has been above one and falls below the other
constexpr std::size_t kLeastCycles = 4;
constexpr std::size_t kBins = 32;  // of force, for the median of the other half

using Rows = std::vector<std::size_t>;

double largestForceOf(const ForceCurve& curve) {
  return *std::max_element(curve.force.begin(), curve.force.end());
}

// Number of the cycle of each row, (rows).
std::vector<std::size_t> cyclesOf(const ForceCurve& curve) {
  const double most = largestForceOf(curve);
  std::vector<std::size_t> cycles;
  std::size_t cycle = 0;
  bool is_loaded = false;
  for (const double force : curve.force) {
    if (force > kLoaded * most) is_loaded = true;
    if (is_loaded && force < kCycleEnd * most) is_loaded = false, ++cycle;
    cycles.push_back(cycle);
  }
  return cycles;
}

// Odd and even cycles, or the halves.
std::array<Rows, 2> partsOf(const ForceCurve& curve) {
  const std::vector<std::size_t> cycles = cyclesOf(curve);
  std::array<Rows, 2> parts;
  for (std::size_t row = 0; row < cycles.size(); ++row) {
    parts[cycles.back() >= kLeastCycles ? cycles[row] % 2 : row < cycles.size() / 2 ? 0 : 1].push_back(row);
  }
  return parts;
}

ForceCurve rowsOf(const ForceCurve& curve, const Rows& rows) {
  ForceCurve part = curve;
  part.taxel.clear(), part.force.clear(), part.counts.clear(), part.time.clear();
  for (const std::size_t row : rows) {
    part.taxel.push_back(curve.taxel[row]);
    part.force.push_back(curve.force[row]);
    part.counts.push_back(curve.counts[row]);
    if (!curve.time.empty()) part.time.push_back(curve.time[row]);
  }
  return part;
}

// The readout at rest: hysteresis in the order of the rows, without creep and other dynamics.
std::vector<double> predictedBySensor(Sensor sensor, const ForceCurve& curve) {
  constexpr double kStep = 1;  // s, any: only hysteresis is left, which does not depend on it
  sensor.readout.creep.clear();
  sensor.readout.low_pass_time = 0;
  sensor.readout.delay = 0;
  const auto num_taxels = static_cast<std::size_t>(numTaxels(sensor));
  std::map<int, reference::Lag> lags;
  std::map<int, double> shares;
  std::vector<double> predicted;
  for (std::size_t row = 0; row < curve.force.size(); ++row) {
    const auto taxel = static_cast<std::size_t>(curve.taxel[row]);
    std::vector<double> force(num_taxels);
    if (!shares.contains(curve.taxel[row])) {
      force[taxel] = 1;
      shares.emplace(curve.taxel[row], reference::spread(sensor, force)[taxel]);
      lags.emplace(curve.taxel[row], reference::Lag(sensor.readout, 1));
    }
    const std::array<double, 1> own{curve.force[row] * shares.at(curve.taxel[row])};
    force[taxel] = lags.at(curve.taxel[row]).step(own, kStep).front();
    predicted.push_back(reference::readOut(sensor, force)[taxel]);
  }
  return predicted;
}

// Straight line through the rows of each taxel by least squares, clipped at 0.
std::vector<double> predictedByLine(const ForceCurve& training, const ForceCurve& curve) {
  struct Sums {
    double n = 0, f = 0, c = 0, ff = 0, fc = 0;
  };
  std::map<int, Sums> sums;
  for (std::size_t row = 0; row < training.force.size(); ++row) {
    const double force = training.force[row], counts = training.counts[row];
    Sums& s = sums[training.taxel[row]];
    s.n += 1, s.f += force, s.c += counts, s.ff += force * force, s.fc += force * counts;
  }
  std::vector<double> predicted;
  for (std::size_t row = 0; row < curve.force.size(); ++row) {
    const Sums& s = sums[curve.taxel[row]];
    const double spread = s.n * s.ff - s.f * s.f, slope = spread > 0 ? (s.n * s.fc - s.f * s.c) / spread : 0;
    predicted.push_back(s.n > 0 ? std::max(0.0, (s.c - slope * s.f) / s.n + slope * curve.force[row]) : 0);
  }
  return predicted;
}

// Median reading of the training rows of the same taxel in the same bin of force; of the nearest bin with rows.
std::vector<double> predictedBySameForce(const ForceCurve& training, const ForceCurve& curve) {
  const double width = std::max(largestForceOf(training), 1e-30) / kBins;
  const auto binOf = [&](double force) { return std::clamp(std::floor(force / width), 0.0, kBins - 1.0); };
  std::map<int, std::map<double, std::vector<double>>> readings;
  for (std::size_t row = 0; row < training.force.size(); ++row) {
    readings[training.taxel[row]][binOf(training.force[row])].push_back(training.counts[row]);
  }
  std::map<int, std::map<double, double>> medians;
  for (auto& [taxel, bins] : readings) {
    for (auto& [bin, counts] : bins) medians[taxel][bin] = medianOf(std::move(counts));
  }
  std::vector<double> predicted;
  for (std::size_t row = 0; row < curve.force.size(); ++row) {
    const double bin = binOf(curve.force[row]);
    double value = 0, nearest = 1e300;
    for (const auto& [other, median] : medians[curve.taxel[row]]) {
      if (std::abs(other - bin) < nearest) nearest = std::abs(other - bin), value = median;
    }
    predicted.push_back(value);
  }
  return predicted;
}

}  // namespace

CrossValidation validateForceCurves(const std::vector<Measurement>& curves, const std::vector<Measurement>& others) {
  CrossValidation result{.left_out = "cycles or halves", .predictors = {}};
  for (const char* const name : {"fitted sensor", "zeros", "line in the force per taxel", "median of the other half at the same force"}) {
    result.predictors.push_back({.name = name, .is_baseline = !result.predictors.empty(), .scores = {}});
  }
  for (std::size_t m = 0; m < curves.size(); ++m) {
    const auto& whole = std::get<ForceCurve>(curves[m].data);
    const std::array<Rows, 2> parts = partsOf(whole);
    for (std::size_t scored = 0; scored < 2; ++scored) {
      const ForceCurve seen = rowsOf(whole, parts[1 - scored]), wanted = rowsOf(whole, parts[scored]);
      std::vector<Measurement> training = others;
      for (std::size_t k = 0; k < curves.size(); ++k) {
        Measurement& measurement = training.emplace_back(curves[k]);
        if (k == m) measurement.data = seen;
      }
      const Characterization fitted = timedFit(training, result.longest_fit);
      const Sensor at_temperature = curves[m].temperature ? sensorAt(fitted, *curves[m].temperature) : fitted.sensor;
      const std::array<std::vector<double>, 4> predictions{predictedBySensor(at_temperature, wanted),
                                                           std::vector<double>(wanted.counts.size()), predictedByLine(seen, wanted),
                                                           predictedBySameForce(seen, wanted)};
      for (std::size_t p = 0; p < predictions.size(); ++p) {
        PredictionScore score = scoreOf(predictions[p], wanted.counts, (1 << curves[m].sensor.readout.adc_bits) - 1);
        score.measurement = curves[m].name + (scored == 0 ? ", first part" : ", second part");
        score.load = largestForceOf(wanted);
        result.predictors[p].scores.push_back(std::move(score));
      }
    }
  }
  return result;
}

}  // namespace taxelsim
