#include "characterize/stamp_selection.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "characterize/clipped_mean.h"

namespace taxelsim {
namespace {

using namespace stamp_own;
using namespace stamp_shared;

constexpr std::size_t kLeastImagesForGains = 6;
constexpr double kLeastGainDeviation = 0.02, kMostGainDeviation = 1.5;  // bounds of the prior's width
constexpr std::array<double, 8> kRelativeNoises{0, 0.01, 0.02, 0.03, 0.05, 0.07, 0.1, 0.15};
constexpr double kLikelihoodRatio = 5.4;  // half of chi-squared of 1 degree of freedom at 0.001
// Gains that depend on the load: half of chi-squared of 2 degrees of freedom at 0.01, because loads are few.
constexpr double kLoadRatio = 4.6;
constexpr std::size_t kLeastLoads = 5, kMostPresses = 100;

// Standard deviation (counts) of unclipped readings.
double noiseOf(const StampModel& model, const StampFit& found) {
  double squares = 0, count = 0;
  for (std::size_t g = 0; g < model.stamps.size(); ++g) {
    for (std::size_t k = 0; k < model.stamps[g].taxels.size(); ++k) {
      const double counts = model.stamps[g].image[model.stamps[g].taxels[k]];
      if (found.fit.outlier[g][k] || counts <= 0 || counts >= model.curve.top) continue;
      squares += found.fit.residual[g][k] * found.fit.residual[g][k];
      ++count;
    }
  }
  const double used = static_cast<double>(found.fit.num_rows - found.fit.num_outliers);
  const double freedom = std::max(1.0, count - (used - static_cast<double>(found.fit.degrees_of_freedom)));
  return std::max(kLeastNoise, std::sqrt(squares / freedom));
}

// Standard deviation of the press gain, from the best scale of each image; 0 if noise alone explains the scatter (chi-squared test).
double pressSpread(const StampModel& model, const StampFit& found) {
  constexpr double kStep = 1e-4;  // relative
  double squares = 0, expected = 0, chi = 0;
  const auto count = static_cast<double>(model.stamps.size());
  for (std::size_t g = 0; g < model.stamps.size(); ++g) {
    double product = 0, power = 0;
    for (const std::size_t t : model.stamps[g].taxels) {
      const double counts = model.stamps[g].image[t], force = found.force[g][t], weight = std::pow(model.stamps[g].weightOf(t), 2);
      if (counts <= 0 || counts >= model.curve.top) continue;
      const auto output = [&](double press) { return outputOf(model, model.stamps[g], found.fit.shared, t, press * force); };
      const double growth = (output(1 + kStep) - output(1 - kStep)) / (2 * kStep);
      product += weight * (counts - output(1)) * growth;
      power += weight * growth * growth;
    }
    if (!(power > 0)) continue;
    const double off = product / power, variance = model.curve.noise * model.curve.noise / power;
    squares += off * off, expected += variance, chi += off * off / variance;
  }
  const bool significant = model.stamps.size() >= 3 && chi > count + 4 * std::sqrt(2 * count);
  return significant ? std::sqrt(std::max(0.0, squares - expected) / (count - 1)) : 0;
}

// Start values: position at the centroid of the image, yaw 0, no tilt.
std::vector<std::vector<double>> startOf(const StampModel& model) {
  const std::vector<Vector3> positions = taxelPositions(*model.sensor);
  std::vector<std::vector<double>> own;
  for (const Stamp& stamp : model.stamps) {
    double x = 0, y = 0, sum = 0;
    for (std::size_t t = 0; t < stamp.image.size(); ++t) {
      x += stamp.image[t] * positions[t][0], y += stamp.image[t] * positions[t][1], sum += stamp.image[t];
    }
    own.push_back({x / sum, y / sum, 0, 0, 0, 1});
  }
  return own;
}

// Standard deviation of a prior whose values have these variances around their fitted deviations (empirical Bayes).
class PriorWidth {
 public:
  void add(double deviation, double variance) {
    if (!std::isfinite(variance)) return;
    squares_ += deviation * deviation + variance;
    ++count_;
  }
  double orElse(double otherwise, double least, double most) const {
    return count_ > 1 ? std::clamp(std::sqrt(squares_ / count_), least, most) : otherwise;
  }

 private:
  double squares_ = 0, count_ = 0;
};

void updatePriors(StampModel& model, const StampFit& found) {
  PriorWidth gains, offsets;
  for (std::size_t t = 0; t < model.gain.size(); ++t) {
    if (!model.isLoaded(t)) continue;
    const auto variance = [&](std::size_t p) { return found.fit.covariance(static_cast<Eigen::Index>(p), static_cast<Eigen::Index>(p)); };
    const double gain = gainOf(model, found, t);
    gains.add(std::log(gain / model.gain[t]), variance(model.gainsAt() + t) / (gain * gain));
    offsets.add(found.fit.shared[model.offsetsAt() + t], variance(model.offsetsAt() + t));
  }
  if (model.with_gains) model.gain_deviation = gains.orElse(model.gain_deviation, kLeastGainDeviation, kMostGainDeviation);
  if (model.with_offsets) model.offset_deviation = offsets.orElse(model.offset_deviation, kLeastNoise, model.curve.top);
}

// Estimates the part of the noise that is proportional to the reading, by maximum likelihood, and weighs the readings by it. Keeps
// or restores equal weights unless the likelihood ratio is significant.
void weighReadings(StampModel& model, const StampFit& found) {
  struct Reading {
    double residual, mean;
  };
  std::vector<Reading> readings;
  for (std::size_t g = 0; g < model.stamps.size(); ++g) {
    const Stamp& stamp = model.stamps[g];
    for (std::size_t k = 0; k < stamp.taxels.size(); ++k) {
      const double counts = stamp.image[stamp.taxels[k]], off = found.fit.residual[g][k] / stamp.weightOf(stamp.taxels[k]);
      if (!found.fit.outlier[g][k] && counts > 0 && counts < model.curve.top) readings.push_back({off, std::max(0.0, counts + off)});
    }
  }
  const auto logLikelihood = [&](double noise, double relative) {
    double sum = 0;
    for (const Reading& reading : readings) {
      const double variance = noise * noise + std::pow(relative * reading.mean, 2);
      sum -= std::log(variance) / 2 + reading.residual * reading.residual / (2 * variance);
    }
    return sum;
  };
  struct Best {
    double likelihood = -1e300, noise = 0, relative = 0;
  };
  Best equal, best;
  for (const double relative : kRelativeNoises) {
    for (double noise = kLeastNoise; noise < model.curve.top; noise *= 1.1) {
      const double likelihood = logLikelihood(noise, relative);
      if (likelihood > best.likelihood) best = {likelihood, noise, relative};
      if (relative == 0 && likelihood > equal.likelihood) equal = {likelihood, noise, relative};
    }
  }
  if (!(best.likelihood - equal.likelihood > kLikelihoodRatio)) {
    for (Stamp& stamp : model.stamps) stamp.weight.clear();
    return;
  }
  model.curve.noise = best.noise;
  for (std::size_t g = 0; g < model.stamps.size(); ++g) {
    Stamp& stamp = model.stamps[g];
    stamp.weight.clear();
    for (std::size_t t = 0; t < stamp.image.size(); ++t) {
      const double mean = std::clamp(outputOf(model, stamp, found.fit.shared, t, found.force[g][t]), 0.0, model.curve.top);
      stamp.weight.push_back(best.noise / std::hypot(best.noise, best.relative * mean));
    }
  }
}

class Selection {
 public:
  explicit Selection(StampModel& model) : model_(model) {}

  StampFit run(std::vector<std::string>& remarks);

 private:
  StampFit fitted(const StampModel& model, const StampFit& from) const {
    StampFit result = fitStampModel(model, from.fit.shared, from.fit.own);
    result.curve = from.curve;
    return result;
  }
  // Updates the noise and the widths of the priors, refits, and updates the noise again.
  void refit(StampModel& model, StampFit& found) const {
    model.curve.noise = noiseOf(model, found);
    updatePriors(model, found);
    found = fitted(model, found);
    model.curve.noise = noiseOf(model, found);
  }
  // The noise and the widths of the priors depend on each other.
  void refitUntilConverged(StampModel& model, StampFit& found) const {
    constexpr int kRounds = 6;
    constexpr double kSettled = 0.02;  // relative change of the noise
    for (int round = 0; round < kRounds; ++round) {
      const double before = model.curve.noise;
      refit(model, found);
      if (std::abs(model.curve.noise - before) < kSettled * before) break;
    }
  }
  // Accepts the larger model, with `more` additional parameters, if an F test rejects the current one.
  bool acceptIfBetter(const StampModel& larger, StampFit other, double more, StampFit& found) const {
    const double noise = noiseOf(larger, other), freedom = static_cast<double>(other.fit.degrees_of_freedom);
    if (!isBetterFit(cutSquares(found.fit, noise), cutSquares(other.fit, noise), more, freedom)) return false;
    model_ = larger;
    model_.curve.noise = noise;
    found = std::move(other);
    return true;
  }
  // Tries a curve with a limit (voltage divider), and one with a limit and a quadratic term x + b x^2, b >= 0.
  void bendCurve(StampFit& found) const;
  // Fits gains of presses if they differ significantly. Their prior's width is estimated from the gains themselves (empirical Bayes).
  void fitPressGains(StampModel& model, StampFit& found) const;
  void chooseCurveOrPresses(StampFit& found);
  // Lets the gains of presses depend on the load if the evidence says so.
  void shareGainsOfLoads(StampFit& found);
  // Fits an offset of each loaded taxel's trigger if they improve the fit significantly.
  void chooseOffsets(StampFit& found);

  StampModel& model_;
};

void Selection::chooseOffsets(StampFit& found) {
  StampModel larger = model_;
  larger.with_offsets = true;
  StampFit other = fitted(larger, found);
  refitUntilConverged(larger, other);
  double num_loaded = 0;
  for (std::size_t t = 0; t < model_.gain.size(); ++t) num_loaded += model_.isLoaded(t) ? 1 : 0;
  acceptIfBetter(larger, std::move(other), num_loaded, found);
}

void Selection::fitPressGains(StampModel& model, StampFit& found) const {
  // More rounds would let press gains absorb the misfit of the rest of the model.
  constexpr int kRounds = 2;
  model.press_spread = pressSpread(model, found);
  const auto count = static_cast<double>(model.stamps.size());
  for (int round = 0; model.press_spread > 0 && round < kRounds; ++round) {
    refit(model, found);
    double squares = 0;
    for (std::size_t g = 0; g < model.stamps.size(); ++g) {
      squares += (found.fit.own[g][kPress] - 1) * (found.fit.own[g][kPress] - 1) + found.fit.own_variance[g][kPress];
    }
    const double before = std::exchange(model.press_spread, std::sqrt(squares / count));
    if (std::abs(model.press_spread - before) < 0.02 * before) break;
  }
}

void Selection::bendCurve(StampFit& found) const {
  StampModel limited = model_, bent = model_;
  limited.curve.divider = bent.curve.divider = true;
  bent.curve.num_bends = 1;
  // New parameters are inserted before the gains and start at 0.
  const auto start = [&](std::size_t count) {
    std::vector<double> shared = found.fit.shared;
    shared.insert(shared.begin() + kCurve, count, 0.0);
    return shared;
  };
  StampFit with_limit = fitStampModel(limited, start(1), found.fit.own), with_both = fitStampModel(bent, start(2), found.fit.own);
  const bool taken = acceptIfBetter(limited, std::move(with_limit), 1, found);
  if (acceptIfBetter(bent, std::move(with_both), taken ? 1 : 2, found) || taken) refit(model_, found);
}

// Press gains and a bent curve explain the same residuals. Keeps the curve if it reduces the spread of press gains significantly, at a
// level of 0.05 because presses are few.
void Selection::chooseCurveOrPresses(StampFit& found) {
  StampModel straight = model_;
  StampFit straight_fit = found;
  bendCurve(found);
  const std::size_t num_curve_numbers = model_.curve.lag();
  if (num_curve_numbers > 0) found.curve = found.fit;
  fitPressGains(straight, straight_fit);
  if (!(straight.press_spread > 0)) return;
  fitPressGains(model_, found);
  const auto presses = static_cast<double>(model_.stamps.size() - 1), more = static_cast<double>(num_curve_numbers);
  if (num_curve_numbers > 0 && !isBetterFit(presses * straight.press_spread * straight.press_spread,
                                            presses * model_.press_spread * model_.press_spread, more, presses - more, kOneInTwenty)) {
    model_ = std::move(straight);
    found = std::move(straight_fit);
  }
}

// Moves the mean of log(press gain), weighted by the counts of the presses, to the scale: the gains are then deviations from the gain of
// the sensor. The fitted readings stay.
void centreGains(const StampModel& model, StampFit& found) {
  const auto presses = static_cast<Eigen::Index>(model.pressesAt()), count = static_cast<Eigen::Index>(model.stamps.size());
  const auto scale_at = static_cast<Eigen::Index>(kScale);
  Eigen::VectorXd weights(count);
  for (Eigen::Index g = 0; g < count; ++g) {
    const std::vector<double>& image = model.stamps[static_cast<std::size_t>(g)].image;
    weights[g] = std::accumulate(image.begin(), image.end(), 0.0);
  }
  weights /= weights.sum();
  std::vector<double>& shared = found.fit.shared;
  const double mean = weights.dot(Eigen::Map<const Eigen::VectorXd>(&shared[model.pressesAt()], count)), factor = std::exp(mean);
  const double scale = shared[kScale];
  shared[kScale] *= factor;
  for (Eigen::Index g = 0; g < count; ++g) shared[static_cast<std::size_t>(presses + g)] -= mean;
  for (std::vector<double>& forces : found.force) {
    for (double& force : forces) force /= factor;
  }
  // d(scale') = factor (d(scale) + scale w' d(gains)); d(gains') = d(gains) - w' d(gains).
  Eigen::MatrixXd& covariance = found.fit.covariance;
  const auto transform = [&](Eigen::Ref<Eigen::MatrixXd> rows) {
    const Eigen::RowVectorXd of_mean = weights.transpose() * rows.middleRows(presses, count);
    rows.row(scale_at) = factor * (rows.row(scale_at) + scale * of_mean);
    rows.middleRows(presses, count).rowwise() -= of_mean;
  };
  transform(covariance);
  covariance.transposeInPlace();
  transform(covariance);
}

void Selection::shareGainsOfLoads(StampFit& found) {
  constexpr int kRounds = 5;
  std::vector<double> loads = model_.loads();
  std::sort(loads.begin(), loads.end());
  const auto num_loads = static_cast<std::size_t>(std::unique(loads.begin(), loads.end()) - loads.begin());
  if (!(model_.press_spread > 0) || num_loads < kLeastLoads || model_.stamps.size() > kMostPresses) return;

  StampModel joint = model_;
  joint.press_prior = PressPrior{.load_spread = 0, .length = 1, .press_spread = model_.press_spread};
  StampFit start = found;
  for (std::vector<double>& own : start.fit.own) {
    if (own.size() <= kPress) continue;  // the group of the priors
    start.fit.shared.push_back(std::log(own[kPress]));
    own[kPress] = 1;
  }
  StampFit other = fitted(joint, start);
  const auto presses = static_cast<Eigen::Index>(joint.pressesAt()), count = static_cast<Eigen::Index>(joint.stamps.size());
  double gain = 0;
  for (int round = 0; round < kRounds; ++round) {
    weighReadings(joint, other);
    refit(joint, other);
    const Eigen::MatrixXd covariance = other.fit.covariance.block(presses, presses, count, count);
    if (!covariance.allFinite()) return;
    const Eigen::VectorXd gains = Eigen::Map<const Eigen::VectorXd>(&other.fit.shared[joint.pressesAt()], count);
    const PressPriorChoice choice = choosePressPrior(joint.loads(), gains, covariance, *joint.press_prior);
    gain = choice.gain;
    if (gain <= kLoadRatio || choice.prior == *joint.press_prior) break;
    joint.press_prior = choice.prior;
  }
  if (gain <= kLoadRatio || !(joint.press_prior->load_spread > 0)) return;
  joint.press_spread = joint.press_prior->press_spread;
  centreGains(joint, other);
  model_ = std::move(joint);
  found = std::move(other);
}

StampFit Selection::run(std::vector<std::string>& remarks) {
  double counts = 0, load = 0;
  for (const Stamp& stamp : model_.stamps) {
    for (const double value : stamp.image) counts += value;
    load += stamp.data->load;
  }
  model_.chooseTaxels(false);
  StampFit found = fitStampModel(model_, {0.6 * model_.sigmaUnit(), counts / load, 0, std::log(model_.foundation.normal_contact_stiffness)},
                                 startOf(model_));
  model_.curve.noise = noiseOf(model_, found);
  model_.chooseTaxels(true);
  found = fitted(model_, found);
  model_.curve.noise = noiseOf(model_, found);
  model_.with_gains = !model_.knows_gains && model_.stamps.size() >= kLeastImagesForGains;
  if (model_.with_gains) {
    found = fitted(model_, found);
    refitUntilConverged(model_, found);
    chooseOffsets(found);
  }
  weighReadings(model_, found);
  refit(model_, found);
  chooseCurveOrPresses(found);
  shareGainsOfLoads(found);

  double num_free = 0;  // stamps without a fixture, which may be tilted
  for (const Stamp& stamp : model_.stamps) num_free += stamp.fixture ? 0 : 1;
  if (num_free == 0) return found;
  StampModel tilted = model_;
  tilted.with_tilt = true;
  if (acceptIfBetter(tilted, fitted(tilted, found), 2 * num_free, found)) {
    remarks.emplace_back("stamps are tilted significantly: their slopes are fitted");
  }
  return found;
}

}  // namespace

double gainOf(const StampModel& model, const StampFit& found, std::size_t taxel) {
  return found.fit.shared[model.gainsAt() + taxel];
}

StampFit selectStampModel(StampModel& model, std::vector<std::string>& remarks) {
  return Selection(model).run(remarks);
}

}  // namespace taxelsim
