#include "taxelsim/characterize.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <string_view>
#include <utility>

#include "characterize/fits.h"
#include "characterize/temperature.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

constexpr int kMaxRounds = 10;
constexpr double kConvergedShare = 1e-4;  // change of a share of force; good measurements have an error of 1e-3

template <typename Data>
std::vector<const Measurement*> ofKind(std::span<const Measurement> measurements) {
  std::vector<const Measurement*> result;
  for (const Measurement& measurement : measurements) {
    if (std::holds_alternative<Data>(measurement.data)) result.push_back(&measurement);
  }
  return result;
}

template <typename Data>
void fitKind(std::span<const Measurement> measurements, Characterization& result, void (*fit)(Measured, Characterization&)) {
  const std::vector<const Measurement*> chosen = ofKind<Data>(measurements);
  if (!chosen.empty()) fit(chosen, result);
}

// Largest difference between the normalised weights of two kernels; 1 if their sizes differ.
double differenceOf(const Psf& a, const Psf& b) {
  if (a.size != b.size) return 1;
  const double sum_a = std::accumulate(a.kernel.begin(), a.kernel.end(), 0.0),
               sum_b = std::accumulate(b.kernel.begin(), b.kernel.end(), 0.0);
  double largest = 0;
  for (std::size_t k = 0; k < a.kernel.size(); ++k) largest = std::max(largest, std::abs(a.kernel[k] / sum_a - b.kernel[k] / sum_b));
  return largest;
}

// For a Gaussian only; a free kernel has no range.
std::optional<PsfRange> rangeOf(const Characterization& result) {
  for (const Estimate& estimate : result.estimates) {
    if (estimate.parameter != "psf.gaussian.sigma" || !estimate.determined || !(estimate.low > 0)) continue;
    const Psf& psf = result.sensor.psf;
    return PsfRange{gaussianPsf(estimate.low, psf.size, psf.normalization), gaussianPsf(estimate.high, psf.size, psf.normalization)};
  }
  return {};
}

void checkSameSensor(std::span<const Measurement> measurements) {
  for (const Measurement& measurement : measurements) {
    if (measurement.resolved_sensor != measurements.front().resolved_sensor) {
      throw Error(ErrorKind::kInput, measurement.file.generic_string() + ": names another sensor than " +
                                         measurements.front().file.generic_string() + ": all measurements must name the same one");
    }
    if (std::holds_alternative<ImageSequence>(measurement.data)) {
      throw Error(ErrorKind::kInput,
                  measurement.file.generic_string() +
                      ": kind images cannot be fitted, because the indenter is unknown: use point_images or stamp_images");
    }
  }
}

bool isDetermined(const Characterization& result, std::string_view block) {
  return std::any_of(result.estimates.begin(), result.estimates.end(),
                     [&](const Estimate& estimate) { return estimate.determined && estimate.parameter.starts_with(block); });
}

// Parameters that another measurement has determined are kept; what the stamps give for them becomes a remark.
void fitStamps(Measured stamps, Characterization& result) {
  Characterization fitted = result;
  fitStampImages(stamps, fitted);
  std::vector<Estimate> added(fitted.estimates.begin() + static_cast<std::ptrdiff_t>(result.estimates.size()), fitted.estimates.end());
  fitted.estimates.resize(result.estimates.size());
  const Readout& before = result.sensor.readout;
  Readout& after = fitted.sensor.readout;
  std::vector<std::string_view> kept;
  if (isDetermined(result, "psf.")) {
    kept.push_back("psf.");
    fitted.sensor.psf = result.sensor.psf;
  }
  if (isDetermined(result, "readout.curve.")) {
    kept.insert(kept.end(), {"readout.curve.", "readout.trigger", "readout.taxel_gain"});
    after.curve = before.curve;
    after.curve_points = before.curve_points;
    after.output_scale = before.output_scale;
    after.trigger = before.trigger;
    after.taxel_trigger = before.taxel_trigger;
    after.taxel_gain = before.taxel_gain;
  }
  if (isDetermined(result, "readout.taxel_gain") && !isDetermined(result, "readout.curve.")) {
    kept.emplace_back("readout.taxel_gain");
    after.taxel_gain = before.taxel_gain;
  }
  if (isDetermined(result, "temperature.")) {
    kept.emplace_back("temperature.");
    fitted.temperature = result.temperature;
  }
  if (isDetermined(result, "readout.creep")) {
    kept.push_back("readout.creep");
    after.creep = before.creep;
  }
  if (isDetermined(result, "skin.normal_contact_stiffness")) {
    kept.push_back("skin.normal_contact_stiffness");
    fitted.sensor.skin.law = result.sensor.skin.law;
  }
  for (Estimate& estimate : added) {
    const bool is_kept =
        std::any_of(kept.begin(), kept.end(), [&](std::string_view block) { return estimate.parameter.starts_with(block); });
    if (!is_kept) {
      fitted.estimates.push_back(std::move(estimate));
    } else if (estimate.determined) {
      std::array<char, 120> interval{};
      std::snprintf(interval.data(), interval.size(), "%.4g (%.4g to %.4g)", estimate.value, estimate.low, estimate.high);
      fitted.remarks.push_back("the stamps give " + estimate.parameter + " " + interval.data() +
                               ": not used, another measurement determines it");
    }
  }
  result = std::move(fitted);
}

}  // namespace

std::string namesOf(Measured measurements) {
  std::string names = measurements.front()->name;
  if (measurements.size() > 1) names += (measurements.size() == 2 ? " and " : ", ") + measurements[1]->name;
  if (measurements.size() > 2) names += " and " + std::to_string(measurements.size() - 2) + " more";
  return names;
}

Characterization characterize(std::span<const Measurement> measurements) {
  if (measurements.empty()) throw Error(ErrorKind::kInput, "no measurements");
  checkSameSensor(measurements);
  Characterization result;
  result.sensor = measurements.front().sensor;
  result.temperature = temperatureTermOf(measurements);
  const std::vector<const Measurement*> curves = ofKind<ForceCurve>(measurements);
  std::optional<PsfRange> psf_range, found_range;
  const std::vector<const Measurement*> presses = ofKind<UniformPress>(measurements);
  if (!curves.empty() && !presses.empty()) {
    result.remarks.push_back("uniform presses are not used: the force curves determine the gains");
  }
  const auto fitGains = [&](Characterization& to) -> ReadoutCovariance {
    if (!curves.empty()) return fitReadout(curves, psf_range, to);
    return presses.empty() ? ReadoutCovariance{} : fitUniformPress(presses, to);
  };
  // Readout and point spread function depend on each other: images are read through the readout, and the point spread function moves a
  // share of the force on a taxel to others. Alternates until the point spread function converges.
  const std::vector<const Measurement*> points = ofKind<PointImages>(measurements);
  for (int round = 0; round < kMaxRounds && !points.empty(); ++round) {
    Characterization draft = result;
    fitPointSpread(points, fitGains(draft), draft);
    const bool converged = differenceOf(std::exchange(result.sensor.psf, draft.sensor.psf), draft.sensor.psf) < kConvergedShare;
    found_range = rangeOf(draft);
    if (converged || (curves.empty() && presses.empty())) break;
  }
  psf_range = found_range;
  const ReadoutCovariance covariance = fitGains(result);
  if (!points.empty()) fitPointSpread(points, covariance, result);
  fitKind<ForceDepth>(measurements, result, fitStiffness);
  fitKind<StepResponse>(measurements, result, fitCreep);
  if (const std::vector<const Measurement*> stamps = ofKind<StampImages>(measurements); !stamps.empty()) fitStamps(stamps, result);
  checkSensor(result.sensor);
  return result;
}

}  // namespace taxelsim
