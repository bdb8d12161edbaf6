#include "characterize/curve_pieces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <optional>

#include "characterize/clipped_mean.h"

namespace taxelsim {
namespace {

constexpr double kLeastRise = 1e-3;  // of the piece that rises most: a curve must rise
constexpr double kNearEnd = 0.85;    // of the largest force
constexpr double kTold = 0.5;        // of the end of the pieces: an output that is known no better is not told
// Of where a straight line would begin: a curve that bends up begins before it, and a fit finds no way from far off.
constexpr std::array<double, 3> kBegins{1, 0.5, 0};

// How far the median output rises from knot to knot, counts, > 0.
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
    // Far from the bound: a fit leaves it slowly.
    rises.push_back(std::max(here - before, 0.05 * width));
    before = std::max(before, here);
  }
  return rises;
}

bool isSparse(std::size_t num_rows) {
  return num_rows < kLeastReadings;
}

// A knot between two pieces that both have too few rows, or that the first or last piece has none of its own to tell. A single piece
// without rows is told by those beside it: it goes straight from one to the other.
std::optional<std::size_t> knotOfFewRows(const std::vector<std::size_t>& num_rows) {
  const std::size_t num_pieces = num_rows.size();
  if (num_pieces < 2) return {};
  if (isSparse(num_rows.front())) return 0;
  if (isSparse(num_rows.back())) return num_pieces - 2;
  for (std::size_t k = 0; k + 1 < num_pieces; ++k) {
    if (isSparse(num_rows[k]) && isSparse(num_rows[k + 1])) return k;
  }
  return {};
}

// Rows on each piece: those past the last knot are of the last piece.
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

// The taxels being straight lines.
std::vector<std::size_t> rowsOfPieces(const ReadoutModel& model, const std::vector<PressedTaxel>& taxels,
                                      const std::vector<FitResult>& lines) {
  RowsOfPieces rows(model);
  for (std::size_t t = 0; t < taxels.size(); ++t) {
    for (const std::size_t r : taxels[t].used) rows.add(lines[t].values[0] * (taxels[t].rows[r].force - lines[t].values[1]));
  }
  return rows.count();
}

// By a fit, without its outliers.
std::vector<std::size_t> rowsOfPieces(const ReadoutModel& model, const std::vector<PressedTaxel>& taxels, const GroupedFit& fit) {
  RowsOfPieces rows(model);
  for (std::size_t t = 0; t < taxels.size(); ++t) {
    for (std::size_t k = 0; k < taxels[t].used.size(); ++k) {
      if (!fit.outlier[t][k]) rows.add(fit.own[t][0] * (taxels[t].rows[taxels[t].used[k]].force - fit.own[t][1]));
    }
  }
  return rows.count();
}

// A knot whose output a fit does not tell.
std::optional<std::size_t> untoldKnot(const ReadoutModel& model, std::size_t num_taxels, const GroupedFit& fit) {
  const std::vector<Eigen::VectorXd> no_own(num_taxels, Eigen::Vector2d::Zero());
  for (std::size_t knot = 0; knot + 1 < model.knots.size(); ++knot) {
    if (!(fit.meanHalfWidth(no_own, outputAt(knot, model, fit.shared).gradient) < kTold * model.knots.back())) return knot;
  }
  return {};
}

// What the outputs at the largest forces come to.
double endOfPieces(const std::vector<PressedTaxel>& taxels) {
  double end = 0, largest = 0;
  for (const PressedTaxel& taxel : taxels) {
    const double near_end = kNearEnd * largestForce(taxel.rows);
    std::vector<double> counts;
    for (const Reading& row : taxel.rows) {
      largest = std::max(largest, row.counts);
      if (row.force >= near_end) counts.push_back(row.counts);
    }
    if (counts.size() >= kLeastReadings) end = std::max(end, medianOf(std::move(counts)));
  }
  return end > 0 ? end : largest;
}

// Noise (counts) by how far readings lie from the line between their neighbours in force, which no bend of the curve makes much of.
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
  constexpr double kMedianToDeviation = 1.482602;  // of a Gaussian
  return std::max(kLeastNoise, kMedianToDeviation * medianOf(std::move(apart)));
}

// A fit on its way.
struct Attempt {
  ReadoutModel model;
  std::vector<FitResult> lines;
  PiecesFit found;
};

void fit(const std::vector<PressedTaxel>& taxels, Attempt& attempt) {
  const std::vector<double> rises = startingRises(attempt.model, taxels, attempt.lines);
  attempt.model.steepest_piece = static_cast<std::size_t>(std::max_element(rises.begin(), rises.end()) - rises.begin());
  attempt.found.fit = fitReadoutModel(taxels, attempt.lines, attempt.model, 0);
}

// Those that a straight line called far past an end may not be.
void chooseRows(const Attempt& attempt, std::vector<PressedTaxel>& taxels) {
  const ReadoutModel& model = attempt.model;
  const GroupedFit& fit = attempt.found.fit;
  for (std::size_t t = 0; t < taxels.size(); ++t) {
    PressedTaxel& taxel = taxels[t];
    taxel.used.clear();
    for (std::size_t r = 0; r < taxel.rows.size(); ++r) {
      const double mean = model.output(fit.own[t][0] * (taxel.rows[r].force - fit.own[t][1]), fit.shared.data());
      if (!isFarPastEnd(mean, taxel.rows[r].counts, model.noise, model.top)) taxel.used.push_back(r);
    }
  }
}

void drop(std::size_t knot, Attempt& attempt) {
  attempt.found.joined.push_back(attempt.model.knots[knot]);
  attempt.model.knots.erase(attempt.model.knots.begin() + static_cast<std::ptrdiff_t>(knot));
}

}  // namespace

PiecesFit fitPieces(std::vector<PressedTaxel>& taxels, std::size_t num_pieces, std::vector<FitResult>& lines, ReadoutModel& model) {
  const double end = endOfPieces(taxels);
  model.noise = std::min(model.noise, noiseOfNeighbours(taxels, model.top));
  model.knots.clear();
  for (std::size_t k = 1; k <= num_pieces; ++k) model.knots.push_back(end * static_cast<double>(k) / static_cast<double>(num_pieces));
  std::vector<Attempt> attempts;
  double deviation = model.top;
  for (const double begin : kBegins) {
    Attempt& attempt = attempts.emplace_back(Attempt{.model = model, .lines = lines, .found = {}});
    for (FitResult& line : attempt.lines) {
      // Through the same point at the end.
      const double at_end = line.values[1] + end / std::max(line.values[0], 1e-30), first = begin * std::max(0.0, line.values[1]);
      line.values = {end / (at_end - first), first};
    }
    while (const auto knot = knotOfFewRows(rowsOfPieces(attempt.model, taxels, attempt.lines))) drop(*knot, attempt);
    fit(taxels, attempt);
    deviation = std::min(deviation, std::max(kLeastNoise, attempt.found.fit.residual_sd));
  }
  Attempt& best = *std::min_element(attempts.begin(), attempts.end(), [&](const Attempt& a, const Attempt& b) {
    return cutSquares(a.found.fit, deviation) < cutSquares(b.found.fit, deviation);
  });
  chooseRows(best, taxels);
  std::vector<std::size_t> num_rows;
  while (true) {
    for (std::size_t t = 0; t < taxels.size(); ++t) best.lines[t].values = best.found.fit.own[t];
    fit(taxels, best);
    num_rows = rowsOfPieces(best.model, taxels, best.found.fit);
    std::optional<std::size_t> knot = knotOfFewRows(num_rows);
    if (!knot) knot = untoldKnot(best.model, taxels.size(), best.found.fit);
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
    sum += model.rise(k, shared.data());
    if (k <= knot) risen += model.rise(k, shared.data());
  }
  const double scale = model.knots.back() / sum;
  const double before = model.rise(knot, shared.data()) / width(knot);
  const double after = knot + 1 < num_pieces ? model.rise(knot + 1, shared.data()) / width(knot + 1) : before;
  KnotOutput output{.counts = risen * scale, .slope = (before + after) / 2 * scale, .gradient = {}};
  output.gradient = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(shared.size()));
  std::size_t s = 0;
  for (std::size_t k = 0; k < num_pieces; ++k) {
    if (k != model.steepest_piece) output.gradient[static_cast<Eigen::Index>(s++)] = ((k <= knot ? 1 : 0) - risen / sum) * scale;
  }
  return output;
}

}  // namespace taxelsim
