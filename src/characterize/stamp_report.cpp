#include "characterize/stamp_report.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/text.h"
#include "characterize/creep.h"
#include "characterize/fits.h"
#include "characterize/frame_noise.h"
#include "characterize/limits.h"
#include "characterize/stamp_selection.h"
#include "characterize/temperature.h"

namespace taxelsim {
namespace {

using namespace stamp_own;
using namespace stamp_shared;

// A reading clear of the trigger at 5 s is above kClearOfTrigger x trigger + kClearCounts, so that the taxel responded from the onset.
constexpr double kClearOfTrigger = 0.5, kClearCounts = 20;

void add(Characterization& result, std::string parameter, std::string unit, double value, double half, std::string remark,
         std::string doubt) {
  const bool determined = std::isfinite(half) && doubt.empty();
  if (doubt.empty() && !determined) doubt = "not identifiable from the images";
  result.estimates.push_back({.parameter = std::move(parameter),
                              .unit = std::move(unit),
                              .determined = determined,
                              .value = value,
                              .low = value - half,
                              .high = value + half,
                              .remark = determined ? std::move(remark) : std::move(doubt)});
}

class StampReport {
 public:
  StampReport(const StampModel& model, const StampFit& found, Characterization& result)
      : model_(model),
        found_(found),
        fit_(found.fit),
        result_(result),
        over_(std::to_string(model.stamps.size()) + (model.stamps.size() == 1 ? " image" : " images")) {
    chooseGains();
  }

  void reportSpread();
  void reportCreepOfStamps();  // before reportCurve(), which needs the growth by creep
  void reportCurve();
  // `of_slope`: gradient of the relative slope; `by_creep`: its relative half width by the creep.
  void reportTriggers(double slope, const Eigen::VectorXd& of_slope, double by_creep);
  void reportPressGains();
  void reportDeviation(std::string parameter, double value, std::size_t freedom, std::string remark);
  void reportStiffness();
  void reportTemperature();
  void reportGains();
  void reportNoise();
  void reportPoses();

 private:
  template <typename HalfWidth>
  void reportPose(const std::string& name, const double* pose, const HalfWidth& half_width);
  void chooseGains();
  double gain(std::size_t taxel) const { return gainOf(model_, found_, taxel); }
  Eigen::VectorXd gradient() const { return Eigen::VectorXd::Zero(static_cast<Eigen::Index>(fit_.shared.size())); }
  Eigen::Index gainAt(std::size_t taxel) const { return static_cast<Eigen::Index>(model_.gainsAt() + taxel); }
  // Readout 5 s after contact, with creep included in its curve.
  Readout steadyReadout() const;

  const StampModel& model_;
  const StampFit& found_;
  const GroupedFit& fit_;
  Characterization& result_;
  std::string over_;
  std::vector<std::size_t> loaded_;
  double mean_gain_ = 1;               // of the loaded taxels; multiplies the slope of the curve
  double grown_ = 1, grown_half_ = 0;  // growth by creep 5 s after contact, and half width of its interval
};

void StampReport::chooseGains() {
  if (!model_.with_gains) return;
  double sum = 0;
  for (std::size_t t = 0; t < model_.gain.size(); ++t) {
    if (!model_.isLoaded(t)) continue;
    loaded_.push_back(t);
    sum += gain(t);
  }
  if (!loaded_.empty()) mean_gain_ = sum / static_cast<double>(loaded_.size());
}

void StampReport::reportSpread() {
  const double sigma = fit_.shared[kSigma], unit = model_.sigmaUnit();
  const bool list = model_.isListOfTaxels();
  add(result_, list ? "psf.skin_gaussian.sigma" : "psf.gaussian.sigma", list ? "m" : "taxels", sigma, fit_.halfWidth(kSigma), over_,
      sigma > 0.2 * unit && sigma < 3.9 * unit ? "" : "not identifiable from the images");
  if (!result_.estimates.back().determined) return;
  if (list) {
    result_.sensor.psf = Psf{.size = 1, .kernel = {1}, .sigma = sigma};
  } else {
    result_.sensor.psf = gaussianPsf(sigma, gaussianKernelSize(sigma, std::max(3, result_.sensor.psf.size)));
  }
}

Readout StampReport::steadyReadout() const {
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

void StampReport::reportCreepOfStamps() {
  const Readout steady = steadyReadout();
  std::vector<CreepSeries> series;
  for (std::size_t g = 0; g < model_.stamps.size(); ++g) {
    const Stamp& stamp = model_.stamps[g];
    // Leaves out taxels near the trigger: they respond late.
    std::vector<std::size_t> clear;
    for (std::size_t k = 0; k < stamp.taxels.size(); ++k) {
      const double reading = stamp.image[stamp.taxels[k]];
      const bool is_clear = reading > kClearOfTrigger * fit_.shared[kTrigger] + kClearCounts && reading < model_.curve.top;
      if (is_clear && !fit_.outlier[g][k]) clear.push_back(stamp.taxels[k]);
    }
    if (clear.empty()) {
      result_.remarks.push_back(stamp.measurement->name + ": no taxel reads well above the trigger, creep is not fitted");
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
  std::vector<const Measurement*> measurements;
  for (const Stamp& stamp : model_.stamps) measurements.push_back(stamp.measurement);
  const CreepFit creep = fitCreepTerms(series);
  reportCreep(creep, series, namesOf(measurements), "from the sum of forces of taxels well above the trigger", result_);
  if (!creep.onsets.empty()) grown_ = 0;
  for (const Onset& onset : creep.onsets) {
    grown_ += creepFactor(creep.terms, kSteady - (onset.time - onset.start)) / static_cast<double>(creep.onsets.size());
  }
  for (std::size_t i = 0; i < creep.terms.size(); ++i) grown_half_ += creep.fraction_half[i] * -std::expm1(-kSteady / creep.terms[i].time);
}

void StampReport::reportCurve() {
  Readout& readout = result_.sensor.readout;
  const double slope = fit_.shared[kScale] * mean_gain_ / grown_;
  // Gradient of the relative slope.
  Eigen::VectorXd of_slope = gradient();
  of_slope[kScale] = 1 / fit_.shared[kScale];
  for (const std::size_t t : loaded_) of_slope[gainAt(t)] = 1 / (mean_gain_ * static_cast<double>(loaded_.size()));
  const double by_creep = grown_half_ / grown_;
  const std::string before_creep = "before creep, which adds " + numberText(std::round((grown_ - 1) * 1e4) / 100) + " % by 5 s";
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
        part > half ? "" : "no saturation above the noise");
  }
  const double trigger = fit_.shared[kTrigger] / slope;
  Eigen::VectorXd of_trigger = -trigger * of_slope;
  of_trigger[kTrigger] += 1 / slope;
  const double half = std::hypot(fit_.halfWidthOf(of_trigger), trigger * by_creep);
  add(result_, "readout.trigger", "N", trigger, half, over_, trigger > half ? "" : "its interval includes 0");
  if (result_.estimates.back().determined) {
    readout.trigger = trigger;
    readout.taxel_trigger.clear();
  }
  if (model_.with_offsets) reportTriggers(slope, of_slope, by_creep);
}

// A trigger below 0 is not in the readout's range: such taxels get 0.
void StampReport::reportTriggers(double slope, const Eigen::VectorXd& of_slope, double by_creep) {
  std::vector<double>& triggers = result_.sensor.readout.taxel_trigger;
  triggers.assign(model_.gain.size(), std::max(0.0, fit_.shared[kTrigger] / slope));
  for (const std::size_t t : loaded_) {
    const std::size_t at = model_.offsetsAt() + t;
    const double trigger = (fit_.shared[kTrigger] + fit_.shared[at]) / slope;
    Eigen::VectorXd of_trigger = -trigger * of_slope;
    of_trigger[kTrigger] += 1 / slope;
    of_trigger[static_cast<Eigen::Index>(at)] += 1 / slope;
    triggers[t] = std::max(0.0, trigger);
    add(result_, "readout.taxel_trigger[" + std::to_string(t) + "]", "N", triggers[t],
        std::hypot(fit_.halfWidthOf(of_trigger), trigger * by_creep), "", "");
  }
}

// A standard deviation of `freedom` values. Its logarithm is closer to Gaussian than itself.
void StampReport::reportDeviation(std::string parameter, double value, std::size_t freedom, std::string remark) {
  const double factor = std::exp(studentFactor(freedom) / std::sqrt(2.0 * static_cast<double>(freedom)));
  result_.estimates.push_back({.parameter = std::move(parameter),
                               .unit = "",
                               .determined = true,
                               .value = value,
                               .low = value / factor,
                               .high = value * factor,
                               .remark = std::move(remark)});
}

void StampReport::reportPressGains() {
  if (!(model_.press_spread > 0)) return;
  const std::size_t num_stamps = model_.stamps.size();
  if (model_.press_prior) {
    std::vector<double> loads = model_.loads();
    std::sort(loads.begin(), loads.end());
    const auto num_loads = static_cast<std::size_t>(std::unique(loads.begin(), loads.end()) - loads.begin());
    reportDeviation("bench.load_gain_spread", model_.press_prior->load_spread, num_loads - 1,
                    "of this bench: the gain depends on the load, over a factor of " +
                        numberText(std::round(100 * std::exp(model_.press_prior->length)) / 100) + " in the load");
    if (num_stamps > num_loads)
      reportDeviation("readout.press_gain_spread", model_.press_spread, num_stamps - num_loads, "between presses of one load");
  } else {
    reportDeviation("readout.press_gain_spread", model_.press_spread, num_stamps - 1, "between the " + over_);
  }
  if (model_.press_prior) {
    const auto first = fit_.shared.begin() + static_cast<std::ptrdiff_t>(model_.pressesAt());
    result_.bench_gains = BenchGains{.loads = model_.loads(),
                                     .log_gains = {first, first + static_cast<std::ptrdiff_t>(num_stamps)},
                                     .load_spread = model_.press_prior->load_spread,
                                     .length = model_.press_prior->length,
                                     .press_spread = model_.press_prior->press_spread};
  }
  result_.sensor.readout.press_gain_spread = std::min(model_.press_spread, kMaxGainSpread);
  for (std::size_t g = 0; g < num_stamps; ++g) {
    const double log_gain = model_.press_prior ? fit_.shared[model_.pressesAt() + g] : std::log(fit_.own[g][kPress]);
    const double half = model_.press_prior ? std::exp(log_gain) * fit_.halfWidth(model_.pressesAt() + g) : fit_.ownHalfWidth(g, kPress);
    add(result_, model_.stamps[g].measurement->name + ".press_gain", "", std::exp(log_gain), half, "", "");
  }
}

void StampReport::reportStiffness() {
  if (model_.is_plane) return;
  const double stiffness = std::exp(fit_.shared[kStiffness]), half = stiffness * fit_.halfWidth(kStiffness);
  add(result_, "skin.normal_contact_stiffness", model_.foundation.normal_exponent == 1 ? "N/m^3" : "Pa/m^n", stiffness, half,
      "from the contact area on the curved skin", half < stiffness ? "" : "not identifiable from the images");
  if (auto* const law = std::get_if<Winkler>(&result_.sensor.skin.law); law != nullptr && result_.estimates.back().determined) {
    law->normal_contact_stiffness = stiffness;
  }
}

void StampReport::reportTemperature() {
  if (!model_.with_temperature) return;
  const double slope = fit_.shared[kScale] * mean_gain_ / grown_;
  addTemperature(result_, {fit_.shared[kWarmGain], fit_.halfWidth(kWarmGain)},
                 {fit_.shared[kWarmTrigger] / slope, fit_.halfWidth(kWarmTrigger) / slope});
}

void StampReport::reportGains() {
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
    result_.remarks.push_back(std::to_string(num_alive - loaded_.size()) + " taxels were never loaded: their gain stays 1");
  }
}

template <typename HalfWidth>
void StampReport::reportPose(const std::string& name, const double* pose, const HalfWidth& half_width) {
  const auto report = [&](const char* key, const char* unit, std::size_t parameter) {
    if (half_width(parameter) > 0) add(result_, name + key, unit, pose[parameter], half_width(parameter), "", "");
  };
  report(".x", "m", kX);
  report(".y", "m", kY);
  report(".yaw", "rad", kYaw);
  if (model_.with_tilt) report(".slope_x", "", kSlopeX), report(".slope_y", "", kSlopeY);
}

void StampReport::reportNoise() {
  const FrameNoise noise = frameNoiseOf(model_.stamps, model_.curve.top);
  if (noise.num_series == 0) return;
  const auto report = [&](const char* parameter, const char* unit, double square, double half, double& setting) {
    const bool is_known = std::ranges::any_of(
        result_.estimates, [&](const Estimate& estimate) { return estimate.determined && estimate.parameter == parameter; });
    if (is_known) return;
    const double value = std::sqrt(std::max(0.0, square));
    add(result_, parameter, unit, value, half / (2 * value), std::to_string(noise.num_series) + " taxels of " + over_,
        square > half ? "" : "not above the rounding to counts, or too few frames");
    if (result_.estimates.back().determined) setting = value;
  };
  report("readout.noise", "counts", noise.variance, noise.variance_half, result_.sensor.readout.noise);
  report("readout.random_walk", "counts/sqrt(s)", noise.walk, noise.walk_half, result_.sensor.readout.random_walk);
}

void StampReport::reportPoses() {
  for (std::size_t f = 0; f < model_.fixtures.size(); ++f) {
    const std::size_t at = model_.fixturesAt() + kPoseSize * f;
    reportPose(model_.fixtures[f], &fit_.shared[at], [&](std::size_t p) { return fit_.halfWidth(at + p); });
  }
  for (std::size_t g = 0; g < model_.stamps.size(); ++g) {
    if (model_.stamps[g].fixture) continue;
    reportPose(model_.stamps[g].measurement->name, fit_.own[g].data(), [&](std::size_t p) { return fit_.ownHalfWidth(g, p); });
  }
}

}  // namespace

void reportStamps(const StampModel& model, const StampFit& found, Characterization& result) {
  StampReport report(model, found, result);
  report.reportCreepOfStamps();
  report.reportSpread();
  report.reportCurve();
  report.reportPressGains();
  report.reportStiffness();
  report.reportTemperature();
  report.reportGains();
  report.reportNoise();
  report.reportPoses();
}

}  // namespace taxelsim
