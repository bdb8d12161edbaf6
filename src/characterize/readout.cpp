// Fits the readout to force curves: selects informative rows, fits a model, simplifies it until it is valid, and reports it.
#include <algorithm>
#include <optional>
#include <utility>

#include "characterize/fits.h"
#include "characterize/pressed_taxels.h"
#include "characterize/readout_report.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

// The curve that the measurement files request.
struct RequestedCurve {
  bool divider = false;
  std::size_t num_bends = 0;
  std::size_t num_pieces = 0;  // 0: a polynomial
};

RequestedCurve requestedCurve(Measured force_curves) {
  RequestedCurve requested;
  for (const Measurement* measurement : force_curves) {
    const auto& curve = std::get<ForceCurve>(measurement->data);
    requested.divider = requested.divider || curve.divider;
    requested.num_bends = std::max(requested.num_bends, static_cast<std::size_t>(curve.curve_degree - 1));
    requested.num_pieces = std::max(requested.num_pieces, static_cast<std::size_t>(std::max(curve.curve_segments, 0)));
    if (requested.num_pieces > 0 && (requested.divider || requested.num_bends > 0)) {
      throw Error(ErrorKind::kInput, measurement->file.generic_string() +
                                         ": curve_segments and curve_degree or divider are given for one sensor: only one is allowed");
    }
  }
  return requested;
}

// Fits the model with hysteresis and drift. Lowers the degree of a polynomial until the curve rises over all measured forces.
void fitRising(const std::vector<FitResult>& lines, ReadoutFit& found, std::vector<std::string>& remarks) {
  const auto isRising = [&] { return found.model.num_bends == 0 || rises(found.model, found.fit, found.taxels); };
  for (ReadoutModel plain = found.model;; --plain.num_bends) {
    found.model = plain;
    found.fit = fitReadoutModel(found.taxels, lines, found.model, 0);
    if (isRising()) {
      found.fit = withHysteresisAndDrift(found.taxels, lines, found.model, std::move(found.fit));
      if (isRising()) return;
    }
    remarks.push_back("a curve of degree " + std::to_string(plain.num_bends + 1) + " falls within the range: degree reduced by one");
  }
}

// By error propagation through gain = a / (w S) and trigger = a f / S.
ReadoutCovariance covarianceOf(const ReadoutFit& found, const Sensor& sensor, double slope) {
  ReadoutCovariance covariance(static_cast<std::size_t>(numTaxels(sensor)), {0, 0, 0, 0});
  for (std::size_t t = 0; t < found.taxels.size(); ++t) {
    Eigen::Matrix2d of_own{{1 / found.taxels[t].share, 0}, {found.fit.own[t][1], found.fit.own[t][0]}};
    of_own /= slope;
    Eigen::Matrix3d all = found.fit.own_covariance[t];
    if (!found.fit.shared.empty()) all += found.fit.own_by_shared[t] * found.fit.covariance * found.fit.own_by_shared[t].transpose();
    const Eigen::Matrix2d own = all.topLeftCorner<2, 2>();
    if (!own.allFinite()) continue;
    Eigen::Matrix2d::Map(covariance[static_cast<std::size_t>(found.taxels[t].taxel)].data()) = of_own * own * of_own.transpose();
  }
  return covariance;
}

}  // namespace

ReadoutCovariance fitReadout(Measured force_curves, const std::optional<PsfRange>& psf_range, Characterization& result) {
  const RequestedCurve requested = requestedCurve(force_curves);
  PressedTaxels pressed = pressedTaxels(force_curves, result.sensor, psf_range, result.temperature ? result.temperature->reference : 0);
  result.dead_taxels.insert(result.dead_taxels.end(), pressed.dead.begin(), pressed.dead.end());
  for (const int taxel : pressed.too_few_rows) {
    result.remarks.push_back("taxel " + std::to_string(taxel) + ": left out, fewer than " + std::to_string(kLeastReadings) +
                             " rows between trigger and saturation");
  }
  ReadoutFit found{.taxels = std::move(pressed.taxels),
                   .plateau = pressed.plateau,
                   .model = {.num_bends = requested.num_bends,
                             .divider = requested.divider,
                             .warms = result.temperature.has_value(),
                             .top = pressed.top,
                             .noise = pressed.noise},
                   .pieces = {},
                   .fit = {}};
  if (requested.num_pieces > 0) {
    found.pieces = fitPieces(found.taxels, requested.num_pieces, pressed.lines, found.model);
    found.fit = withHysteresisAndDrift(found.taxels, pressed.lines, found.model, std::move(found.pieces.fit));
  } else {
    fitRising(pressed.lines, found, result.remarks);
  }

  reportReadout(found, result);
  std::size_t num_rows = 0;
  for (const PressedTaxel& taxel : found.taxels) num_rows += taxel.rows.size();
  result.fits.push_back({.measurement = namesOf(force_curves),
                         .unit = "counts",
                         .rms = found.fit.residual_sd,
                         .num_rows = num_rows,
                         .num_outliers = found.fit.num_outliers + found.pieces.num_gross});
  return covarianceOf(found, result.sensor, meanSlope(found));
}

}  // namespace taxelsim
