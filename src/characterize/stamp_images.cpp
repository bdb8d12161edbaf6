// Fits a sensor to images over time under a flat stamp with a dead weight (stamp_model.h). The pose of each stamp is unknown and is fitted
// together with the parameters that all measurements share: point spread, readout curve, trigger and gains, and on curved skins the
// stiffness.
//
// The image of a measurement is the median of each taxel over the frames from 4.5 to 5.5 s after contact.
#include <algorithm>
#include <utility>

#include "characterize/fits.h"
#include "characterize/stamp_recording.h"
#include "characterize/stamp_report.h"
#include "characterize/stamp_selection.h"

namespace taxelsim {
namespace {

FitFigure figureOf(const StampModel& model, const StampFit& found) {
  FitFigure figure{.title = "Readings under stamps", .x_label = "fitted, counts", .y_label = "measured, counts", .curves = {}};
  double most = 0;
  for (std::size_t g = 0; g < model.stamps.size(); ++g) {
    FitFigure::Curve dots{.name = model.stamps[g].measurement->name, .measured = true, .x = {}, .y = {}};
    for (std::size_t k = 0; k < model.stamps[g].taxels.size(); ++k) {
      const double counts = model.stamps[g].image[model.stamps[g].taxels[k]];
      dots.x.push_back(counts + found.fit.residual[g][k] / model.stamps[g].weightOf(model.stamps[g].taxels[k]));
      dots.y.push_back(counts);
      most = std::max(most, counts);
    }
    figure.curves.push_back(std::move(dots));
  }
  figure.curves.push_back({.name = "fitted = measured", .x = {0, most}, .y = {0, most}});
  return figure;
}

}  // namespace

void fitStampImages(Measured measurements, Characterization& result) {
  const Sensor sensor = result.sensor;
  StampModel model(sensor);
  model.with_temperature = result.temperature.has_value();
  model.knows_gains = std::any_of(result.estimates.begin(), result.estimates.end(), [](const Estimate& estimate) {
    return estimate.determined && estimate.parameter.starts_with("readout.taxel_gain");
  });
  for (const int dead : result.dead_taxels) model.gain[static_cast<std::size_t>(dead)] = 0;
  for (const Measurement* measurement : measurements) {
    Stamp& stamp = model.stamps.emplace_back(stampOf(*measurement));
    if (result.temperature) stamp.warmth = *measurement->temperature - result.temperature->reference;
    if (stamp.data->fixture.empty()) continue;
    const auto known = std::find(model.fixtures.begin(), model.fixtures.end(), stamp.data->fixture);
    stamp.fixture = static_cast<std::size_t>(known - model.fixtures.begin());
    if (known == model.fixtures.end()) model.fixtures.push_back(stamp.data->fixture);
  }
  const StampFit found = selectStampModel(model, result.remarks);
  reportStamps(model, found, result);
  result.fits.push_back({.measurement = namesOf(measurements),
                         .unit = "counts",
                         .rms = found.fit.residual_sd,
                         .num_rows = found.fit.num_rows,
                         .num_outliers = found.fit.num_outliers});
  result.figures.push_back(figureOf(model, found));
}

}  // namespace taxelsim
