#include "characterize/creep.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "base/text.h"
#include "characterize/fits.h"
#include "characterize/least_squares.h"
#include "sensor/curve.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

constexpr double kStill = 2;        // counts: an output that moves less does not answer
constexpr double kUnloaded = 0.05;  // of the level under load
constexpr std::size_t kLeastRows = 8;
constexpr std::size_t kMaxTerms = 3;
constexpr std::size_t kGridTimes = 10;
constexpr std::size_t kStartRows = 200;  // of a series that the start is found by
constexpr std::size_t kMaxDots = 2000;
constexpr double kMostCorrelation = 0.98;
constexpr int kOnsetRounds = 3;

struct Term {
  double time;
  double fraction;
};

struct Rows {
  std::vector<double> after;  // s after the onset
  std::vector<double> values;
};

struct Attempt {
  GroupedFit fit;
  std::vector<Term> terms;      // ascending in time, as fitted
  std::vector<std::size_t> at;  // (terms): which of the fit's
  double correlation = 0;
  double freedom = 0;  // with rows counted by their correlation
};

// Of the fit's shared parameters: log of the time and fraction, term by term.
std::vector<CreepTerm> termsOf(const double* shared, std::size_t num_terms) {
  std::vector<CreepTerm> terms;
  for (std::size_t i = 0; i < num_terms; ++i) terms.push_back({.fraction = shared[2 * i + 1], .time = std::exp(shared[2 * i])});
  return terms;
}

// Least squares of few unknowns, by the normal equations; false where they are not told apart.
bool solveNormal(const Eigen::MatrixXd& normal, const Eigen::VectorXd& right, Eigen::VectorXd& x) {
  const Eigen::LDLT<Eigen::MatrixXd> factors(normal);
  if (factors.info() != Eigen::Success || factors.rcond() < 1e-12) return false;
  x = factors.solve(right);
  return true;
}

// Times from a grid with the fractions that suit all series best when each is scaled to its own level.
std::vector<Term> startOf(const std::vector<Rows>& series, std::size_t num_terms, double shortest, double longest) {
  std::vector<double> grid;
  for (std::size_t k = 0; k < kGridTimes; ++k) {
    grid.push_back(2 * shortest * std::pow(longest / (3 * shortest), static_cast<double>(k) / (kGridTimes - 1)));
  }
  const auto unknowns = static_cast<Eigen::Index>(num_terms + 1);
  std::vector<Term> best;
  double least = std::numeric_limits<double>::infinity();
  std::vector<std::size_t> chosen(num_terms);
  std::iota(chosen.begin(), chosen.end(), 0);
  while (true) {
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(unknowns, unknowns);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(unknowns), row(unknowns), x;
    double squares = 0;
    for (const Rows& rows : series) {
      const double level = medianOf(rows.values);
      const std::size_t every = rows.values.size() / kStartRows + 1;
      for (std::size_t r = 0; r < rows.values.size(); r += every) {
        row[0] = 1;
        for (std::size_t i = 0; i < num_terms; ++i) row[static_cast<Eigen::Index>(i) + 1] = -std::expm1(-rows.after[r] / grid[chosen[i]]);
        const double y = rows.values[r] / level;
        normal += row * row.transpose();
        right += row * y;
        squares += y * y;
      }
    }
    if (solveNormal(normal, right, x) && x[0] > 0) {
      double left = squares - x.dot(right);
      for (Eigen::Index i = 1; i < unknowns; ++i) left += x[i] < 0 ? squares : 0;  // only where nothing else is found
      if (left < least) {
        least = left;
        best.clear();
        for (std::size_t i = 0; i < num_terms; ++i) {
          best.push_back({grid[chosen[i]], std::max(0.01, x[static_cast<Eigen::Index>(i) + 1] / x[0])});
        }
      }
    }
    // The next choice of rising indices.
    std::size_t k = num_terms;
    while (k > 0 && chosen[k - 1] == kGridTimes - num_terms + k - 1) --k;
    if (k == 0) break;
    ++chosen[k - 1];
    for (std::size_t i = k; i < num_terms; ++i) chosen[i] = chosen[i - 1] + 1;
  }
  if (best.empty()) {
    for (std::size_t i = 0; i < num_terms; ++i) best.push_back({grid[i * kGridTimes / num_terms + 1], 0.1});
  }
  return best;
}

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

Attempt fitTerms(const std::vector<Rows>& series, std::size_t num_terms, double shortest, double longest) {
  GroupedProblem problem;
  if (num_terms > 0) {
    for (const Term& term : startOf(series, num_terms, shortest, longest)) {
      problem.shared.push_back({.start = std::log(term.time), .scale = 1, .low = std::log(shortest), .high = std::log(longest)});
      problem.shared.push_back({.start = term.fraction, .scale = std::max(0.1, term.fraction), .low = 0, .high = kMaxCreepFraction});
    }
  }
  std::vector<double> start;
  for (const FitParameter& parameter : problem.shared) start.push_back(parameter.start);
  for (const Rows& rows : series) {
    const double level = medianOf(rows.values);
    const double amplitude = rows.values.back() / creepFactor(termsOf(start.data(), num_terms), rows.after.back());
    problem.own.push_back({{.start = amplitude > 0 ? amplitude : level, .scale = level, .low = 0}});
    problem.num_rows.push_back(rows.values.size());
  }
  // Each series in units of its own level, so that all count alike: what is uneven under a constant load grows with it.
  std::vector<double> levels;
  for (const Rows& rows : series) levels.push_back(medianOf(rows.values));
  problem.residuals = [&](std::size_t g, const double* shared, const double* own, double* residuals) {
    const std::vector<CreepTerm> terms = termsOf(shared, num_terms);
    for (std::size_t r = 0; r < series[g].values.size(); ++r) {
      residuals[r] = (own[0] * creepFactor(terms, series[g].after[r]) - series[g].values[r]) / levels[g];
    }
  };
  Attempt attempt{.fit = fitGroups(problem), .terms = {}, .at = {}};
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

// Over the rows that are no outliers of `judge`.
double squaresOf(const GroupedFit& fit, const GroupedFit& judge) {
  double squares = 0;
  for (std::size_t g = 0; g < fit.residual.size(); ++g) {
    for (std::size_t r = 0; r < fit.residual[g].size(); ++r) squares += judge.outlier[g][r] ? 0 : fit.residual[g][r] * fit.residual[g][r];
  }
  return squares;
}

// Half of the 95 % interval of the fit's shared parameter, with rows counted by their correlation.
double halfWidthOf(const Attempt& attempt, std::size_t parameter) {
  const auto p = static_cast<Eigen::Index>(parameter);
  const double widened = (1 + attempt.correlation) / (1 - attempt.correlation);
  return studentFactor(static_cast<std::size_t>(attempt.freedom)) * std::sqrt(widened * attempt.fit.covariance(p, p));
}

// From the tail alone onset and fraction cannot be told apart: with A c e^(t0 / time) and the end value kept,
//   dc / dt0 = -c / time - c sum c_j / time_j.
double halfWidthByOnset(const Attempt& attempt, std::size_t term, const std::vector<Onset>& onsets) {
  double variance = 0, rate = 1 / attempt.terms[term].time;
  for (const Onset& onset : onsets) variance += onset.deviation * onset.deviation;
  for (const Term& other : attempt.terms) rate += other.fraction / other.time;
  return 1.96 * attempt.terms[term].fraction * rate * std::sqrt(variance) / static_cast<double>(onsets.size());
}

// Empty, or why the attempt's terms are not all told.
std::string doubtIn(const Attempt& attempt, const std::vector<Onset>& onsets, double shortest, double longest) {
  for (std::size_t i = 0; i < attempt.terms.size(); ++i) {
    const Term& term = attempt.terms[i];
    if (term.time > 0.99 * longest) return "slower than the " + numberText(std::round(longest * 10) / 10) + " s under load";
    if (term.time < 1.01 * shortest) return "faster than the frames, " + numberText(std::round(shortest * 1e4) / 1e4) + " s apart";
    const double half = std::hypot(halfWidthOf(attempt, 2 * attempt.at[i] + 1), halfWidthByOnset(attempt, i, onsets));
    if (!(term.fraction > half)) return "its fraction's interval reaches 0";
    if (!std::isfinite(halfWidthOf(attempt, 2 * attempt.at[i]))) return "its time is not told";
  }
  return "";
}

double frameInterval(const std::vector<double>& time) {
  std::vector<double> intervals;
  for (std::size_t r = 1; r < time.size(); ++r) intervals.push_back(time[r] - time[r - 1]);
  return medianOf(std::move(intervals));
}

// With terms as many as are told, or as `num_terms` says.
CreepFit fitFrom(const std::vector<CreepSeries>& all, std::vector<Onset> onsets, std::optional<std::size_t> num_terms = {}) {
  std::vector<Rows> series;
  double shortest = 0, longest = 0;
  for (std::size_t m = 0; m < all.size(); ++m) {
    Rows rows;
    for (std::size_t r = onsets[m].first_row; r < onsets[m].end_row; ++r) {
      rows.after.push_back(all[m].time[r] - onsets[m].time);
      rows.values.push_back(all[m].values[r]);
    }
    shortest = std::max(shortest, frameInterval(all[m].time));
    longest = std::max(longest, rows.after.back());
    series.push_back(std::move(rows));
  }
  CreepFit result;
  Attempt accepted = fitTerms(series, num_terms.value_or(0), shortest, longest);
  while (!num_terms && accepted.terms.size() < kMaxTerms) {
    const std::size_t next = accepted.terms.size() + 1;
    Attempt attempt = fitTerms(series, next, shortest, longest);
    if (!isBetterFit(squaresOf(accepted.fit, attempt.fit), squaresOf(attempt.fit, attempt.fit), 2, attempt.freedom)) {
      result.remark = next == 1 ? "no creep is seen over the noise" : "the rows show no further term";
      break;
    }
    result.remark = doubtIn(attempt, onsets, shortest, longest);
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

Onset onsetOf(const CreepSeries& series, double level) {
  const std::vector<double>& values = series.values;
  const auto fail = [&](const std::string& what) { throw Error(ErrorKind::kInput, series.file + ": " + what); };
  // What a twentieth of the rows exceed may be outliers.
  std::vector<double> sorted = values;
  std::sort(sorted.begin(), sorted.end());
  const double top = sorted[static_cast<std::size_t>(0.95 * static_cast<double>(sorted.size() - 1))];
  if (!(top > 0)) fail("nothing touches: the output never rises for long");
  const double loaded = medianOf({std::upper_bound(sorted.begin(), sorted.end(), top / 2), sorted.end()});
  const double half = (level > 0 ? level : loaded) / 2;
  const auto above = [&](std::size_t row) { return values[row] >= half; };
  std::size_t row = 0;
  while (row + 2 < values.size() && !(above(row) && above(row + 1) && above(row + 2))) ++row;
  if (row + 2 >= values.size()) fail("nothing touches: the output never rises for long");
  if (row == 0) fail("the recording begins under load: rows before the touch are needed");
  std::size_t last = values.size() - 1;
  while (!(above(last) && above(last - 1))) --last;
  const auto num_above = static_cast<std::size_t>(std::count_if(values.begin() + static_cast<std::ptrdiff_t>(row),
                                                                values.begin() + static_cast<std::ptrdiff_t>(last) + 1,
                                                                [&](double value) { return value >= half; }));
  if (10 * num_above < 9 * (last + 1 - row)) fail("the output does not rise once and stay: one load, put on once, is needed");
  std::size_t start = row - 1;
  while (start > 0 && values[start] > kUnloaded * loaded) --start;
  if (values[start] > kUnloaded * loaded) fail("the recording begins under load: rows before the touch are needed");

  Onset onset;
  const double share = (half - values[row - 1]) / (values[row] - values[row - 1]);
  onset.time = series.time[row - 1] + std::clamp(share, 0.0, 1.0) * (series.time[row] - series.time[row - 1]);
  onset.start = series.time[start];
  const double rise = onset.time - onset.start;
  onset.deviation = std::hypot((series.time[row] - series.time[row - 1]) / std::sqrt(12.0), start + 1 < row ? rise / 10 : 0);
  onset.first_row = row;
  while (onset.first_row <= last && series.time[onset.first_row] < onset.time + 2 * rise) ++onset.first_row;
  // Taken off: the way down takes about as long as the way up.
  onset.end_row = last + 1;
  if (last + 3 < values.size()) {
    while (onset.end_row > onset.first_row && series.time[onset.end_row - 1] > series.time[last] - 2 * rise) --onset.end_row;
  }
  if (onset.end_row < onset.first_row + kLeastRows) {
    fail(std::to_string(onset.end_row - std::min(onset.end_row, onset.first_row)) + " rows under the full load are not enough: at least " +
         std::to_string(kLeastRows));
  }
  return onset;
}

CreepFit fitCreepTerms(const std::vector<CreepSeries>& series) {
  std::vector<Onset> onsets;
  for (const CreepSeries& one : series) onsets.push_back(onsetOf(one));
  CreepFit fit = fitFrom(series, onsets);
  // Half of the output under load is more than half of what it was at first.
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

void addCreep(const CreepFit& fit, const std::vector<CreepSeries>& series, const std::string& name, const std::string& remark,
              Characterization& result) {
  for (std::size_t i = 0; i < fit.terms.size(); ++i) {
    const std::string key = "readout.creep[" + std::to_string(i) + "]";
    const CreepTerm& term = fit.terms[i];
    result.estimates.push_back({.parameter = key + ".fraction",
                                .unit = "",
                                .determined = true,
                                .value = term.fraction,
                                .low = term.fraction - fit.fraction_half[i],
                                .high = term.fraction + fit.fraction_half[i],
                                .remark = remark});
    result.estimates.push_back({.parameter = key + ".time",
                                .unit = "s",
                                .determined = true,
                                .value = term.time,
                                .low = fit.time_low[i],
                                .high = fit.time_high[i],
                                .remark = ""});
  }
  if (!fit.terms.empty()) result.sensor.readout.creep = fit.terms;
  if (!fit.remark.empty()) {
    result.estimates.push_back(
        {.parameter = "readout.creep[" + std::to_string(fit.terms.size()) + "]", .unit = "", .determined = false, .remark = fit.remark});
  }
  result.fits.push_back({.measurement = name,
                         .unit = "of the output at first",
                         .rms = fit.residual,
                         .num_rows = fit.num_rows,
                         .num_outliers = fit.num_outliers});
  FitFigure figure{.title = "Output over time under a constant load",
                   .x_label = "time after the onset, s",
                   .y_label = "output, of that at first",
                   .curves = {}};
  double longest = 0;
  const std::size_t every = fit.num_rows / kMaxDots + 1;
  for (std::size_t m = 0; m < series.size(); ++m) {
    FitFigure::Curve dots{.name = std::filesystem::path(series[m].file).stem().string(), .measured = true, .x = {}, .y = {}};
    for (std::size_t r = fit.onsets[m].first_row; r < fit.onsets[m].end_row; r += every) {
      dots.x.push_back(series[m].time[r] - fit.onsets[m].time);
      dots.y.push_back(series[m].values[r] / fit.amplitude[m]);
      longest = std::max(longest, dots.x.back());
    }
    figure.curves.push_back(std::move(dots));
  }
  FitFigure::Curve line{.name = "fitted", .x = {}, .y = {}};
  for (int k = 0; k <= 100; ++k) {
    line.x.push_back(longest * k / 100);
    line.y.push_back(creepFactor(fit.terms, line.x.back()));
  }
  figure.curves.push_back(std::move(line));
  result.figures.push_back(std::move(figure));
}

// The sum over taxels that show is S (F y - n trigger), of which a fraction's fit sees fraction F / (F - n trigger): one taxel's trigger is
// known and put back; n of a sum is not.
void fitCreep(Measured step_responses, Characterization& result) {
  const Readout& readout = result.sensor.readout;
  std::vector<CreepSeries> series;
  std::string remark;
  for (const Measurement* measurement : step_responses) {
    const auto& step = std::get<StepResponse>(measurement->data);
    CreepSeries one{.file = measurement->file.generic_string(), .time = {}, .values = {}};
    const double most = step.counts.empty() ? 0 : *std::max_element(step.counts.begin(), step.counts.end());
    if (most <= kStill) throw Error(ErrorKind::kInput, one.file + ": nothing touches: the output never exceeds 2 counts");
    const bool is_sum = most > readout.saturation;
    for (std::size_t r = 0; r < step.time.size(); ++r) {
      if (!is_sum && step.counts[r] >= readout.saturation) continue;
      one.time.push_back(step.time[r]);
      one.values.push_back(is_sum ? step.counts[r] : nominalForce(readout, step.counts[r]));
    }
    if (2 * one.time.size() < step.time.size()) {
      throw Error(ErrorKind::kInput, one.file + ": most rows read the saturation of " + std::to_string(readout.saturation) + " counts");
    }
    if (readout.trigger > 0) {
      const double share = readout.output_scale * slopeAtZero(readout) * readout.trigger / (0.9 * most);
      remark = is_sum ? "a sum over taxels: their triggers are left out, every taxel that shows makes it about " +
                            numberText(std::round(share * 1e4) / 100) + " % too large"
                      : "taken for the output of one taxel, whose trigger is put back";
    }
    series.push_back(std::move(one));
  }
  addCreep(fitCreepTerms(series), series, step_responses.front()->name, remark, result);
}

}  // namespace taxelsim
