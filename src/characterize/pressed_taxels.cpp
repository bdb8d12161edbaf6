#include "characterize/pressed_taxels.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "characterize/clipped_mean.h"
#include "characterize/limits.h"
#include "reference/psf.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

constexpr std::size_t kPlateauRows = 5;    // rows with exactly the largest output that make a plateau
constexpr double kFlat = 0.01;             // relative rise of the output over the last third of the force that still counts as flat
constexpr std::size_t kMaxRows = 200'000;  // of all taxels; more are subsampled evenly

using RowsByTaxel = std::map<int, std::vector<Reading>>;

RowsByTaxel rowsByTaxel(Measured measurements, double reference) {
  RowsByTaxel rows;
  for (const Measurement* measurement : measurements) {
    const auto& curve = std::get<ForceCurve>(measurement->data);
    const double warmth = measurement->temperature.value_or(reference) - reference;
    for (std::size_t r = 0; r < curve.taxel.size(); ++r) rows[curve.taxel[r]].push_back({curve.force[r], curve.counts[r], warmth});
  }
  const std::size_t most = std::max(kMaxRows / std::max<std::size_t>(rows.size(), 1), 10 * kLeastReadings);
  for (auto& [taxel, all] : rows) {
    if (all.size() <= most) continue;
    std::vector<Reading> thinned;
    for (std::size_t k = 0; k < most; ++k) thinned.push_back(all[k * all.size() / most]);
    all = std::move(thinned);
  }
  return rows;
}

// Median output at forces from `low` to `high` times the largest; none for fewer than kLeastReadings rows.
std::optional<double> medianAt(const std::vector<Reading>& rows, double most, double low, double high) {
  std::vector<double> counts;
  for (const Reading& row : rows) {
    if (row.force >= low * most && row.force <= high * most) counts.push_back(row.counts);
  }
  if (counts.size() < kLeastReadings) return {};
  return medianOf(std::move(counts));
}

// A converter that clips repeats exactly the same largest output. An amplifier that clips gives a constant output with noise.
Plateau plateauOf(const RowsByTaxel& rows) {
  double largest = 0;
  std::size_t count = 0;
  std::vector<double> ends, spreads;
  for (const auto& [taxel, all] : rows) {
    for (const Reading& row : all) {
      if (row.counts > largest) count = 0;
      largest = std::max(largest, row.counts);
      if (row.counts == largest) ++count;
    }
    const double most = largestForce(all);
    const std::optional<double> before = medianAt(all, most, 0.7, 0.85), last = medianAt(all, most, 0.85, 1);
    if (!before || !last || !(*last > 0) || std::abs(*last - *before) >= kFlat * *last) continue;
    ends.push_back(*last);
    for (const Reading& row : all) {
      if (row.force >= 0.85 * most) spreads.push_back(std::abs(row.counts - *last));
    }
  }
  if (count >= kPlateauRows) return {largest, largest};
  const double end = medianOf(std::move(ends));
  if (end <= (1 - kFlat) * largest) return {};
  return {std::round(end), std::round(end - kFarNoise * kMedianToDeviation * medianOf(std::move(spreads)))};
}

bool isStill(const std::vector<Reading>& rows) {
  const auto [low, high] =
      std::minmax_element(rows.begin(), rows.end(), [](const Reading& a, const Reading& b) { return a.counts < b.counts; });
  return high->counts - low->counts <= kStill;
}

// Share of a force on a taxel that the point spread function leaves on it.
double ownShare(const Sensor& sensor, int taxel) {
  std::vector<double> force(static_cast<std::size_t>(numTaxels(sensor)));
  force[static_cast<std::size_t>(taxel)] = 1;
  return reference::spread(sensor, force)[static_cast<std::size_t>(taxel)];
}

// Half width of the interval of ownShare(), with a sign: all shares rise or fall together.
double ownShareHalfWidth(const Sensor& sensor, const PsfRange& range, int taxel) {
  Sensor low = sensor, high = sensor;
  low.psf = range.low;
  high.psf = range.high;
  return (ownShare(high, taxel) - ownShare(low, taxel)) / 2;
}

}  // namespace

PressedTaxels pressedTaxels(Measured force_curves, const Sensor& sensor, const std::optional<PsfRange>& psf_range, double reference) {
  RowsByTaxel rows = rowsByTaxel(force_curves, reference);
  PressedTaxels result;
  result.plateau = plateauOf(rows);
  result.top = result.plateau.counts > 0 ? result.plateau.top : sensor.readout.saturation;
  std::vector<double> deviations;
  for (auto& [taxel, all] : rows) {
    for (Reading& row : all) row.counts = std::min(row.counts, result.top);
    if (isStill(all)) {
      result.dead.push_back(taxel);
      continue;
    }
    std::optional<FitResult> line = straightLine(all, result.top);
    if (!line) {
      result.too_few_rows.push_back(taxel);
      continue;
    }
    result.taxels.push_back({.taxel = taxel,
                             .share = ownShare(sensor, taxel),
                             .share_half_width = psf_range ? ownShareHalfWidth(sensor, *psf_range, taxel) : 0,
                             .rows = std::move(all),
                             .used = {}});
    deviations.push_back(line->residual_sd);
    result.lines.push_back(std::move(*line));
  }
  if (result.taxels.empty()) {
    const std::string still = result.dead.empty() ? "" : "; " + std::to_string(result.dead.size()) + " taxels did not respond at all";
    throw Error(ErrorKind::kInput, force_curves.front()->file.generic_string() + ": no taxel has " + std::to_string(kLeastReadings) +
                                       " rows between trigger and saturation" + still);
  }
  result.noise = std::max(kLeastNoise, medianOf(std::move(deviations)));
  for (std::size_t t = 0; t < result.taxels.size(); ++t) {
    PressedTaxel& taxel = result.taxels[t];
    taxel.used = informativeRows(taxel.rows, result.lines[t], result.top, result.noise);
  }
  return result;
}

}  // namespace taxelsim
