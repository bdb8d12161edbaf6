#include "characterize/curve_pieces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <optional>

#include "characterize/clipped_mean.h"

namespace taxelsim {
namespace {

constexpr double kLeastRise = 1e-3;     // of the largest rise: lower bound
constexpr double kNearEnd = 0.85;       // of the largest force
constexpr double kMostHalfWidth = 0.5;  // of the range: a knot with a wider interval is removed
constexpr double kBeforeTop = 0.95;     // of the end of the range: the last knot
constexpr double kGross = 0.25;         // of the range, or
constexpr double kGrossNoise = 20;      // standard deviations, if larger: gross outliers, removed before the fit
constexpr double kNegativePenalty = 2;  // factor on the sum of squares of a fit with first forces below 0
constexpr double kBentOver = 0.8;       // of the output at half of the force: above it, pieces get longer with force
// Start values of the first force, relative to that of the straight line: a curve that bends up begins earlier, and the fit is local.
constexpr std::array<double, 3> kBegins{1, 0.5, 0};

// Rise of the median output from knot to knot, counts, > 0.
std::vector<double> startingRises(const ReadoutModel& model, const std::vector<PressedTaxel>& taxels, const std::vector<FitResult>& lines) {
  const std::vector<double>& knots = model.knots;
  std::vector<double> rises;
  double before = 0;
  for (std::size_t k = 0; k < knots.size(); ++k) {
    const double width = knots[k] - (k > 0 ? knots[k - 1] : 0);
    std::vector<double> counts;
    for (std::size_t t = 0; t < taxels.size(); ++t) {
      for (const std::size_t r : taxels[t].used) {
        const Reading& row = taxels[t].rows[r];
        const double z = lines[t].values[0] * (row.force - lines[t].values[1]);
        if (std::abs(z - knots[k]) <= width / 2) counts.push_back(row.counts);
      }
    }
    const double here = counts.size() >= kLeastReadings ? medianOf(std::move(counts)) : before + width;
    // Away from the lower bound, near which convergence is slow.
    rises.push_back(std::max(here - before, 0.05 * width));
    before = std::max(before, here);
  }
  return rises;
}

bool isSparse(std::size_t num_rows) {
  return num_rows < kLeastReadings;
}

// A knot to remove: between two sparse pieces, or at a sparse first or last piece. A single sparse piece in between is determined by its
// neighbours.
std::optional<std::size_t> knotOfFewRows(const ReadoutModel& model, const std::vector<std::size_t>& num_rows) {
  const std::size_t num_pieces = num_rows.size(), pinned = model.pinned_knot;
  if (num_pieces < 2) return {};
  // `knot`, or its neighbour if it is pinned.
  const auto unpinned = [&](std::size_t knot) { return knot != pinned ? knot : knot > 0 ? knot - 1 : knot + 1; };
  if (isSparse(num_rows.front())) return unpinned(0);
  if (isSparse(num_rows.back())) return pinned + 1 < num_pieces ? num_pieces - 1 : num_pieces - 2;
  for (std::size_t k = 0; k + 1 < num_pieces; ++k) {
    if (isSparse(num_rows[k]) && isSparse(num_rows[k + 1])) return unpinned(k);
  }
  return {};
}

// Counts the rows of each piece; rows beyond the last knot belong to the last piece.
class RowsOfPieces {
 public:
  explicit RowsOfPieces(const ReadoutModel& model) : model_(model), count_(model.knots.size()) {}

  void add(double z) {
    if (z < 0) return;
    const auto above = std::lower_bound(model_.knots.begin(), model_.knots.end() - 1, z);
    ++count_[static_cast<std::size_t>(above - model_.knots.begin())];
  }
  const std::vector<std::size_t>& count() const { return count_; }

 private:
  const ReadoutModel& model_;
  std::vector<std::size_t> count_;
};

// By the straight-line fits of the taxels.
std::vector<std::size_t> rowsOfPieces(const ReadoutModel& model, const std::vector<PressedTaxel>& taxels,
                                      const std::vector<FitResult>& lines) {
  RowsOfPieces rows(model);
  for (std::size_t t = 0; t < taxels.size(); ++t) {
    for (const std::size_t r : taxels[t].used) rows.add(lines[t].values[0] * (taxels[t].rows[r].force - lines[t].values[1]));
  }
  return rows.count();
}

// By a fit, without outliers.
std::vector<std::size_t> rowsOfPieces(const ReadoutModel& model, const std::vector<PressedTaxel>& taxels, const GroupedFit& fit) {
  RowsOfPieces rows(model);
  for (std::size_t t = 0; t < taxels.size(); ++t) {
    for (std::size_t k = 0; k < taxels[t].used.size(); ++k) {
      if (!fit.outlier[t][k]) rows.add(fit.own[t][0] * (taxels[t].rows[taxels[t].used[k]].force - fit.own[t][1]));
    }
  }
  return rows.count();
}

// A knot whose output has too wide an interval.
std::optional<std::size_t> undeterminedKnot(const ReadoutModel& model, std::size_t num_taxels, const GroupedFit& fit) {
  const std::vector<Eigen::VectorXd> no_own(num_taxels, Eigen::Vector3d::Zero());
  for (std::size_t knot = 0; knot < model.knots.size(); ++knot) {
    if (knot != model.pinned_knot && !(fit.meanHalfWidth(no_own, outputAt(knot, model, fit.shared).gradient) < kMostHalfWidth * model.top))
      return knot;
  }
  return {};
}

// Largest median output of the taxels at forces near `share` times their largest force.
double outputNear(const std::vector<PressedTaxel>& taxels, double share) {
  double output = 0;
  for (const PressedTaxel& taxel : taxels) {
    const double most = share * largestForce(taxel.rows);
    std::vector<double> counts;
    for (const Reading& row : taxel.rows) {
      if (row.force >= kNearEnd * most && row.force <= most) counts.push_back(row.counts);
    }
    if (counts.size() >= kLeastReadings) output = std::max(output, medianOf(std::move(counts)));
  }
  return output;
}

// Places the knots (see curve_pieces.h). Returns the share of the largest force at which the pinned knot lies.
double cutIntoPieces(const std::vector<PressedTaxel>& taxels, std::size_t num_pieces, ReadoutModel& model) {
  double end = outputNear(taxels, 1), share = 1;
  std::size_t num_longer = 0;
  while (num_longer + 2 < num_pieces) {
    const double half = outputNear(taxels, share / 2);
    if (!(half > kBentOver * end)) break;
    if (end < model.top) ++num_longer;
    share /= 2;
    end = half;
  }
  if (!(end > 0)) {
    for (const PressedTaxel& taxel : taxels) {
      for (const Reading& row : taxel.rows) end = std::max(end, row.counts);
    }
  }
  end = std::min(end, kBeforeTop * model.top);
  const std::size_t num_alike = num_pieces - num_longer;
  model.pinned_knot = num_alike - 1;
  model.knots.clear();
  for (std::size_t k = 1; k <= num_alike; ++k) model.knots.push_back(end * static_cast<double>(k) / static_cast<double>(num_alike));
  for (std::size_t k = 0; k < num_longer; ++k) model.knots.push_back(2 * model.knots.back());
  return share;
}

// Noise (counts) from the distance of readings to the line between their neighbours in force; insensitive to the shape of the curve.
double noiseOfNeighbours(const std::vector<PressedTaxel>& taxels, double top) {
  std::vector<double> apart;
  for (const PressedTaxel& taxel : taxels) {
    std::vector<Reading> rows;
    std::copy_if(taxel.rows.begin(), taxel.rows.end(), std::back_inserter(rows),
                 [&](const Reading& row) { return row.counts > 0 && row.counts < top; });
    std::stable_sort(rows.begin(), rows.end(), [](const Reading& a, const Reading& b) { return a.force < b.force; });
    for (std::size_t r = 1; r + 1 < rows.size(); ++r) {
      const Reading &before = rows[r - 1], &here = rows[r], &after = rows[r + 1];
      const double width = after.force - before.force, share = width > 0 ? (here.force - before.force) / width : 0.5;
      const double line = (1 - share) * before.counts + share * after.counts;
      apart.push_back(std::abs(here.counts - line) / std::sqrt(1 + (1 - share) * (1 - share) + share * share));
    }
  }
  return std::max(kLeastNoise, kMedianToDeviation * medianOf(std::move(apart)));
}

struct PiecesAttempt {
  ReadoutModel model;
  std::vector<FitResult> lines;
  PiecesFit found;
};

void fit(const std::vector<PressedTaxel>& taxels, PiecesAttempt& attempt) {
  const std::vector<double> rises = startingRises(attempt.model, taxels, attempt.lines);
  attempt.model.steepest_piece = static_cast<std::size_t>(std::max_element(rises.begin(), rises.end()) - rises.begin());
  attempt.found.fit = fitReadoutModel(taxels, attempt.lines, attempt.model, 0);
}

// Removes readings more than `least` from the median of their neighbours in force: the fit is not robust before the curve is roughly known.
void removeGrossOutliers(std::vector<PressedTaxel>& taxels, double least) {
  constexpr std::size_t kNeighbours = 5;  // on either side
  for (PressedTaxel& taxel : taxels) {
    std::vector<std::size_t> order = taxel.used;
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return taxel.rows[a].force < taxel.rows[b].force; });
    std::vector<std::size_t> kept;
    for (std::size_t k = 0; k < order.size(); ++k) {
      std::vector<double> near;
      for (std::size_t n = k - std::min(k, kNeighbours); n <= std::min(k + kNeighbours, order.size() - 1); ++n) {
        near.push_back(taxel.rows[order[n]].counts);
      }
      if (std::abs(taxel.rows[order[k]].counts - medianOf(std::move(near))) <= least) kept.push_back(order[k]);
    }
    std::sort(kept.begin(), kept.end());
    if (kept.size() >= kLeastReadings) taxel.used = std::move(kept);
  }
}

// Selects the informative rows of a fit, without gross outliers.
void chooseRows(PiecesAttempt& attempt, std::vector<PressedTaxel>& taxels, double least) {
  const ReadoutModel& model = attempt.model;
  const GroupedFit& fit = attempt.found.fit;
  for (std::size_t t = 0; t < taxels.size(); ++t) {
    PressedTaxel& taxel = taxels[t];
    taxel.used.clear();
    for (std::size_t r = 0; r < taxel.rows.size(); ++r) {
      const double mean = model.output(fit.own[t][0] * (taxel.rows[r].force - fit.own[t][1]), fit.shared.data());
      if (isFarPastEnd(mean, taxel.rows[r].counts, model.noise, model.top)) continue;
      if (std::abs(taxel.rows[r].counts - std::clamp(mean, 0.0, model.top)) <= least) {
        taxel.used.push_back(r);
      } else {
        ++attempt.found.num_gross;
      }
    }
  }
}

void drop(std::size_t knot, PiecesAttempt& attempt) {
  attempt.found.joined.push_back(attempt.model.knots[knot]);
  attempt.model.knots.erase(attempt.model.knots.begin() + static_cast<std::ptrdiff_t>(knot));
  if (knot < attempt.model.pinned_knot) --attempt.model.pinned_knot;
}

}  // namespace

PiecesFit fitPieces(std::vector<PressedTaxel>& taxels, std::size_t num_pieces, std::vector<FitResult>& lines, ReadoutModel& model) {
  model.noise = std::min(model.noise, noiseOfNeighbours(taxels, model.top));
  const double share = cutIntoPieces(taxels, num_pieces, model), end = model.knots[model.pinned_knot];
  for (std::size_t t = 0; t < taxels.size() && share < 1; ++t) {
    std::vector<Reading> low;
    const double most = share * largestForce(taxels[t].rows);
    std::copy_if(taxels[t].rows.begin(), taxels[t].rows.end(), std::back_inserter(low),
                 [&](const Reading& row) { return row.force <= most; });
    if (std::optional<FitResult> line = straightLine(low, model.top)) lines[t] = std::move(*line);
  }
  const double gross = std::max(kGrossNoise * model.noise, kGross * model.top);
  removeGrossOutliers(taxels, gross);
  double deviation = model.top;
  const auto attemptFrom = [&](double begin, bool shows_below_zero) {
    PiecesAttempt attempt{.model = model, .lines = lines, .found = {}};
    attempt.model.shows_below_zero = shows_below_zero;
    for (FitResult& line : attempt.lines) {
      // Keeps the point at the end of the line.
      const double at_end = line.values[1] + end / std::max(line.values[0], 1e-30);
      const double first = shows_below_zero ? std::min(0.0, line.values[1]) : begin * std::max(0.0, line.values[1]);
      line.values = {end / (at_end - first), first};
    }
    while (const auto knot = knotOfFewRows(attempt.model, rowsOfPieces(attempt.model, taxels, attempt.lines))) drop(*knot, attempt);
    fit(taxels, attempt);
    deviation = std::min(deviation, std::max(kLeastNoise, attempt.found.fit.residual_sd));
    return attempt;
  };
  std::vector<PiecesAttempt> attempts;
  for (const double begin : kBegins) attempts.push_back(attemptFrom(begin, false));
  attempts.push_back(attemptFrom(1, true));
  const auto misfit = [&](const PiecesAttempt& a) {
    return cutSquares(a.found.fit, deviation) * (a.model.shows_below_zero ? kNegativePenalty : 1);
  };
  PiecesAttempt& best = *std::min_element(attempts.begin(), attempts.end(),
                                          [&](const PiecesAttempt& a, const PiecesAttempt& b) { return misfit(a) < misfit(b); });
  chooseRows(best, taxels, gross);
  std::vector<std::size_t> num_rows;
  while (true) {
    for (std::size_t t = 0; t < taxels.size(); ++t) best.lines[t].values = best.found.fit.own[t];
    fit(taxels, best);
    num_rows = rowsOfPieces(best.model, taxels, best.found.fit);
    std::optional<std::size_t> knot = knotOfFewRows(best.model, num_rows);
    if (!knot) knot = undeterminedKnot(best.model, taxels.size(), best.found.fit);
    if (!knot) break;
    drop(*knot, best);
  }
  for (std::size_t k = 0; k < num_rows.size(); ++k) {
    if (isSparse(num_rows[k])) best.found.sparse.push_back(k);
  }
  model = std::move(best.model);
  lines = std::move(best.lines);
  return std::move(best.found);
}

std::vector<FitParameter> risesOfPieces(const ReadoutModel& model, const std::vector<PressedTaxel>& taxels,
                                        const std::vector<FitResult>& lines) {
  const std::vector<double> rises = startingRises(model, taxels, lines);
  std::vector<FitParameter> parameters;
  for (std::size_t k = 0; k < rises.size(); ++k) {
    if (k == model.steepest_piece) continue;
    parameters.push_back({.start = rises[k] / rises[model.steepest_piece], .scale = 1, .low = kLeastRise, .high = 1 / kLeastRise});
  }
  return parameters;
}

KnotOutput outputAt(std::size_t knot, const ReadoutModel& model, const std::vector<double>& shared) {
  const std::size_t num_pieces = model.knots.size();
  const auto width = [&](std::size_t piece) { return model.knots[piece] - (piece > 0 ? model.knots[piece - 1] : 0); };
  double sum = 0, risen = 0;
  for (std::size_t k = 0; k < num_pieces; ++k) {
    if (k <= model.pinned_knot) sum += model.rise(k, shared.data());
    if (k <= knot) risen += model.rise(k, shared.data());
  }
  const double scale = model.knots[model.pinned_knot] / sum;
  const double before = model.rise(knot, shared.data()) / width(knot);
  const double after = knot + 1 < num_pieces ? model.rise(knot + 1, shared.data()) / width(knot + 1) : before;
  KnotOutput output{.counts = risen * scale, .slope = (before + after) / 2 * scale, .gradient = {}};
  output.gradient = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(shared.size()));
  std::size_t s = 0;
  for (std::size_t k = 0; k < num_pieces; ++k) {
    if (k == model.steepest_piece) continue;
    const double of_risen = k <= knot ? 1 : 0, of_sum = k <= model.pinned_knot ? 1 : 0;
    output.gradient[static_cast<Eigen::Index>(s++)] = (of_risen - of_sum * risen / sum) * scale;
  }
  return output;
}

}  // namespace taxelsim
