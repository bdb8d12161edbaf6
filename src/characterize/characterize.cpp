#include "taxelsim/characterize.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <string_view>
#include <utility>

#include "characterize/fits.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

constexpr int kMaxRounds = 10;
constexpr double kSettled = 1e-4;  // of a force: a tenth of what good measurements tell of a share

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

// Largest difference between two kernels' shares.
double differenceOf(const Psf& a, const Psf& b) {
  if (a.size != b.size) return 1;
  const double sum_a = std::accumulate(a.kernel.begin(), a.kernel.end(), 0.0),
               sum_b = std::accumulate(b.kernel.begin(), b.kernel.end(), 0.0);
  double largest = 0;
  for (std::size_t k = 0; k < a.kernel.size(); ++k) largest = std::max(largest, std::abs(a.kernel[k] / sum_a - b.kernel[k] / sum_b));
  return largest;
}

// Of a Gaussian; of a free kernel nothing is said.
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
      throw Error(ErrorKind::kInput, measurement.file.generic_string() + ": another sensor than that of " +
                                         measurements.front().file.generic_string() + ": all measurements must name the same one");
    }
    if (std::holds_alternative<ImageSequence>(measurement.data)) {
      throw Error(ErrorKind::kInput, measurement.file.generic_string() +
                                         ": images of nothing known cannot be fitted: give what touches (point_images, stamp_images)");
    }
  }
}

bool isTold(const Characterization& result, std::string_view block) {
  return std::any_of(result.estimates.begin(), result.estimates.end(),
                     [&](const Estimate& estimate) { return estimate.determined && estimate.parameter.starts_with(block); });
}

// What was measured by itself stays; what the stamps say of it is a remark.
void fitStampsBeside(Measured stamps, Characterization& result) {
  Characterization with = result;
  fitStampImages(stamps, with);
  std::vector<Estimate> added(with.estimates.begin() + static_cast<std::ptrdiff_t>(result.estimates.size()), with.estimates.end());
  with.estimates.resize(result.estimates.size());
  const Readout& before = result.sensor.readout;
  Readout& after = with.sensor.readout;
  std::vector<std::string_view> told;
  if (isTold(result, "psf.")) {
    told.push_back("psf.");
    with.sensor.psf = result.sensor.psf;
  }
  if (isTold(result, "readout.curve.")) {
    told.insert(told.end(), {"readout.curve.", "readout.trigger", "readout.taxel_gain"});
    after.curve = before.curve;
    after.curve_points = before.curve_points;
    after.output_scale = before.output_scale;
    after.trigger = before.trigger;
    after.taxel_trigger = before.taxel_trigger;
    after.taxel_gain = before.taxel_gain;
  }
  if (isTold(result, "readout.creep")) {
    told.push_back("readout.creep");
    after.creep = before.creep;
  }
  if (isTold(result, "skin.normal_contact_stiffness")) {
    told.push_back("skin.normal_contact_stiffness");
    with.sensor.skin.law = result.sensor.skin.law;
  }
  for (Estimate& estimate : added) {
    const bool is_told =
        std::any_of(told.begin(), told.end(), [&](std::string_view block) { return estimate.parameter.starts_with(block); });
    if (!is_told) {
      with.estimates.push_back(std::move(estimate));
    } else if (estimate.determined) {
      std::array<char, 120> interval{};
      std::snprintf(interval.data(), interval.size(), "%.4g (%.4g to %.4g)", estimate.value, estimate.low, estimate.high);
      with.remarks.push_back("by the stamps " + estimate.parameter + " is " + interval.data() + ": not taken, it was measured by itself");
    }
  }
  result = std::move(with);
}

}  // namespace

Characterization characterize(std::span<const Measurement> measurements) {
  if (measurements.empty()) throw Error(ErrorKind::kInput, "no measurement to fit to");
  checkSameSensor(measurements);
  Characterization result;
  result.sensor = measurements.front().sensor;
  const std::vector<const Measurement*> curves = ofKind<ForceCurve>(measurements);
  std::optional<PsfRange> psf_range;
  // The point spread function is seen through the readout, and of a force on one taxel it leaves a share to others: in turn, until neither
  // moves the other.
  const std::vector<const Measurement*> points = ofKind<PointImages>(measurements);
  for (int round = 0; round < kMaxRounds && !points.empty(); ++round) {
    Characterization draft = result;
    ReadoutDoubt doubt;
    if (!curves.empty()) doubt = fitReadout(curves, {}, draft);
    fitPointSpread(points, doubt, draft);
    const bool settled = differenceOf(std::exchange(result.sensor.psf, draft.sensor.psf), draft.sensor.psf) < kSettled;
    psf_range = rangeOf(draft);
    if (settled || curves.empty()) break;
  }
  ReadoutDoubt doubt;
  if (!curves.empty()) doubt = fitReadout(curves, psf_range, result);
  if (!points.empty()) fitPointSpread(points, doubt, result);
  fitKind<ForceDepth>(measurements, result, fitStiffness);
  fitKind<StepResponse>(measurements, result, fitCreep);
  if (const std::vector<const Measurement*> stamps = ofKind<StampImages>(measurements); !stamps.empty()) fitStampsBeside(stamps, result);
  checkSensor(result.sensor);
  return result;
}

}  // namespace taxelsim
