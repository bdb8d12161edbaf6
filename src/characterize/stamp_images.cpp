// Images over time under a flat stamp with a dead weight that lies where it lies: its place, turn and tilt are fitted together with what
// all measurements share, the spread, the readout's curve, trigger and gains, on curved skins the stiffness (stamp_model.h).
//
// The image of a measurement is the median, taxel by taxel, of the frames from 4.5 to 5.5 s after the touch.
#include <algorithm>
#include <cmath>
#include <utility>

#include "base/text.h"
#include "characterize/clipped_mean.h"
#include "characterize/creep.h"
#include "characterize/fits.h"
#include "characterize/least_squares.h"
#include "characterize/stamp_model.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

using namespace stamp_own;
using namespace stamp_shared;

constexpr double kWindowBegin = 4.5, kWindowEnd = 5.5;  // s after the touch
constexpr double kSteady = 5;                           // s after the touch: what the image stands for
constexpr double kStill = 2;                            // counts
constexpr std::size_t kLeastImagesForGains = 6;
// Of the trigger, and counts: what a reading at 5 s exceeds that showed from the onset.
constexpr double kClearOfTrigger = 0.5, kClearCounts = 20;

CreepSeries sumOf(const Measurement& measurement, const Images& images) {
  CreepSeries sum{.file = measurement.file.generic_string(), .time = images.time, .values = {}};
  for (std::size_t row = 0; row < images.time.size(); ++row) {
    double total = 0;
    for (std::size_t t = 0; t < images.num_taxels; ++t) total += images.counts[row * images.num_taxels + t];
    sum.values.push_back(total);
  }
  return sum;
}

Stamp stampOf(const Measurement& measurement) {
  Stamp stamp{.measurement = &measurement, .data = &std::get<StampImages>(measurement.data), .sum = {}, .image = {}, .taxels = {}};
  const Images& images = stamp.data->images;
  stamp.sum = sumOf(measurement, images);
  if (*std::max_element(stamp.sum.values.begin(), stamp.sum.values.end()) <= kStill) {
    throw Error(ErrorKind::kInput, stamp.sum.file + ": nothing touches: all counts together never exceed 2");
  }
  const Onset onset = onsetOf(stamp.sum);
  for (std::size_t t = 0; t < images.num_taxels; ++t) {
    std::vector<double> counts;
    for (std::size_t row = onset.first_row; row < onset.end_row; ++row) {
      const double after = images.time[row] - onset.start;
      if (after >= kWindowBegin && after <= kWindowEnd) counts.push_back(images.counts[row * images.num_taxels + t]);
    }
    if (counts.empty()) {
      throw Error(ErrorKind::kInput, stamp.sum.file + ": no frame under load from " + numberText(kWindowBegin) + " to " +
                                         numberText(kWindowEnd) + " s after the touch");
    }
    stamp.image.push_back(medianOf(std::move(counts)));
  }
  return stamp;
}

// Standard deviation (counts) of readings that no end clips.
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

double gainOf(const StampModel& model, const StampFit& found, std::size_t taxel) {
  return found.fit.shared[model.gainsAt() + taxel];
}

// Spread of the gain of presses, by how far each image's best scale is from 1; 0 where noise alone explains it.
double pressSpread(const StampModel& model, const StampFit& found) {
  constexpr double kStep = 1e-4;  // of the gain
  double squares = 0, expected = 0, chi = 0;
  const auto count = static_cast<double>(model.stamps.size());
  for (std::size_t g = 0; g < model.stamps.size(); ++g) {
    double product = 0, power = 0;
    for (const std::size_t t : model.stamps[g].taxels) {
      const double counts = model.stamps[g].image[t], force = gainOf(model, found, t) * found.force[g][t];
      if (counts <= 0 || counts >= model.curve.top) continue;
      const auto output = [&](double press) { return outputOf(model, found.fit.shared, press * force); };
      const double growth = (output(1 + kStep) - output(1 - kStep)) / (2 * kStep);
      product += (counts - output(1)) * growth;
      power += growth * growth;
    }
    if (!(power > 0)) continue;
    const double off = product / power, variance = model.curve.noise * model.curve.noise / power;
    squares += off * off, expected += variance, chi += off * off / variance;
  }
  const bool significant = model.stamps.size() >= 3 && chi > count + 4 * std::sqrt(2 * count);
  return significant ? std::sqrt(std::max(0.0, squares - expected) / (count - 1)) : 0;
}

// The places that the images' middles say, unturned.
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

// The fit with what is worth its further numbers by more than chance.
class Choice {
 public:
  explicit Choice(StampModel& model) : model_(model) {}

  // What reads between the ends first, then all; then gains, curve, spread of presses, tilt.
  StampFit choose(std::vector<std::string>& remarks);

 private:
  StampFit fitted(const StampModel& model, const StampFit& from) const {
    StampFit result = fitStampModel(model, from.fit.shared, from.fit.own);
    result.curve = from.curve;
    return result;
  }
  // With the noise that it shows, again.
  void settle(StampModel& model, StampFit& found) const {
    model.curve.noise = noiseOf(model, found);
    found = fitted(model, found);
    model.curve.noise = noiseOf(model, found);
  }
  // Takes `with` if it is better than `found` by more than chance, with `more` further parameters.
  bool takeIfBetter(const StampModel& with, StampFit other, double more, StampFit& found) const {
    const double noise = noiseOf(with, other), freedom = static_cast<double>(other.fit.degrees_of_freedom);
    if (!isBetterFit(cutSquares(found.fit, noise), cutSquares(other.fit, noise), more, freedom)) return false;
    model_ = with;
    model_.curve.noise = noise;
    found = std::move(other);
    return true;
  }
  // A curve that ends at a limit, or one that begins flat and ends there: x + b x^2, b >= 0, through a divider.
  void bendCurve(StampFit& found) const;
  // Gains of presses, if they differ by more than noise: the more they are found to differ, the freer they are.
  void freePresses(StampModel& model, StampFit& found) const;

  StampModel& model_;
};

void Choice::freePresses(StampModel& model, StampFit& found) const {
  // Two rounds: beyond, presses get whatever the rest of the model does not explain.
  constexpr int kRounds = 2;
  model.press_spread = pressSpread(model, found);
  const auto count = static_cast<double>(model.stamps.size());
  for (int round = 0; model.press_spread > 0 && round < kRounds; ++round) {
    settle(model, found);
    double squares = 0;
    for (std::size_t g = 0; g < model.stamps.size(); ++g) {
      squares += (found.fit.own[g][kPress] - 1) * (found.fit.own[g][kPress] - 1) + found.fit.own_variance[g][kPress];
    }
    const double before = std::exchange(model.press_spread, std::sqrt(squares / count));
    if (std::abs(model.press_spread - before) < 0.02 * before) break;
  }
}

void Choice::bendCurve(StampFit& found) const {
  StampModel limited = model_, bent = model_;
  limited.curve.divider = bent.curve.divider = true;
  bent.curve.num_bends = 1;
  // What is new comes before the gains, and begins at none.
  const auto start = [&](std::size_t count) {
    std::vector<double> shared = found.fit.shared;
    shared.insert(shared.begin() + kCurve, count, 0.0);
    return shared;
  };
  StampFit with_limit = fitStampModel(limited, start(1), found.fit.own), with_both = fitStampModel(bent, start(2), found.fit.own);
  const bool taken = takeIfBetter(limited, std::move(with_limit), 1, found);
  if (takeIfBetter(bent, std::move(with_both), taken ? 1 : 2, found) || taken) settle(model_, found);
}

StampFit Choice::choose(std::vector<std::string>& remarks) {
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
  model_.with_gains = model_.stamps.size() >= kLeastImagesForGains;
  if (model_.with_gains) settle(model_, found);

  // Presses that differ look like a curve that bends, and the other way round: the curve is taken if with it presses differ less, by more
  // than chance in one case of twenty, since presses are few.
  StampModel straight = model_;
  StampFit straight_fit = found;
  bendCurve(found);
  const std::size_t num_curve_numbers = model_.curve.lag();
  if (num_curve_numbers > 0) found.curve = found.fit;
  freePresses(straight, straight_fit);
  if (straight.press_spread > 0) {
    freePresses(model_, found);
    const auto presses = static_cast<double>(model_.stamps.size() - 1), more = static_cast<double>(num_curve_numbers);
    if (num_curve_numbers > 0 && !isBetterFit(presses * straight.press_spread * straight.press_spread,
                                              presses * model_.press_spread * model_.press_spread, more, presses - more, kOneInTwenty)) {
      model_ = std::move(straight);
      found = std::move(straight_fit);
    }
  }

  StampModel with = model_;
  with.with_tilt = true;
  if (takeIfBetter(with, fitted(with, found), 2.0 * static_cast<double>(model_.stamps.size()), found)) {
    remarks.emplace_back("stamps lie tilted, by more than chance: their slopes are fitted");
  }
  return found;
}

void add(Characterization& result, std::string parameter, std::string unit, double value, double half, std::string remark,
         std::string doubt) {
  const bool determined = std::isfinite(half) && doubt.empty();
  if (doubt.empty() && !determined) doubt = "the images do not tell it";
  result.estimates.push_back({.parameter = std::move(parameter),
                              .unit = std::move(unit),
                              .determined = determined,
                              .value = value,
                              .low = value - half,
                              .high = value + half,
                              .remark = determined ? std::move(remark) : std::move(doubt)});
}

FitFigure figureOf(const StampModel& model, const StampFit& found) {
  FitFigure figure{.title = "Readings under stamps", .x_label = "as fitted, counts", .y_label = "counts", .curves = {}};
  double most = 0;
  for (std::size_t g = 0; g < model.stamps.size(); ++g) {
    FitFigure::Curve dots{.name = model.stamps[g].measurement->name, .measured = true, .x = {}, .y = {}};
    for (std::size_t k = 0; k < model.stamps[g].taxels.size(); ++k) {
      const double counts = model.stamps[g].image[model.stamps[g].taxels[k]];
      dots.x.push_back(counts + found.fit.residual[g][k]);
      dots.y.push_back(counts);
      most = std::max(most, counts);
    }
    figure.curves.push_back(std::move(dots));
  }
  figure.curves.push_back({.name = "equal", .x = {0, most}, .y = {0, most}});
  return figure;
}

// All that was found, on its way into the sensor.
class Findings {
 public:
  Findings(const StampModel& model, const StampFit& found, Characterization& result)
      : model_(model),
        found_(found),
        fit_(found.fit),
        result_(result),
        over_(std::to_string(model.stamps.size()) + (model.stamps.size() == 1 ? " image" : " images")) {
    chooseGains();
  }

  void tellSpread();
  void tellCreep();  // before the curve, which is told without it
  void tellCurve();
  void tellPresses();
  void tellStiffness();
  void tellGains();
  void tellPlaces();

 private:
  void chooseGains();
  double gain(std::size_t taxel) const { return gainOf(model_, found_, taxel); }
  Eigen::VectorXd gradient() const { return Eigen::VectorXd::Zero(static_cast<Eigen::Index>(fit_.shared.size())); }
  Eigen::Index gainAt(std::size_t taxel) const { return static_cast<Eigen::Index>(model_.gainsAt() + taxel); }
  // As the sensor reads 5 s after the touch.
  Readout steadyReadout() const;

  const StampModel& model_;
  const StampFit& found_;
  const GroupedFit& fit_;
  Characterization& result_;
  std::string over_;
  std::vector<std::size_t> loaded_;
  double mean_gain_ = 1;               // of the loaded; the scale's
  double grown_ = 1, grown_half_ = 0;  // by creep, at 5 s
};

void Findings::chooseGains() {
  if (!model_.with_gains) return;
  double sum = 0;
  for (std::size_t t = 0; t < model_.gain.size(); ++t) {
    if (!model_.isLoaded(t)) continue;
    loaded_.push_back(t);
    sum += gain(t);
  }
  if (!loaded_.empty()) mean_gain_ = sum / static_cast<double>(loaded_.size());
}

void Findings::tellSpread() {
  const double sigma = fit_.shared[kSigma], unit = model_.sigmaUnit();
  const bool list = model_.isListOfTaxels();
  add(result_, list ? "psf.skin_gaussian.sigma" : "psf.gaussian.sigma", list ? "m" : "taxels", sigma, fit_.halfWidth(kSigma), over_,
      sigma > 0.2 * unit && sigma < 3.9 * unit ? "" : "the images do not tell it");
  if (!result_.estimates.back().determined) return;
  if (list) {
    result_.sensor.psf = Psf{.size = 1, .kernel = {1}, .sigma = sigma};
  } else {
    result_.sensor.psf = gaussianPsf(sigma, gaussianKernelSize(sigma, std::max(3, result_.sensor.psf.size)));
  }
}

Readout Findings::steadyReadout() const {
  Readout readout = result_.sensor.readout;
  readout.output_scale = 1;
  readout.trigger = fit_.shared[kTrigger] / fit_.shared[kScale];
  readout.curve = {fit_.shared[kScale]};
  readout.curve_points.clear();
  for (std::size_t k = 0; k < model_.curve.num_bends; ++k) {
    readout.curve.push_back(fit_.shared[kCurve + k] * fit_.shared[kScale] *
                            std::pow(fit_.shared[kScale] / model_.curve.top, static_cast<double>(k + 1)));
  }
  const double part = model_.curve.divider ? fit_.shared[kCurve + model_.curve.num_bends] : 0;
  readout.curve_limit = part > 0 ? model_.curve.top / part : 0;
  return readout;
}

void Findings::tellCreep() {
  const Readout steady = steadyReadout();
  std::vector<CreepSeries> series;
  for (std::size_t g = 0; g < model_.stamps.size(); ++g) {
    const Stamp& stamp = model_.stamps[g];
    // Taxels near the trigger are left out: what they show begins late.
    std::vector<std::size_t> clear;
    for (std::size_t k = 0; k < stamp.taxels.size(); ++k) {
      const double reading = stamp.image[stamp.taxels[k]];
      const bool is_clear = reading > kClearOfTrigger * fit_.shared[kTrigger] + kClearCounts && reading < model_.curve.top;
      if (is_clear && !fit_.outlier[g][k]) clear.push_back(stamp.taxels[k]);
    }
    if (clear.empty()) {
      result_.remarks.push_back(stamp.measurement->name + ": no taxel reads well over the trigger, its creep is not fitted");
      continue;
    }
    CreepSeries forces{.file = stamp.sum.file, .time = stamp.sum.time, .values = std::vector<double>(stamp.sum.time.size())};
    for (std::size_t row = 0; row < forces.time.size(); ++row) {
      for (const std::size_t t : clear) {
        forces.values[row] += nominalForce(steady, stamp.data->images.counts[row * stamp.data->images.num_taxels + t]);
      }
    }
    series.push_back(std::move(forces));
  }
  if (series.empty()) return;
  const CreepFit creep = fitCreepTerms(series);
  addCreep(creep, series, model_.stamps.front().measurement->name, "of the sum of forces that taxels well over the trigger show", result_);
  if (!creep.onsets.empty()) grown_ = 0;
  for (const Onset& onset : creep.onsets) {
    grown_ += creepFactor(creep.terms, kSteady - (onset.time - onset.start)) / static_cast<double>(creep.onsets.size());
  }
  for (std::size_t i = 0; i < creep.terms.size(); ++i) grown_half_ += creep.fraction_half[i] * -std::expm1(-kSteady / creep.terms[i].time);
}

void Findings::tellCurve() {
  Readout& readout = result_.sensor.readout;
  const double slope = fit_.shared[kScale] * mean_gain_ / grown_;
  // Relative growth of the slope.
  Eigen::VectorXd of_slope = gradient();
  of_slope[kScale] = 1 / fit_.shared[kScale];
  for (const std::size_t t : loaded_) of_slope[gainAt(t)] = 1 / (mean_gain_ * static_cast<double>(loaded_.size()));
  const double by_creep = grown_half_ / grown_;
  const std::string before_creep = "before creep, which is " + numberText(std::round((grown_ - 1) * 1e4) / 100) + " % at 5 s";
  double slope_half = fit_.halfWidthOf(of_slope);
  if (found_.curve) slope_half = std::max(slope_half, found_.curve->halfWidthOf(of_slope));
  slope_half = slope * std::hypot(slope_half, by_creep);
  add(result_, model_.curve.num_bends == 0 ? "readout.curve.counts_per_newton" : "readout.curve.coefficients[0]", "counts/N", slope,
      slope_half, before_creep, "");
  if (!result_.estimates.back().determined) return;
  readout.curve = {slope};
  readout.curve_points.clear();
  readout.output_scale = 1;
  for (std::size_t k = 0; k < model_.curve.num_bends; ++k) {
    // b z^(k + 2) / K^(k + 1) with z = S x.
    const auto power = static_cast<double>(k + 2);
    const double factor = slope * std::pow(slope / model_.curve.top, power - 1), value = fit_.shared[kCurve + k] * factor;
    readout.curve.push_back(value);
    add(result_, "readout.curve.coefficients[" + std::to_string(k + 1) + "]", "counts/N^" + std::to_string(k + 2), value,
        std::hypot(power * value / slope * slope_half, factor * found_.curve->halfWidth(kCurve + k)), "", "");
  }
  readout.curve_limit = 0;
  if (model_.curve.divider) {
    const std::size_t at = kCurve + model_.curve.num_bends;
    const double part = fit_.shared[at], half = found_.curve->halfWidth(at);
    readout.curve_limit = part > 0 ? model_.curve.top / part : 0;
    add(result_, "readout.curve.limit", "counts", readout.curve_limit, readout.curve_limit * half / part, over_,
        part > half ? "" : "no bend beyond noise");
  }
  const double trigger = fit_.shared[kTrigger] / slope;
  Eigen::VectorXd of_trigger = -trigger * of_slope;
  of_trigger[kTrigger] += 1 / slope;
  const double half = std::hypot(fit_.halfWidthOf(of_trigger), trigger * by_creep);
  add(result_, "readout.trigger", "N", trigger, half, over_, trigger > half ? "" : "its interval reaches 0");
  if (result_.estimates.back().determined) {
    readout.trigger = trigger;
    readout.taxel_trigger.clear();
  }
}

void Findings::tellPresses() {
  if (!(model_.press_spread > 0)) return;
  const std::size_t freedom = model_.stamps.size() - 1;
  // Of a standard deviation of few values the logarithm is nearer to Gaussian than itself.
  const double factor = std::exp(studentFactor(freedom) / std::sqrt(2.0 * static_cast<double>(freedom)));
  result_.estimates.push_back({.parameter = "readout.press_gain_spread",
                               .unit = "",
                               .determined = true,
                               .value = model_.press_spread,
                               .low = model_.press_spread / factor,
                               .high = model_.press_spread * factor,
                               .remark = "between the " + over_});
  result_.sensor.readout.press_gain_spread = std::min(model_.press_spread, kMaxGainSpread);
}

void Findings::tellStiffness() {
  if (model_.is_plane) return;
  const double stiffness = std::exp(fit_.shared[kStiffness]), half = stiffness * fit_.halfWidth(kStiffness);
  add(result_, "skin.normal_contact_stiffness", model_.foundation.normal_exponent == 1 ? "N/m^3" : "Pa/m^n", stiffness, half,
      "by how far the stamp reaches over the curved skin", half < stiffness ? "" : "the images do not tell it");
  if (auto* const law = std::get_if<Winkler>(&result_.sensor.skin.law); law != nullptr && result_.estimates.back().determined) {
    law->normal_contact_stiffness = stiffness;
  }
}

void Findings::tellGains() {
  if (!model_.with_gains) return;
  std::vector<double>& gains = result_.sensor.readout.taxel_gain;
  gains.clear();
  for (const double known : model_.gain) gains.push_back(known > 0 ? 1 : 0);
  for (const std::size_t t : loaded_) {
    gains[t] = gain(t) / mean_gain_;
    Eigen::VectorXd of_gain = gradient();
    for (const std::size_t other : loaded_) {
      of_gain[gainAt(other)] = -gains[t] / (mean_gain_ * static_cast<double>(loaded_.size()));
    }
    of_gain[gainAt(t)] += 1 / mean_gain_;
    add(result_, "readout.taxel_gain[" + std::to_string(t) + "]", "", gains[t], fit_.halfWidthOf(of_gain), "", "");
  }
  const auto num_alive = static_cast<std::size_t>(std::count_if(model_.gain.begin(), model_.gain.end(), [](double g) { return g > 0; }));
  if (num_alive > loaded_.size()) {
    result_.remarks.push_back(std::to_string(num_alive - loaded_.size()) +
                              " taxels never carried a load that shows: their gain is not told, it stays 1");
  }
}

void Findings::tellPlaces() {
  for (std::size_t g = 0; g < model_.stamps.size(); ++g) {
    const std::string& name = model_.stamps[g].measurement->name;
    const auto tell = [&](const char* key, const char* unit, std::size_t parameter) {
      add(result_, name + key, unit, fit_.own[g][parameter], fit_.ownHalfWidth(g, parameter), "", "");
    };
    tell(".x", "m", kX);
    tell(".y", "m", kY);
    if (model_.stamps[g].data->indenter.shape == Indenter::Shape::kStamp) tell(".yaw", "rad", kYaw);
    if (model_.with_tilt) tell(".slope_x", "", kSlopeX), tell(".slope_y", "", kSlopeY);
  }
}

}  // namespace

void fitStampImages(Measured measurements, Characterization& result) {
  const Sensor sensor = result.sensor;
  StampModel model(sensor);
  for (const int dead : result.dead_taxels) model.gain[static_cast<std::size_t>(dead)] = 0;
  for (const Measurement* measurement : measurements) model.stamps.push_back(stampOf(*measurement));
  const StampFit found = Choice(model).choose(result.remarks);
  Findings findings(model, found, result);
  findings.tellCreep();
  findings.tellSpread();
  findings.tellCurve();
  findings.tellPresses();
  findings.tellStiffness();
  findings.tellGains();
  findings.tellPlaces();
  result.fits.push_back({.measurement = measurements.front()->name,
                         .unit = "counts",
                         .rms = found.fit.residual_sd,
                         .num_rows = found.fit.num_rows,
                         .num_outliers = found.fit.num_outliers});
  result.figures.push_back(figureOf(model, found));
}

}  // namespace taxelsim
