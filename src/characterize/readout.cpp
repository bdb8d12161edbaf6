// Force curves to a readout: which readings tell, which model they ask for, and what it makes of the sensor.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>

#include "base/text.h"
#include "characterize/clipped_mean.h"
#include "characterize/curve_pieces.h"
#include "characterize/fits.h"
#include "characterize/readout_model.h"
#include "reference/psf.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

constexpr std::size_t kPlateauRows = 5;    // with one and the same largest output: the sensor ends there
constexpr double kFlat = 0.01;             // of the output: less over the last third of the force is no rise
constexpr double kStill = 2;               // counts: a taxel that moves less under force does not answer
constexpr std::size_t kMaxRows = 200'000;  // of all taxels; more are thinned evenly
constexpr std::size_t kMaxDots = 4000;

std::map<int, std::vector<Reading>> rowsByTaxel(Measured measurements) {
  std::map<int, std::vector<Reading>> rows;
  for (const Measurement* measurement : measurements) {
    const auto& curve = std::get<ForceCurve>(measurement->data);
    for (std::size_t r = 0; r < curve.taxel.size(); ++r) rows[curve.taxel[r]].push_back({curve.force[r], curve.counts[r]});
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

// Median output at forces from `low` to `high` of the largest; none of fewer than kLeastReadings rows.
std::optional<double> medianAt(const std::vector<Reading>& rows, double most, double low, double high) {
  std::vector<double> counts;
  for (const Reading& row : rows) {
    if (row.force >= low * most && row.force <= high * most) counts.push_back(row.counts);
  }
  if (counts.size() < kLeastReadings) return {};
  return medianOf(std::move(counts));
}

// Where the sensor ends, if it was seen to.
struct Plateau {
  double counts = 0;  // 0: not seen
  double top = 0;     // counts: readings from here on are taken for the plateau's
};

// A converter that clips gives one and the same largest output again and again; an amplifier that does gives about the same, whatever the
// force, and noise upon it.
Plateau plateauOf(const std::map<int, std::vector<Reading>>& rows) {
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
  constexpr double kMedianToDeviation = 1.482602;  // of a Gaussian
  return {std::round(end), std::round(end - kFarNoise * kMedianToDeviation * medianOf(std::move(spreads)))};
}

bool isStill(const std::vector<Reading>& rows) {
  const auto [low, high] =
      std::minmax_element(rows.begin(), rows.end(), [](const Reading& a, const Reading& b) { return a.counts < b.counts; });
  return high->counts - low->counts <= kStill;
}

// Share of a force on one taxel that stays on it.
double ownShare(const Sensor& sensor, int taxel) {
  std::vector<double> force(static_cast<std::size_t>(numTaxels(sensor)));
  force[static_cast<std::size_t>(taxel)] = 1;
  return reference::spread(sensor, force)[static_cast<std::size_t>(taxel)];
}

bool isBorder(const Sensor& sensor, int taxel) {
  for (const GridPatch& patch : sensor.patches) {
    const int count = patch.num_rows * patch.num_cols;
    if (taxel < count) {
      const int row = taxel / patch.num_cols, col = taxel % patch.num_cols;
      return row == 0 || col == 0 || row == patch.num_rows - 1 || col == patch.num_cols - 1;
    }
    taxel -= count;
  }
  return false;
}

std::string rounded(double value) {
  return numberText(std::round(value * 1e3) / 1e3);
}

// All that was found, on its way into the sensor.
class Findings {
 public:
  Findings(const std::vector<PressedTaxel>& taxels, const ReadoutModel& model, const PiecesFit& pieces, const GroupedFit& fit,
           Characterization& result)
      : taxels_(taxels), model_(model), pieces_(pieces), fit_(fit), result_(result), readout_(result.sensor.readout) {}

  void tellCurve();
  void tellHysteresis();
  void tellDrift();
  void tellNoise();
  void tellGains();
  void draw() const;
  ReadoutDoubt doubt() const;

 private:
  void add(std::string parameter, std::string unit, double value, double half_width, std::string remark) {
    result_.estimates.push_back({.parameter = std::move(parameter),
                                 .unit = std::move(unit),
                                 .determined = true,
                                 .value = value,
                                 .low = value - half_width,
                                 .high = value + half_width,
                                 .remark = std::move(remark)});
  }
  // `of_slope`: how S changes with each taxel's own parameters.
  void tellPolynomial(const std::vector<Eigen::VectorXd>& of_slope, const std::string& over);
  void tellPoints(const std::vector<Eigen::VectorXd>& of_slope);
  void tellLimit();
  double slopeOf(std::size_t t) const { return fit_.own[t][0] / taxels_[t].share; }

  const std::vector<PressedTaxel>& taxels_;
  const ReadoutModel& model_;
  const PiecesFit& pieces_;
  const GroupedFit& fit_;
  Characterization& result_;
  Readout& readout_;
  double slope_ = 0;           // S, counts/N
  double slope_by_share_ = 0;  // what half the shares' interval does to it
};

void Findings::tellCurve() {
  const auto count = static_cast<double>(taxels_.size());
  double share = 0, trigger = 0;
  for (std::size_t t = 0; t < taxels_.size(); ++t) {
    slope_ += slopeOf(t) / count;
    share += taxels_[t].share / count;
  }
  std::vector<Eigen::VectorXd> of_slope, of_trigger;
  const Eigen::VectorXd no_shared = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(fit_.shared.size()));
  for (std::size_t t = 0; t < taxels_.size(); ++t) {
    // gain x - trigger is 0 at the first force f: trigger = a f / S.
    const double a = fit_.own[t][0], f = fit_.own[t][1];
    trigger += a * f / slope_ / count;
    of_slope.push_back(Eigen::Vector3d{1 / taxels_[t].share, 0, 0});
    of_trigger.push_back(Eigen::Vector3d{f, a, 0} / slope_);
  }
  // By the shares: S = sum a / w / n.
  for (std::size_t t = 0; t < taxels_.size(); ++t) slope_by_share_ -= slopeOf(t) * taxels_[t].share_half_width / taxels_[t].share / count;
  const std::string over = "mean of " + std::to_string(taxels_.size()) + (taxels_.size() == 1 ? " taxel" : " taxels") +
                           "; the point spread function leaves them " + numberText(std::round(1000 * share) / 10) + " % of a force on them";
  readout_.curve = {slope_};
  readout_.curve_points.clear();
  readout_.output_scale = 1;
  readout_.trigger = std::max(0.0, trigger);
  if (!model_.knots.empty()) {
    tellPoints(of_slope);
    result_.remarks.push_back("readout.curve.points: " + over);
  } else {
    tellPolynomial(of_slope, over);
  }
  readout_.curve_limit = 0;
  if (model_.divider) tellLimit();
  const double trigger_half = std::hypot(fit_.meanHalfWidth(of_trigger, no_shared), trigger * slope_by_share_ / slope_);
  add("readout.trigger", "N", trigger, trigger_half, "");
  if (trigger < -trigger_half) {
    result_.remarks.push_back("the output begins at " + rounded(trigger) +
                              " N, before the force: no readout does, and the sensor's trigger is 0, which shifts its curve by as much");
  }
  const std::string line_end =
      model_.knots.empty() ? "; the straight line would end at " + rounded((trigger + model_.top / slope_) / share) + " N" : "";
  result_.remarks.push_back("a force on one taxel shows from " + rounded(trigger / share) + " N on" + line_end);
}

void Findings::tellPolynomial(const std::vector<Eigen::VectorXd>& of_slope, const std::string& over) {
  const Eigen::VectorXd no_shared = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(fit_.shared.size()));
  add(model_.num_bends == 0 ? "readout.curve.counts_per_newton" : "readout.curve.coefficients[0]", "counts/N", slope_,
      std::hypot(fit_.meanHalfWidth(of_slope, no_shared), slope_by_share_), over);
  for (std::size_t k = 0; k < model_.num_bends; ++k) {
    // b z^(k + 2) / K^(k + 1) with z = S x.
    const auto power = static_cast<double>(k + 2);
    const double factor = slope_ * std::pow(slope_ / model_.top, power - 1);
    std::vector<Eigen::VectorXd> own = of_slope;
    for (Eigen::VectorXd& gradient : own) gradient *= power * fit_.shared[k] * factor / slope_;
    Eigen::VectorXd shared = no_shared;
    shared[static_cast<Eigen::Index>(k)] = factor;
    readout_.curve.push_back(fit_.shared[k] * factor);
    add("readout.curve.coefficients[" + std::to_string(k + 1) + "]", "counts/N^" + std::to_string(k + 2), readout_.curve.back(),
        std::hypot(fit_.meanHalfWidth(own, shared), power * readout_.curve.back() * slope_by_share_ / slope_), "");
  }
}

// At the forces where the knots lie by the slope that was found: how far the slope may be off is in the interval of the output there.
void Findings::tellPoints(const std::vector<Eigen::VectorXd>& of_slope) {
  readout_.curve = Readout{}.curve;
  for (std::size_t k = 0; k < model_.knots.size(); ++k) {
    const KnotOutput output = outputAt(k, model_, fit_.shared);
    const double force = model_.knots[k] / slope_, by_slope = output.slope * force;
    std::vector<Eigen::VectorXd> own = of_slope;
    for (Eigen::VectorXd& gradient : own) gradient *= by_slope;
    readout_.curve_points.push_back({.force = force, .counts = output.counts});
    const double half = std::hypot(fit_.meanHalfWidth(own, output.gradient), by_slope * slope_by_share_);
    add("readout.curve.points[" + std::to_string(k) + "].counts", "counts", output.counts, half, "at " + rounded(force) + " N");
    result_.estimates.back().determined = std::isfinite(half);
  }
  const auto untold = [&](const std::string& where) {
    result_.estimates.push_back({.parameter = "readout.curve.points",
                                 .unit = "counts",
                                 .remark = where + ": fewer than " + std::to_string(kLeastReadings) +
                                           " rows, or none that tell the output there; the curve goes straight through"});
  };
  for (const double z : pieces_.joined) untold("at " + rounded(z / slope_) + " N");
  for (const std::size_t k : pieces_.sparse) {
    const double begin = k > 0 ? model_.knots[k - 1] : 0;
    untold("from " + rounded(begin / slope_) + " to " + rounded(model_.knots[k] / slope_) + " N");
  }
}

void Findings::tellLimit() {
  const double part = fit_.shared[model_.num_bends], half = fit_.halfWidth(model_.num_bends);
  const std::string parameter = "readout.curve.limit";
  if (part > half) {
    readout_.curve_limit = model_.top / part;
    result_.estimates.push_back({.parameter = parameter,
                                 .unit = "counts",
                                 .determined = true,
                                 .value = readout_.curve_limit,
                                 .low = model_.top / (part + half),
                                 .high = model_.top / (part - half),
                                 .remark = ""});
  } else {
    result_.estimates.push_back({.parameter = parameter, .unit = "counts", .remark = "no bend beyond noise: none"});
  }
}

void Findings::tellHysteresis() {
  if (model_.hysteresis) {
    const std::size_t s = model_.lag();
    readout_.hysteresis_strength = {fit_.shared[s]};
    readout_.hysteresis_width = {fit_.shared[s + 1]};
    add("readout.hysteresis_strength", "", fit_.shared[s], fit_.halfWidth(s), "");
    add("readout.hysteresis_width", "N", fit_.shared[s + 1], fit_.halfWidth(s + 1), "");
    return;
  }
  const bool way_back = std::any_of(taxels_.begin(), taxels_.end(), [](const PressedTaxel& taxel) { return hasWayBack(taxel.rows); });
  result_.estimates.push_back({.parameter = "readout.hysteresis_strength",
                               .unit = "",
                               .remark = way_back ? "the ways up and down do not differ beyond noise" : "the force only rises"});
}

void Findings::tellDrift() {
  if (!model_.drifts) return;
  std::vector<double> drifts;
  for (std::size_t t = 0; t < taxels_.size(); ++t) drifts.push_back(std::abs(fit_.own[t][2]));
  result_.remarks.push_back("the zero of taxels drifts from the first row to the last, by " +
                            rounded(*std::max_element(drifts.begin(), drifts.end())) + " N at most, " + rounded(medianOf(drifts)) +
                            " N in the median: fitted, and no part of the sensor");
}

void Findings::tellNoise() {
  const ReadingNoise noise = noiseOf(taxels_, model_, fit_);
  if (noise.degrees_of_freedom == 0) return;
  // Rounding is a part of what is seen, and the simulator rounds by itself.
  readout_.noise = std::sqrt(std::max(0.0, noise.deviation * noise.deviation - kLeastNoise * kLeastNoise));
  add("readout.noise", "counts", readout_.noise,
      studentFactor(noise.degrees_of_freedom) * noise.deviation / std::sqrt(2.0 * static_cast<double>(noise.degrees_of_freedom)),
      "standard deviation of the residuals, without that of rounding");
}

void Findings::tellGains() {
  const auto num_taxels = static_cast<std::size_t>(numTaxels(result_.sensor));
  readout_.taxel_gain.assign(num_taxels, 1);
  readout_.taxel_trigger.assign(num_taxels, readout_.trigger);
  for (const int dead : result_.dead_taxels) readout_.taxel_gain[static_cast<std::size_t>(dead)] = 0;
  double squares = 0;
  std::array<double, 2> sum{}, count{};  // of the middle, of the border
  for (std::size_t t = 0; t < taxels_.size(); ++t) {
    const double gain = slopeOf(t) / slope_;
    const double by_share = gain * (-taxels_[t].share_half_width / taxels_[t].share - slope_by_share_ / slope_);
    const auto at = static_cast<std::size_t>(taxels_[t].taxel);
    readout_.taxel_gain[at] = gain;
    readout_.taxel_trigger[at] = std::max(0.0, fit_.own[t][0] * fit_.own[t][1] / slope_);
    add("readout.taxel_gain[" + std::to_string(at) + "]", "", gain,
        std::hypot(fit_.ownHalfWidth(t, 0) / taxels_[t].share / slope_, by_share), "");
    squares += (gain - 1) * (gain - 1);
    const std::size_t where = isBorder(result_.sensor, taxels_[t].taxel) ? 1 : 0;
    sum[where] += gain;
    count[where] += 1;
  }
  std::string text = "taxel_gain: standard deviation " + rounded(std::sqrt(squares / std::max(1.0, count[0] + count[1] - 1)));
  if (count[0] > 0 && count[1] > 0) {
    text += ", mean of the " + numberText(count[1]) + " taxels at the border " + rounded(sum[1] / count[1]) + ", of the others " +
            rounded(sum[0] / count[0]);
  }
  result_.remarks.push_back(text);
  if (taxels_.size() + result_.dead_taxels.size() < num_taxels) {
    result_.remarks.push_back(std::to_string(num_taxels - taxels_.size() - result_.dead_taxels.size()) +
                              " taxels were not measured: their gain is 1, the mean of those that were");
  }
}

// With gain = a / (w S) and trigger = a f / S.
ReadoutDoubt Findings::doubt() const {
  ReadoutDoubt doubt(static_cast<std::size_t>(numTaxels(result_.sensor)), Eigen::Matrix2d::Zero());
  for (std::size_t t = 0; t < taxels_.size(); ++t) {
    Eigen::Matrix2d of_own{{1 / taxels_[t].share, 0}, {fit_.own[t][1], fit_.own[t][0]}};
    of_own /= slope_;
    Eigen::Matrix3d all = fit_.own_covariance[t];
    if (!fit_.shared.empty()) all += fit_.lean[t] * fit_.covariance * fit_.lean[t].transpose();
    const Eigen::Matrix2d own = all.topLeftCorner<2, 2>();
    if (own.allFinite()) doubt[static_cast<std::size_t>(taxels_[t].taxel)] = of_own * own * of_own.transpose();
  }
  return doubt;
}

// All readings on the scale of the mean taxel.
void Findings::draw() const {
  FitFigure figure{.title = "Output against force, all taxels", .x_label = "force, N", .y_label = "counts", .curves = {}};
  FitFigure::Curve dots{.name = "measured", .measured = true, .x = {}, .y = {}}, line{.name = "the mean taxel, fitted", .x = {}, .y = {}};
  std::size_t total = 0, k = 0;
  double slope = 0, first = 0, most = 0;
  for (std::size_t t = 0; t < taxels_.size(); ++t) {
    total += taxels_[t].rows.size();
    slope += fit_.own[t][0] / static_cast<double>(taxels_.size());
    first += fit_.own[t][1] / static_cast<double>(taxels_.size());
    most = std::max(most, largestForce(taxels_[t].rows));
  }
  const std::size_t every = total / kMaxDots + 1;
  for (const PressedTaxel& taxel : taxels_) {
    for (const Reading& row : taxel.rows) {
      if (k++ % every != 0) continue;
      dots.x.push_back(row.force);
      dots.y.push_back(row.counts);
    }
  }
  constexpr int kPoints = 200;
  for (int p = 0; p <= kPoints; ++p) {
    line.x.push_back(most * p / kPoints);
    line.y.push_back(std::clamp(model_.output(slope * (line.x.back() - first), fit_.shared.data()), 0.0, model_.top));
  }
  figure.curves = {std::move(dots), std::move(line)};
  result_.figures.push_back(std::move(figure));
}

}  // namespace

ReadoutDoubt fitReadout(Measured measurements, const std::optional<PsfRange>& psf_range, Characterization& result) {
  std::map<int, std::vector<Reading>> rows = rowsByTaxel(measurements);
  Readout& readout = result.sensor.readout;
  const Plateau plateau = plateauOf(rows);
  ReadoutModel model{.top = plateau.counts > 0 ? plateau.top : readout.saturation};
  for (auto& [taxel, all] : rows) {
    for (Reading& row : all) row.counts = std::min(row.counts, model.top);
  }
  int num_pieces = 0;
  for (const Measurement* measurement : measurements) {
    const auto& curve = std::get<ForceCurve>(measurement->data);
    model.divider = model.divider || curve.divider;
    model.num_bends = std::max(model.num_bends, static_cast<std::size_t>(curve.curve_degree - 1));
    num_pieces = std::max(num_pieces, curve.curve_segments);
    if (num_pieces > 0 && (model.divider || model.num_bends > 0)) {
      throw Error(ErrorKind::kInput, measurement->file.generic_string() +
                                         ": curve_segments stands beside curve_degree or divider of the same sensor: either, not both");
    }
  }

  std::vector<PressedTaxel> taxels;
  std::vector<FitResult> lines;
  std::vector<double> deviations;
  for (const auto& [taxel, all] : rows) {
    if (isStill(all)) {
      result.dead_taxels.push_back(taxel);
      continue;
    }
    std::optional<FitResult> line = straightLine(all, model.top);
    if (!line) {
      result.remarks.push_back("taxel " + std::to_string(taxel) + ": fewer than " + std::to_string(kLeastReadings) +
                               " rows between trigger and saturation, left out");
      continue;
    }
    taxels.push_back({.taxel = taxel, .share = ownShare(result.sensor, taxel), .share_half_width = 0, .rows = all, .used = {}});
    if (psf_range) {
      Sensor low = result.sensor, high = result.sensor;
      low.psf = psf_range->low;
      high.psf = psf_range->high;
      taxels.back().share_half_width = (ownShare(high, taxel) - ownShare(low, taxel)) / 2;
    }
    deviations.push_back(line->residual_sd);
    lines.push_back(std::move(*line));
  }
  if (taxels.empty()) {
    const std::string still = result.dead_taxels.empty() ? "" : "; " + std::to_string(result.dead_taxels.size()) + " did not answer at all";
    throw Error(ErrorKind::kInput, measurements.front()->file.generic_string() + ": no taxel has " + std::to_string(kLeastReadings) +
                                       " rows between trigger and saturation" + still);
  }
  model.noise = std::max(kLeastNoise, medianOf(deviations));
  for (std::size_t t = 0; t < taxels.size(); ++t) taxels[t].used = rowsThatTell(taxels[t].rows, lines[t], model.top, model.noise);

  PiecesFit pieces;
  if (num_pieces > 0) pieces = fitPieces(taxels, static_cast<std::size_t>(num_pieces), lines, model);
  GroupedFit fit = num_pieces > 0 ? std::move(pieces.fit) : fitReadoutModel(taxels, lines, model, 0);
  for (; model.num_bends > 0 && !rises(model, fit, taxels); fit = fitReadoutModel(taxels, lines, model, 0)) {
    result.remarks.push_back("a curve of degree " + std::to_string(model.num_bends + 1) +
                             " would fall somewhere in the range: one degree less");
    --model.num_bends;
  }
  fit = withHysteresisAndDrift(taxels, lines, model, std::move(fit));

  Findings findings(taxels, model, pieces, fit, result);
  findings.tellCurve();
  if (plateau.counts > 0) {
    readout.saturation = static_cast<int>(plateau.counts);
    result.estimates.push_back({.parameter = "readout.saturation",
                                .unit = "counts",
                                .determined = true,
                                .value = plateau.counts,
                                .low = plateau.counts,
                                .high = plateau.counts,
                                .remark = "seen as a plateau"});
  } else {
    result.estimates.push_back({.parameter = "readout.saturation",
                                .unit = "counts",
                                .remark = "no plateau in the output: the sensor file's " + std::to_string(readout.saturation) + " stays"});
  }
  findings.tellHysteresis();
  findings.tellDrift();
  findings.tellNoise();
  findings.tellGains();
  findings.draw();
  std::size_t num_rows = 0;
  for (const PressedTaxel& taxel : taxels) num_rows += taxel.rows.size();
  result.fits.push_back({.measurement = measurements.front()->name,
                         .unit = "counts",
                         .rms = fit.residual_sd,
                         .num_rows = num_rows,
                         .num_outliers = fit.num_outliers + pieces.num_gross});
  return findings.doubt();
}

}  // namespace taxelsim
