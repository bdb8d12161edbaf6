// Fits a sensor to images over time under a flat stamp with a dead weight (stamp_model.h). The pose of each stamp is unknown and is fitted
// together with the parameters that all measurements share: point spread, readout curve, trigger and gains, and on curved skins the
// stiffness.
//
// The image of a measurement is the median of each taxel over the frames from 4.5 to 5.5 s after contact.
#include <algorithm>
#include <utility>

#include "base/text.h"
#include "characterize/creep.h"
#include "characterize/fits.h"
#include "characterize/stamp_model.h"
#include "characterize/stamp_report.h"
#include "characterize/stamp_selection.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

constexpr double kWindowBegin = 4.5, kWindowEnd = 5.5;  // s after contact
constexpr double kStill = 2;                            // counts

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
    throw Error(ErrorKind::kInput, stamp.sum.file + ": no contact: the sum of all counts never exceeds 2");
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
                                         numberText(kWindowEnd) + " s after contact");
    }
    stamp.image.push_back(medianOf(std::move(counts)));
  }
  return stamp;
}

FitFigure figureOf(const StampModel& model, const StampFit& found) {
  FitFigure figure{.title = "Readings under stamps", .x_label = "fitted, counts", .y_label = "measured, counts", .curves = {}};
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
  figure.curves.push_back({.name = "fitted = measured", .x = {0, most}, .y = {0, most}});
  return figure;
}

}  // namespace

void fitStampImages(Measured measurements, Characterization& result) {
  const Sensor sensor = result.sensor;
  StampModel model(sensor);
  for (const int dead : result.dead_taxels) model.gain[static_cast<std::size_t>(dead)] = 0;
  for (const Measurement* measurement : measurements) model.stamps.push_back(stampOf(*measurement));
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
