#include "characterize/creep.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "base/text.h"
#include "characterize/fits.h"
#include "characterize/limits.h"
#include "sensor/curve.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

constexpr std::size_t kMaxCreepDots = 2000;

FitFigure figureOf(const CreepFit& fit, const std::vector<CreepSeries>& series) {
  FitFigure figure{.title = "Output over time under a constant load",
                   .x_label = "time after contact, s",
                   .y_label = "output, relative to the initial output",
                   .curves = {}};
  double longest = 0;
  const std::size_t every = fit.num_rows / kMaxCreepDots + 1;
  for (std::size_t m = 0; m < series.size(); ++m) {
    FitFigure::Curve dots{.name = std::filesystem::path(series[m].file).stem().string(), .measured = true, .x = {}, .y = {}};
    for (std::size_t r = fit.onsets[m].first_row; r < fit.onsets[m].end_row; r += every) {
      dots.x.push_back(series[m].time[r] - fit.onsets[m].time);
      dots.y.push_back(series[m].values[r] / fit.amplitude[m]);
      longest = std::max(longest, dots.x.back());
    }
    figure.curves.push_back(std::move(dots));
  }
  FitFigure::Curve line{.name = "fit", .x = {}, .y = {}};
  for (int k = 0; k <= 100; ++k) {
    line.x.push_back(longest * k / 100);
    line.y.push_back(creepFactor(fit.terms, line.x.back()));
  }
  figure.curves.push_back(std::move(line));
  return figure;
}

// The sum over n active taxels is S (F y - n trigger), whose creep fraction appears as fraction F / (F - n trigger). The trigger of a
// single taxel is added back; for a sum n is unknown, and `remark` says so.
CreepSeries seriesOf(const Measurement& measurement, const Readout& readout, std::string& remark) {
  const auto& step = std::get<StepResponse>(measurement.data);
  CreepSeries one{.file = measurement.file.generic_string(), .time = {}, .values = {}};
  const double most = step.counts.empty() ? 0 : *std::max_element(step.counts.begin(), step.counts.end());
  if (most <= kStill) throw Error(ErrorKind::kInput, one.file + ": no contact: the output never exceeds 2 counts");
  const bool is_sum = most > readout.saturation;
  for (std::size_t r = 0; r < step.time.size(); ++r) {
    if (!is_sum && step.counts[r] >= readout.saturation) continue;
    one.time.push_back(step.time[r]);
    one.values.push_back(is_sum ? step.counts[r] : nominalForce(readout, step.counts[r]));
  }
  if (2 * one.time.size() < step.time.size()) {
    throw Error(ErrorKind::kInput, one.file + ": most rows are saturated, at " + std::to_string(readout.saturation) + " counts");
  }
  if (readout.trigger > 0) {
    const double share = readout.output_scale * slopeAtZero(readout) * readout.trigger / (0.9 * most);
    remark = is_sum ? "a sum over taxels, not corrected for their triggers: each active taxel makes it about " +
                          numberText(std::round(share * 1e4) / 100) + " % too large"
                    : "assumes the output of one taxel; its trigger is added back";
  }
  return one;
}

}  // namespace

void reportCreep(const CreepFit& fit, const std::vector<CreepSeries>& series, const std::string& name, const std::string& remark,
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
                         .unit = "of the initial output",
                         .rms = fit.residual,
                         .num_rows = fit.num_rows,
                         .num_outliers = fit.num_outliers});
  result.figures.push_back(figureOf(fit, series));
}

void fitCreep(Measured step_responses, Characterization& result) {
  const Readout& readout = result.sensor.readout;
  std::vector<CreepSeries> series;
  std::string remark;
  for (const Measurement* measurement : step_responses) series.push_back(seriesOf(*measurement, readout, remark));
  reportCreep(fitCreepTerms(series), series, namesOf(step_responses), remark, result);
}

}  // namespace taxelsim
