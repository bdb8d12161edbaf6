#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "base/text.h"
#include "characterize/creep.h"
#include "characterize/least_squares.h"
#include "sensor/curve.h"

namespace taxelsim {
namespace {

constexpr std::size_t kMaxTerms = 3;
constexpr std::size_t kGridTimes = 10;
constexpr std::size_t kStartRows = 200;  // rows of a series that the start values are found from
constexpr double kMostCorrelation = 0.98;
constexpr int kOnsetRounds = 3;

struct Term {
  double time;
  double fraction;
};

struct SeriesRows {
  std::vector<double> after;  // s after the onset
  std::vector<double> values;
};

struct TermsAttempt {
  GroupedFit fit;
  std::vector<Term> terms;      // ascending in time
  std::vector<std::size_t> at;  // (terms): index in the fit
  double correlation = 0;
  double freedom = 0;  // degrees of freedom, by the effective number of rows
};

// The fit's shared parameters are log(time) and fraction, term by term.
std::vector<CreepTerm> termsOf(const double* shared, std::size_t num_terms) {
  std::vector<CreepTerm> terms;
  for (std::size_t i = 0; i < num_terms; ++i) terms.push_back({.fraction = shared[2 * i + 1], .time = std::exp(shared[2 * i])});
  return terms;
}

// Solves the normal equations of a small problem; false if they are singular.
bool solveNormal(const Eigen::MatrixXd& normal, const Eigen::VectorXd& right, Eigen::VectorXd& x) {
  const Eigen::LDLT<Eigen::MatrixXd> factors(normal);
  if (factors.info() != Eigen::Success || factors.rcond() < 1e-12) return false;
  x = factors.solve(right);
  return true;
}

// Linear least squares for the level and the fractions at given times; each series is scaled to its own level.
struct LinearFit {
  Eigen::VectorXd x;  // level, level x fraction of each term
  double squares = std::numeric_limits<double>::infinity();
};

std::optional<LinearFit> fitFractions(const std::vector<SeriesRows>& series, const std::vector<double>& times) {
  const auto unknowns = static_cast<Eigen::Index>(times.size() + 1);
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(unknowns, unknowns);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(unknowns), row(unknowns);
  double squares = 0;
  for (const SeriesRows& rows : series) {
    const double level = medianOf(rows.values);
    const std::size_t every = rows.values.size() / kStartRows + 1;
    for (std::size_t r = 0; r < rows.values.size(); r += every) {
      row[0] = 1;
      for (std::size_t i = 0; i < times.size(); ++i) row[static_cast<Eigen::Index>(i) + 1] = -std::expm1(-rows.after[r] / times[i]);
      const double y = rows.values[r] / level;
      normal += row * row.transpose();
      right += row * y;
      squares += y * y;
    }
  }
  LinearFit fit;
  if (!solveNormal(normal, right, fit.x) || !(fit.x[0] > 0)) return {};
  fit.squares = squares - fit.x.dot(right);
  for (Eigen::Index i = 1; i < unknowns; ++i) fit.squares += fit.x[i] < 0 ? squares : 0;  // penalty: a last resort
  return fit;
}

// Advances to the next combination of rising indices below `end`; false after the last one.
bool nextCombination(std::vector<std::size_t>& chosen, std::size_t end) {
  const std::size_t count = chosen.size();
  std::size_t k = count;
  while (k > 0 && chosen[k - 1] == end - count + k - 1) --k;
  if (k == 0) return false;
  ++chosen[k - 1];
  for (std::size_t i = k; i < count; ++i) chosen[i] = chosen[i - 1] + 1;
  return true;
}

// Start values: the combination of times from a logarithmic grid that fits best.
std::vector<Term> startOf(const std::vector<SeriesRows>& series, std::size_t num_terms, double shortest, double longest) {
  std::vector<double> grid;
  for (std::size_t k = 0; k < kGridTimes; ++k) {
    grid.push_back(2 * shortest * std::pow(longest / (3 * shortest), static_cast<double>(k) / (kGridTimes - 1)));
  }
  std::vector<Term> best;
  double least = std::numeric_limits<double>::infinity();
  std::vector<std::size_t> chosen(num_terms);
  std::iota(chosen.begin(), chosen.end(), 0);
  do {
    std::vector<double> times;
    for (const std::size_t k : chosen) times.push_back(grid[k]);
    const std::optional<LinearFit> fit = fitFractions(series, times);
    if (!fit || !(fit->squares < least)) continue;
    least = fit->squares;
    best.clear();
    for (std::size_t i = 0; i < num_terms; ++i) {
      best.push_back({times[i], std::max(0.01, fit->x[static_cast<Eigen::Index>(i) + 1] / fit->x[0])});
    }
  } while (nextCombination(chosen, kGridTimes));
  if (best.empty()) {
    for (std::size_t i = 0; i < num_terms; ++i) best.push_back({grid[i * kGridTimes / num_terms + 1], 0.1});
  }
  return best;
}

// Lag-1 autocorrelation of the residuals without outliers.
double correlationOf(const GroupedFit& fit) {
  double product = 0, square = 0;
  for (std::size_t g = 0; g < fit.residual.size(); ++g) {
    for (std::size_t r = 1; r < fit.residual[g].size(); ++r) {
      if (fit.outlier[g][r] || fit.outlier[g][r - 1]) continue;
      product += fit.residual[g][r] * fit.residual[g][r - 1];
      square += (fit.residual[g][r] * fit.residual[g][r] + fit.residual[g][r - 1] * fit.residual[g][r - 1]) / 2;
    }
  }
  return square > 0 ? std::clamp(product / square, 0.0, kMostCorrelation) : 0;
}

TermsAttempt fitTerms(const std::vector<SeriesRows>& series, std::size_t num_terms, double shortest, double longest) {
  GroupedProblem problem;
  if (num_terms > 0) {
    for (const Term& term : startOf(series, num_terms, shortest, longest)) {
      problem.shared.push_back({.start = std::log(term.time), .scale = 1, .low = std::log(shortest), .high = std::log(longest)});
      problem.shared.push_back({.start = term.fraction, .scale = std::max(0.1, term.fraction), .low = 0, .high = kMaxCreepFraction});
    }
  }
  std::vector<double> start;
  for (const FitParameter& parameter : problem.shared) start.push_back(parameter.start);
  for (const SeriesRows& rows : series) {
    const double level = medianOf(rows.values);
    const double amplitude = rows.values.back() / creepFactor(termsOf(start.data(), num_terms), rows.after.back());
    problem.own.push_back({{.start = amplitude > 0 ? amplitude : level, .scale = level, .low = 0}});
    problem.num_rows.push_back(rows.values.size());
  }
  // Residuals are relative to the series' level: variations under a constant load grow with the load.
  std::vector<double> levels;
  for (const SeriesRows& rows : series) levels.push_back(medianOf(rows.values));
  problem.residuals = [&](std::size_t g, const double* shared, const double* own, double* residuals) {
    const std::vector<CreepTerm> terms = termsOf(shared, num_terms);
    for (std::size_t r = 0; r < series[g].values.size(); ++r) {
      residuals[r] = (own[0] * creepFactor(terms, series[g].after[r]) - series[g].values[r]) / levels[g];
    }
  };
  TermsAttempt attempt{.fit = fitGroups(problem), .terms = {}, .at = {}};
  for (std::size_t i = 0; i < num_terms; ++i) {
    attempt.terms.push_back({std::exp(attempt.fit.shared[2 * i]), attempt.fit.shared[2 * i + 1]});
    attempt.at.push_back(i);
  }
  std::sort(attempt.at.begin(), attempt.at.end(),
            [&](std::size_t a, std::size_t b) { return attempt.fit.shared[2 * a] < attempt.fit.shared[2 * b]; });
  std::sort(attempt.terms.begin(), attempt.terms.end(), [](const Term& a, const Term& b) { return a.time < b.time; });
  attempt.correlation = correlationOf(attempt.fit);
  const double share = (1 - attempt.correlation) / (1 + attempt.correlation);
  const auto used = static_cast<double>(attempt.fit.num_rows - attempt.fit.num_outliers);
  attempt.freedom = std::max(1.0, share * used - static_cast<double>(2 * num_terms + series.size()));
  return attempt;
}

// Residual sum of squares of `fit` without the outliers of `other`.
double squaresOf(const GroupedFit& fit, const GroupedFit& other) {
  double squares = 0;
  for (std::size_t g = 0; g < fit.residual.size(); ++g) {
    for (std::size_t r = 0; r < fit.residual[g].size(); ++r) squares += other.outlier[g][r] ? 0 : fit.residual[g][r] * fit.residual[g][r];
  }
  return squares;
}

// Half width of the 95 % interval of a shared parameter, by the effective number of rows.
double halfWidthOf(const TermsAttempt& attempt, std::size_t parameter) {
  const auto p = static_cast<Eigen::Index>(parameter);
  const double widened = (1 + attempt.correlation) / (1 - attempt.correlation);
  return studentFactor(static_cast<std::size_t>(attempt.freedom)) * std::sqrt(widened * attempt.fit.covariance(p, p));
}

// Onset and fraction are confounded in the tail: for constant A c e^(t0 / time) and a constant end value,
//   dc / dt0 = -c / time - c sum c_j / time_j.
double halfWidthByOnset(const TermsAttempt& attempt, std::size_t term, const std::vector<Onset>& onsets) {
  double variance = 0, rate = 1 / attempt.terms[term].time;
  for (const Onset& onset : onsets) variance += onset.deviation * onset.deviation;
  for (const Term& other : attempt.terms) rate += other.fraction / other.time;
  return 1.96 * attempt.terms[term].fraction * rate * std::sqrt(variance) / static_cast<double>(onsets.size());
}

// Empty, or why a term is not identified.
std::string reasonAgainst(const TermsAttempt& attempt, const std::vector<Onset>& onsets, double shortest, double longest) {
  for (std::size_t i = 0; i < attempt.terms.size(); ++i) {
    const Term& term = attempt.terms[i];
    if (term.time > 0.99 * longest) return "a time constant longer than the " + numberText(std::round(longest * 10) / 10) + " s under load";
    if (term.time < 1.01 * shortest)
      return "a time constant shorter than the frame interval, " + numberText(std::round(shortest * 1e4) / 1e4) + " s";
    const double half = std::hypot(halfWidthOf(attempt, 2 * attempt.at[i] + 1), halfWidthByOnset(attempt, i, onsets));
    if (!(term.fraction > half)) return "the interval of its fraction includes 0";
    if (!std::isfinite(halfWidthOf(attempt, 2 * attempt.at[i]))) return "its time constant is not identifiable";
  }
  return "";
}

double frameInterval(const std::vector<double>& time) {
  std::vector<double> intervals;
  for (std::size_t r = 1; r < time.size(); ++r) intervals.push_back(time[r] - time[r - 1]);
  return medianOf(std::move(intervals));
}

// With `num_terms` terms, by default as many as are identified.
CreepFit fitFrom(const std::vector<CreepSeries>& all, std::vector<Onset> onsets, std::optional<std::size_t> num_terms = {}) {
  std::vector<SeriesRows> series;
  double shortest = 0, longest = 0;
  for (std::size_t m = 0; m < all.size(); ++m) {
    SeriesRows rows;
    for (std::size_t r = onsets[m].first_row; r < onsets[m].end_row; ++r) {
      rows.after.push_back(all[m].time[r] - onsets[m].time);
      rows.values.push_back(all[m].values[r]);
    }
    shortest = std::max(shortest, frameInterval(all[m].time));
    longest = std::max(longest, rows.after.back());
    series.push_back(std::move(rows));
  }
  CreepFit result;
  TermsAttempt accepted = fitTerms(series, num_terms.value_or(0), shortest, longest);
  while (!num_terms && accepted.terms.size() < kMaxTerms) {
    const std::size_t next = accepted.terms.size() + 1;
    TermsAttempt attempt = fitTerms(series, next, shortest, longest);
    if (!isBetterFit(squaresOf(accepted.fit, attempt.fit), squaresOf(attempt.fit, attempt.fit), 2, attempt.freedom)) {
      result.remark = next == 1 ? "no creep above the noise" : "no further term above the noise";
      break;
    }
    result.remark = reasonAgainst(attempt, onsets, shortest, longest);
    if (!result.remark.empty()) break;
    accepted = std::move(attempt);
  }
  for (std::size_t i = 0; i < accepted.terms.size(); ++i) {
    const std::size_t at = accepted.at[i];
    const double spread = std::exp(halfWidthOf(accepted, 2 * at));
    result.terms.push_back({.fraction = accepted.terms[i].fraction, .time = accepted.terms[i].time});
    result.fraction_half.push_back(std::hypot(halfWidthOf(accepted, 2 * at + 1), halfWidthByOnset(accepted, i, onsets)));
    result.time_low.push_back(accepted.terms[i].time / spread);
    result.time_high.push_back(accepted.terms[i].time * spread);
  }
  for (const std::vector<double>& own : accepted.fit.own) result.amplitude.push_back(own[0]);
  result.onsets = std::move(onsets);
  result.correlation = accepted.correlation;
  result.residual = accepted.fit.residual_sd;
  result.num_rows = accepted.fit.num_rows;
  result.num_outliers = accepted.fit.num_outliers;
  return result;
}

}  // namespace

CreepFit fitCreepTerms(const std::vector<CreepSeries>& series) {
  std::vector<Onset> onsets;
  for (const CreepSeries& one : series) onsets.push_back(onsetOf(one));
  CreepFit fit = fitFrom(series, onsets);
  // The first onset is at half of the median output, which creep has raised: repeats with half of the fitted amplitude.
  for (int round = 1; round < kOnsetRounds && !fit.terms.empty(); ++round) {
    for (std::size_t m = 0; m < series.size(); ++m) onsets[m] = onsetOf(series[m], fit.amplitude[m]);
    const std::string remark = std::exchange(fit.remark, "");
    fit = fitFrom(series, onsets, fit.terms.size());
    fit.remark = remark;
  }
  return fit;
}

double creepFactor(const std::vector<CreepTerm>& terms, double t) {
  double factor = 1;
  for (const CreepTerm& term : terms) factor -= term.fraction * std::expm1(-t / term.time);
  return factor;
}

}  // namespace taxelsim
