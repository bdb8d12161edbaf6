#include "characterize/readout_report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "base/text.h"
#include "characterize/clipped_mean.h"
#include "characterize/temperature.h"

namespace taxelsim {
namespace {

constexpr std::size_t kMaxReadingDots = 4000;

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

std::string thousandths(double value) {
  return numberText(std::round(value * 1e3) / 1e3);
}

class ReadoutReport {
 public:
  ReadoutReport(const ReadoutFit& fit, Characterization& result)
      : taxels_(fit.taxels),
        model_(fit.model),
        pieces_(fit.pieces),
        fit_(fit.fit),
        result_(result),
        readout_(result.sensor.readout),
        slope_(meanSlope(fit)) {}

  void reportCurve();
  void reportSaturation(const Plateau& plateau);
  void reportHysteresis();
  void reportDrift();
  void reportTemperature();
  void reportNoise();
  void reportGains();
  void draw() const;

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
  // `of_slope`: (taxels), gradients of S in each taxel's own parameters.
  void reportPolynomial(const std::vector<Eigen::VectorXd>& of_slope, const std::string& over);
  void reportPoints(const std::vector<Eigen::VectorXd>& of_slope);
  void reportLimit();
  void reportTrigger(double trigger, double half_width, double share);
  double slopeOf(std::size_t t) const { return fit_.own[t][0] / taxels_[t].share; }

  const std::vector<PressedTaxel>& taxels_;
  const ReadoutModel& model_;
  const PiecesFit& pieces_;
  const GroupedFit& fit_;
  Characterization& result_;
  Readout& readout_;
  double slope_;               // S, counts/N
  double least_trigger_ = 0;   // N: 0 unless the output at rest is above 0
  double slope_by_share_ = 0;  // change of S over half of the shares' interval
};

void ReadoutReport::reportCurve() {
  const auto count = static_cast<double>(taxels_.size());
  double share = 0, trigger = 0;
  for (const PressedTaxel& taxel : taxels_) share += taxel.share / count;
  std::vector<Eigen::VectorXd> of_slope, of_trigger;
  const Eigen::VectorXd no_shared = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(fit_.shared.size()));
  for (std::size_t t = 0; t < taxels_.size(); ++t) {
    // gain x - trigger is 0 at the first force f: trigger = a f / S.
    const double a = fit_.own[t][0], f = fit_.own[t][1];
    trigger += a * f / slope_ / count;
    of_slope.push_back(Eigen::Vector3d{1 / taxels_[t].share, 0, 0});
    of_trigger.push_back(Eigen::Vector3d{f, a, 0} / slope_);
  }
  // Through the shares w: S = sum a / w / n.
  for (std::size_t t = 0; t < taxels_.size(); ++t) slope_by_share_ -= slopeOf(t) * taxels_[t].share_half_width / taxels_[t].share / count;
  const std::string over = "mean of " + std::to_string(taxels_.size()) + (taxels_.size() == 1 ? " taxel" : " taxels") +
                           "; the point spread function leaves " + numberText(std::round(1000 * share) / 10) + " % of a force on its taxel";
  readout_.curve = {slope_};
  readout_.curve_points.clear();
  readout_.output_scale = 1;
  const double trigger_half = std::hypot(fit_.meanHalfWidth(of_trigger, no_shared), trigger * slope_by_share_ / slope_);
  least_trigger_ = trigger < -trigger_half ? -std::numeric_limits<double>::infinity() : 0;
  readout_.trigger = std::max(least_trigger_, trigger);
  if (!model_.knots.empty()) {
    reportPoints(of_slope);
    result_.remarks.push_back("readout.curve.points: " + over);
  } else {
    reportPolynomial(of_slope, over);
  }
  readout_.curve_limit = 0;
  if (model_.divider) reportLimit();
  reportTrigger(trigger, trigger_half, share);
}

void ReadoutReport::reportTrigger(double trigger, double half_width, double share) {
  add("readout.trigger", "N", trigger, half_width, "");
  if (least_trigger_ < 0)
    result_.remarks.push_back("the output begins at a force of " + thousandths(trigger) + " N, below 0: taxels read without a load");
  const double line_end = (trigger + model_.top / slope_) / share;
  result_.remarks.push_back("force on one taxel: detection threshold " + thousandths(trigger / share) + " N" +
                            (model_.knots.empty() ? "; linear range to " + numberText(std::round(line_end * 100) / 100) + " N" : ""));
}

void ReadoutReport::reportPolynomial(const std::vector<Eigen::VectorXd>& of_slope, const std::string& over) {
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

// Points lie at the knots' forces by the fitted slope. The intervals of the outputs include the uncertainty of the slope.
void ReadoutReport::reportPoints(const std::vector<Eigen::VectorXd>& of_slope) {
  readout_.curve = Readout{}.curve;
  for (std::size_t k = 0; k < model_.knots.size(); ++k) {
    const KnotOutput output = outputAt(k, model_, fit_.shared);
    const double force = model_.knots[k] / slope_, by_slope = output.slope * force;
    std::vector<Eigen::VectorXd> own = of_slope;
    for (Eigen::VectorXd& gradient : own) gradient *= by_slope;
    readout_.curve_points.push_back({.force = force, .counts = output.counts});
    const double half = std::hypot(fit_.meanHalfWidth(own, output.gradient), by_slope * slope_by_share_);
    add("readout.curve.points[" + std::to_string(k) + "].counts", "counts", output.counts, half, "at " + thousandths(force) + " N");
    result_.estimates.back().determined = std::isfinite(half);
  }
  const auto reportMissing = [&](const std::string& where) {
    result_.estimates.push_back(
        {.parameter = "readout.curve.points",
         .unit = "counts",
         .remark = where + ": fewer than " + std::to_string(kLeastReadings) + " informative rows; the curve is straight there"});
  };
  for (const double z : pieces_.joined) reportMissing("at " + thousandths(z / slope_) + " N");
  for (const std::size_t k : pieces_.sparse) {
    const double begin = k > 0 ? model_.knots[k - 1] : 0;
    reportMissing("from " + thousandths(begin / slope_) + " to " + thousandths(model_.knots[k] / slope_) + " N");
  }
}

void ReadoutReport::reportLimit() {
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
    result_.estimates.push_back({.parameter = parameter, .unit = "counts", .remark = "no saturation above the noise: no limit"});
  }
}

void ReadoutReport::reportSaturation(const Plateau& plateau) {
  const bool seen = plateau.counts > 0;
  if (seen) readout_.saturation = static_cast<int>(plateau.counts);
  result_.estimates.push_back({.parameter = "readout.saturation",
                               .unit = "counts",
                               .determined = seen,
                               .value = plateau.counts,
                               .low = plateau.counts,
                               .high = plateau.counts,
                               .remark = seen
                                             ? "plateau in the output"
                                             : "no plateau in the output; keeps the sensor file's " + std::to_string(readout_.saturation)});
}

void ReadoutReport::reportHysteresis() {
  if (model_.hysteresis) {
    const std::size_t s = model_.lag();
    readout_.hysteresis_strength = {fit_.shared[s]};
    readout_.hysteresis_width = {fit_.shared[s + 1]};
    add("readout.hysteresis_strength", "", fit_.shared[s], fit_.halfWidth(s), "");
    add("readout.hysteresis_width", "N", fit_.shared[s + 1], fit_.halfWidth(s + 1), "");
    return;
  }
  const bool unloads = std::any_of(taxels_.begin(), taxels_.end(), [](const PressedTaxel& taxel) { return hasUnloading(taxel.rows); });
  result_.estimates.push_back(
      {.parameter = "readout.hysteresis_strength",
       .unit = "",
       .remark = unloads ? "loading and unloading do not differ above the noise" : "no unloading in the measurements"});
}

void ReadoutReport::reportDrift() {
  if (!model_.drifts) return;
  std::vector<double> drifts;
  for (std::size_t t = 0; t < taxels_.size(); ++t) drifts.push_back(std::abs(fit_.own[t][2]));
  result_.remarks.push_back("the zero of taxels drifts over the measurement by up to " +
                            thousandths(*std::max_element(drifts.begin(), drifts.end())) + " N, median " + thousandths(medianOf(drifts)) +
                            " N: fitted, but not part of the sensor file");
}

void ReadoutReport::reportTemperature() {
  if (!model_.warms) return;
  const std::size_t at = model_.warm();
  const double of_trigger = fit_.shared[at + 1] / slope_;
  addTemperature(result_, {fit_.shared[at], fit_.halfWidth(at)}, {of_trigger, fit_.halfWidth(at + 1) / slope_});
}

void ReadoutReport::reportNoise() {
  const ReadingNoise noise = noiseOf(taxels_, model_, fit_);
  if (noise.degrees_of_freedom == 0) return;
  // The residuals include rounding, which the simulator adds itself.
  readout_.noise = std::sqrt(std::max(0.0, noise.deviation * noise.deviation - kLeastNoise * kLeastNoise));
  add("readout.noise", "counts", readout_.noise,
      studentFactor(noise.degrees_of_freedom) * noise.deviation / std::sqrt(2.0 * static_cast<double>(noise.degrees_of_freedom)),
      "standard deviation of the residuals, without rounding");
}

void ReadoutReport::reportGains() {
  const auto num_taxels = static_cast<std::size_t>(numTaxels(result_.sensor));
  readout_.taxel_gain.assign(num_taxels, 1);
  readout_.taxel_trigger.assign(num_taxels, readout_.trigger);
  for (const int dead : result_.dead_taxels) {
    readout_.taxel_gain[static_cast<std::size_t>(dead)] = 0;
    readout_.taxel_trigger[static_cast<std::size_t>(dead)] = std::max(0.0, readout_.trigger);
  }
  double squares = 0;
  std::array<double, 2> sum{}, count{};  // inner taxels, border taxels
  for (std::size_t t = 0; t < taxels_.size(); ++t) {
    const double gain = slopeOf(t) / slope_;
    const double by_share = gain * (-taxels_[t].share_half_width / taxels_[t].share - slope_by_share_ / slope_);
    const auto at = static_cast<std::size_t>(taxels_[t].taxel);
    readout_.taxel_gain[at] = gain;
    readout_.taxel_trigger[at] = std::max(least_trigger_, fit_.own[t][0] * fit_.own[t][1] / slope_);
    add("readout.taxel_gain[" + std::to_string(at) + "]", "", gain,
        std::hypot(fit_.ownHalfWidth(t, 0) / taxels_[t].share / slope_, by_share), "");
    squares += (gain - 1) * (gain - 1);
    const std::size_t where = isBorder(result_.sensor, taxels_[t].taxel) ? 1 : 0;
    sum[where] += gain;
    count[where] += 1;
  }
  std::string text = "taxel_gain: standard deviation " + thousandths(std::sqrt(squares / std::max(1.0, count[0] + count[1] - 1)));
  if (count[0] > 0 && count[1] > 0) {
    text += "; mean of the " + numberText(count[1]) + " border taxels " + thousandths(sum[1] / count[1]) + ", of the others " +
            thousandths(sum[0] / count[0]);
  }
  result_.remarks.push_back(text);
  if (taxels_.size() + result_.dead_taxels.size() < num_taxels) {
    result_.remarks.push_back(std::to_string(num_taxels - taxels_.size() - result_.dead_taxels.size()) +
                              " taxels were not measured: their gain is set to 1, the mean of the measured ones");
  }
}

// All readings, and the curve of the mean taxel.
void ReadoutReport::draw() const {
  FitFigure figure{.title = "Output against force, all taxels", .x_label = "force, N", .y_label = "counts", .curves = {}};
  FitFigure::Curve dots{.name = "measured", .measured = true, .x = {}, .y = {}}, line{.name = "fit for the mean taxel", .x = {}, .y = {}};
  std::size_t total = 0, k = 0;
  double slope = 0, first = 0, most = 0;
  for (std::size_t t = 0; t < taxels_.size(); ++t) {
    total += taxels_[t].rows.size();
    slope += fit_.own[t][0] / static_cast<double>(taxels_.size());
    first += fit_.own[t][1] / static_cast<double>(taxels_.size());
    most = std::max(most, largestForce(taxels_[t].rows));
  }
  const std::size_t every = total / kMaxReadingDots + 1;
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

double meanSlope(const ReadoutFit& found) {
  double slope = 0;
  const auto count = static_cast<double>(found.taxels.size());
  for (std::size_t t = 0; t < found.taxels.size(); ++t) slope += found.fit.own[t][0] / found.taxels[t].share / count;
  return slope;
}

void reportReadout(const ReadoutFit& found, Characterization& result) {
  ReadoutReport report(found, result);
  report.reportCurve();
  report.reportSaturation(found.plateau);
  report.reportHysteresis();
  report.reportDrift();
  report.reportTemperature();
  report.reportNoise();
  report.reportGains();
  report.draw();
}

}  // namespace taxelsim
