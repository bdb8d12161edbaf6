#include "characterize/readout_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "characterize/clipped_mean.h"
#include "characterize/curve_pieces.h"
#include "characterize/limits.h"

namespace taxelsim {
namespace {

constexpr double kFarRange = 0.1;                           // of the range: distance beyond its ends at which rows are uninformative
constexpr double kUnloading = 0.2;                          // fall of the force that counts as unloading, of the largest force
constexpr std::array<double, 3> kWidths{0.02, 0.06, 0.15};  // of the largest force: start values of the play's width

// Effective force of each row after hysteresis.
std::vector<double> playedForces(const PressedTaxel& taxel, double strength, double width) {
  std::vector<double> forces;
  forces.reserve(taxel.rows.size());
  double play = 0;
  for (const Reading& row : taxel.rows) {
    play = std::clamp(play, row.force - width / taxel.share, row.force + width / taxel.share);
    forces.push_back(row.force + strength * (play - row.force));
  }
  return forces;
}

// Output of the rows used, before noise and clipping.
std::vector<double> outputs(const PressedTaxel& taxel, const ReadoutModel& model, const double* shared, const double* own) {
  const double* const lag = shared + model.lag();
  std::vector<double> played;
  if (model.hysteresis) played = playedForces(taxel, lag[0], lag[1]);
  std::vector<double> result;
  result.reserve(taxel.used.size());
  for (const std::size_t r : taxel.used) {
    const double force = model.hysteresis ? played[r] : taxel.rows[r].force;
    const double drift = own[2] * (static_cast<double>(r) / static_cast<double>(taxel.rows.size()) - 0.5);
    const double warmth = taxel.rows[r].warmth, growth = model.warms ? std::exp(shared[model.warm()] * warmth) : 1;
    const double shift = model.warms ? shared[model.warm() + 1] * warmth : 0;
    result.push_back(model.output(own[0] * (growth * force - own[1] - drift) - shift, shared));
  }
  return result;
}

double squaresOf(const GroupedFit& fit) {
  return fit.residual_sd * fit.residual_sd * static_cast<double>(fit.degrees_of_freedom);
}

bool isBetter(const GroupedFit& fit, const GroupedFit& with_more, double more) {
  return isBetterFit(squaresOf(fit), squaresOf(with_more), more, static_cast<double>(with_more.degrees_of_freedom));
}

// True if both intervals exclude 0.
bool isHysteresisIdentified(const ReadoutModel& model, const GroupedFit& fit) {
  const std::size_t s = model.lag();
  return fit.shared[s] > fit.halfWidth(s) && fit.shared[s + 1] > fit.halfWidth(s + 1);
}

}  // namespace

bool ReadoutModel::rises(double last, const double* shared) const {
  constexpr int kSteps = 500;
  double before = 0;
  for (int k = 1; k <= kSteps && before < top; ++k) {
    const double counts = output(last * k / kSteps, shared);
    if (counts <= before) return false;
    before = counts;
  }
  return true;
}

double ReadoutModel::outputOfPieces(double z, const double* shared) const {
  double sum = 0;
  for (std::size_t k = 0; k <= pinned_knot; ++k) sum += rise(k, shared);
  double begin = 0, risen = 0;
  std::size_t piece = 0;
  for (; piece + 1 < knots.size() && z > knots[piece]; ++piece) {
    begin = knots[piece];
    risen += rise(piece, shared);
  }
  return (risen + rise(piece, shared) * (z - begin) / (knots[piece] - begin)) * knots[pinned_knot] / sum;
}

double largestForce(const std::vector<Reading>& rows) {
  double most = 0;
  for (const Reading& row : rows) most = std::max(most, std::abs(row.force));
  return most;
}

std::optional<FitResult> straightLine(const std::vector<Reading>& rows, double top) {
  std::vector<Reading> inside;
  std::copy_if(rows.begin(), rows.end(), std::back_inserter(inside),
               [&](const Reading& row) { return row.counts > 0 && row.counts < top; });
  if (inside.size() < kLeastReadings) return {};
  const double most = largestForce(rows), slope = top / std::max(most, 1e-30);
  return fitRows(inside.size(), {{.start = slope, .scale = slope, .low = 0}, {.start = 0, .scale = most, .low = -most, .high = most}},
                 [&](std::size_t r, const double* p) { return p[0] * (inside[r].force - p[1]) - inside[r].counts; });
}

std::vector<std::size_t> informativeRows(const std::vector<Reading>& rows, const FitResult& line, double top, double noise) {
  const double far = std::max(kFarNoise * noise, kFarRange * top);
  std::vector<std::size_t> used;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const double mean = line.values[0] * (rows[r].force - line.values[1]);
    if (!((mean < -far && rows[r].counts <= 0) || (mean > top + far && rows[r].counts >= top))) used.push_back(r);
  }
  return used;
}

GroupedFit fitReadoutModel(const std::vector<PressedTaxel>& taxels, const std::vector<FitResult>& lines, const ReadoutModel& model,
                           double width) {
  GroupedProblem problem;
  for (std::size_t k = 0; k < model.num_bends; ++k) problem.shared.push_back({.start = 0, .scale = 1});
  if (!model.knots.empty()) problem.shared = risesOfPieces(model, taxels, lines);
  if (model.divider) problem.shared.push_back({.start = 0.3, .scale = 1, .low = 0, .high = kMostOfLimit});
  double most = 0;
  for (const PressedTaxel& taxel : taxels) most = std::max(most, largestForce(taxel.rows) * taxel.share);
  if (model.hysteresis) {
    problem.shared.push_back({.start = 0.05, .scale = 0.1, .low = 0, .high = 0.99});
    problem.shared.push_back({.start = width * most, .scale = 0.1 * most, .low = 0, .high = most});
  }
  if (model.warms) {
    problem.shared.push_back({.start = 0, .scale = 1e-3, .low = -kMostPerKelvin, .high = kMostPerKelvin});
    problem.shared.push_back({.start = 0, .scale = 1e-4 * model.top, .low = -model.top, .high = model.top});
  }
  for (std::size_t t = 0; t < taxels.size(); ++t) {
    const double force = largestForce(taxels[t].rows);
    const std::vector<double>& start = lines[t].values;
    // A negative trigger is unphysical and would let pieces shift their knots.
    const double least = model.knots.empty() || model.shows_below_zero ? -force : 0;
    problem.own.push_back({{.start = start[0], .scale = std::max(start[0], 1e-9), .low = 0},
                           {.start = start[1], .scale = force, .low = least, .high = force},
                           {.start = 0, .scale = 0.1 * force, .low = model.drifts ? -force : 0, .high = model.drifts ? force : 0}});
    problem.num_rows.push_back(taxels[t].used.size());
  }
  problem.residuals = [&](std::size_t group, const double* shared, const double* own, double* residuals) {
    const PressedTaxel& taxel = taxels[group];
    const std::vector<double> means = outputs(taxel, model, shared, own);
    for (std::size_t k = 0; k < means.size(); ++k) {
      residuals[k] = clippedMean(means[k], model.noise, model.top) - taxel.rows[taxel.used[k]].counts;
    }
  };
  return fitGroups(problem);
}

bool hasUnloading(const std::vector<Reading>& rows) {
  double highest = rows.front().force, fall = 0;
  for (const Reading& row : rows) {
    highest = std::max(highest, row.force);
    fall = std::max(fall, highest - row.force);
  }
  return fall > kUnloading * largestForce(rows);
}

GroupedFit withHysteresisAndDrift(const std::vector<PressedTaxel>& taxels, const std::vector<FitResult>& lines, ReadoutModel& model,
                                  GroupedFit fit) {
  double most = 0;
  for (const PressedTaxel& taxel : taxels) most = std::max(most, largestForce(taxel.rows) * taxel.share);
  const auto widthOf = [&] { return model.hysteresis ? fit.shared[model.lag() + 1] / most : 0; };
  if (std::any_of(taxels.begin(), taxels.end(), [](const PressedTaxel& taxel) { return hasUnloading(taxel.rows); })) {
    ReadoutModel candidate = model;
    candidate.hysteresis = true;
    for (const double width : kWidths) {
      GroupedFit other = fitReadoutModel(taxels, lines, candidate, width);
      const bool better = model.hysteresis ? squaresOf(other) < squaresOf(fit) : isBetter(fit, other, 2);
      if (!isHysteresisIdentified(candidate, other) || !better) continue;
      fit = std::move(other);
      model = candidate;
    }
    // Drift and hysteresis are partly confounded: after adding drift, tests whether hysteresis is still needed.
    candidate = model;
    candidate.drifts = true;
    GroupedFit drifting = fitReadoutModel(taxels, lines, candidate, widthOf());
    if (isBetter(fit, drifting, static_cast<double>(taxels.size()))) {
      fit = std::move(drifting);
      model = candidate;
      candidate.hysteresis = false;
      drifting = model.hysteresis ? fitReadoutModel(taxels, lines, candidate, 0) : fit;
      if (model.hysteresis && !(isHysteresisIdentified(model, fit) && isBetter(drifting, fit, 2))) {
        fit = std::move(drifting);
        model = candidate;
      }
    }
  }
  // Refits with the estimated noise, which determines the means of clipped readings, and drops hysteresis that is no longer significant.
  if (const ReadingNoise noise = noiseOf(taxels, model, fit); noise.deviation > kLeastNoise) {
    model.noise = noise.deviation;
    fit = fitReadoutModel(taxels, lines, model, widthOf());
    if (model.hysteresis && !isHysteresisIdentified(model, fit)) {
      model.hysteresis = false;
      fit = fitReadoutModel(taxels, lines, model, 0);
    }
  }
  return fit;
}

bool rises(const ReadoutModel& model, const GroupedFit& fit, const std::vector<PressedTaxel>& taxels) {
  double last = 0;
  for (std::size_t t = 0; t < taxels.size(); ++t) {
    last = std::max(last, fit.own[t][0] * (largestForce(taxels[t].rows) - fit.own[t][1]));
  }
  return model.rises(last, fit.shared.data());
}

ReadingNoise noiseOf(const std::vector<PressedTaxel>& taxels, const ReadoutModel& model, const GroupedFit& fit) {
  double squares = 0;
  std::size_t count = 0;
  for (std::size_t t = 0; t < taxels.size(); ++t) {
    const std::vector<double> means = outputs(taxels[t], model, fit.shared.data(), fit.own[t].data());
    for (std::size_t k = 0; k < means.size(); ++k) {
      const double from_end = std::min(means[k], model.top - means[k]);
      if (fit.outlier[t][k] || from_end < kFarNoise * model.noise) continue;
      const double residual = taxels[t].rows[taxels[t].used[k]].counts - means[k];
      squares += residual * residual;
      ++count;
    }
  }
  const std::size_t spent = (model.drifts ? 3 : 2) * taxels.size() + fit.shared.size();
  const std::size_t freedom = count > spent ? count - spent : 0;
  return {freedom > 0 ? std::sqrt(squares / static_cast<double>(freedom)) : 0, freedom};
}

}  // namespace taxelsim
