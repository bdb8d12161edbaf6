// Fits the point spread function to images under an indenter at known positions (point_spread_model.h).
#include <algorithm>
#include <cmath>
#include <utility>

#include "base/text.h"
#include "characterize/fits.h"
#include "characterize/point_spread_model.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

constexpr double kStartSigma = 0.6;      // taxels
constexpr double kOutsideKernel = 5e-3;  // share of a Gaussian's weight that a kernel may leave out
constexpr int kMaxFreeKernel = 5;        // taxels per side of a kernel without a formula
constexpr std::size_t kLeastInside = 2;  // unclipped readings per image, on average

void addKernelEstimates(const PsfFit& found, Characterization& result) {
  const int size = found.psf.size;
  const std::size_t count = found.psf.kernel.size(), middle = count / 2;
  const double sum = 1 / found.psf.kernel[middle];
  for (std::size_t k = 0; k < count; ++k) {
    // Error propagation through v = w / sum(w): dv / dw_j = (delta - v) / sum.
    double variance = 0;
    const auto gradient = [&](std::size_t j) { return ((j == k ? 1 : 0) - found.psf.kernel[k]) / sum; };
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t j = 0; j < count; ++j) {
        if (i == middle || j == middle) continue;
        const auto p = static_cast<Eigen::Index>(i < middle ? i : i - 1), q = static_cast<Eigen::Index>(j < middle ? j : j - 1);
        variance += gradient(i) * gradient(j) * found.fit.covariance(p, q);
      }
    }
    const double half = studentFactor(found.fit.degrees_of_freedom) * std::sqrt(std::max(0.0, variance));
    const auto at = [&](std::size_t index) { return std::to_string(index); };
    result.estimates.push_back(
        {.parameter = "psf.kernel[" + at(k / static_cast<std::size_t>(size)) + "][" + at(k % static_cast<std::size_t>(size)) + "]",
         .unit = "",
         .determined = std::isfinite(half),
         .value = found.psf.kernel[k],
         .low = std::max(0.0, found.psf.kernel[k] - half),
         .high = found.psf.kernel[k] + half,
         .remark = ""});
  }
}

FitFigure figureOf(const PointSpreadModel& model, const PsfFit& found) {
  FitFigure figure{.title = "Readings under points", .x_label = "fitted, counts", .y_label = "measured, counts", .curves = {}};
  FitFigure::Curve dots{.name = "taxels", .measured = true, .x = {}, .y = {}}, line{.name = "fitted = measured", .x = {0, 0}, .y = {0, 0}};
  for (std::size_t g = 0; g < model.images.size(); ++g) {
    for (std::size_t k = 0; k < model.images[g].taxels.size(); ++k) {
      const double counts = model.images[g].counts[model.images[g].taxels[k]];
      dots.x.push_back(counts + found.fit.residual[g][k]);
      dots.y.push_back(counts);
      line.x[1] = line.y[1] = std::max(line.x[1], counts);
    }
  }
  figure.curves = {std::move(dots), std::move(line)};
  return figure;
}

std::string tenThousandths(double value) {
  return numberText(std::round(value * 1e4) / 1e4);
}

PointSpreadModel modelOf(Measured measurements, const ReadoutCovariance& covariance, Characterization& result) {
  if (result.sensor.patches.size() != 1) {
    throw Error(ErrorKind::kInput, measurements.front()->file.generic_string() +
                                       ": point_images and footprint_images need a sensor with one grid; it has " +
                                       std::to_string(result.sensor.patches.size()) + " patches");
  }
  PointSpreadModel model{.sensor = result.sensor, .covariance = covariance, .images = {}};
  for (const int dead : result.dead_taxels) {
    model.sensor.readout.taxel_gain.resize(static_cast<std::size_t>(numTaxels(model.sensor)), 1.0);
    model.sensor.readout.taxel_gain[static_cast<std::size_t>(dead)] = 0;
  }
  std::size_t num_off = 0;
  model.images = pointImages(measurements, model.sensor, num_off);
  if (num_off > 0) result.remarks.push_back(std::to_string(num_off) + " point images with the indenter off the array were left out");
  model.noise = std::max(kLeastNoise, result.sensor.readout.noise);
  return model;
}

// True if nearly all readings are clipped, at 0 or at saturation. Needs chooseTaxels() for unclipped readings.
bool isNearlyClipped(const PointSpreadModel& model) {
  std::size_t num_inside = 0, num_saturated = 0;
  for (const PointImage& image : model.images) {
    num_inside += image.taxels.size();
    num_saturated += static_cast<std::size_t>(
        std::count_if(image.counts, image.counts + image.share.size(), [&](float counts) { return counts >= model.top(); }));
  }
  return num_inside < kLeastInside * model.images.size() && num_saturated >= model.images.size();
}

// First fit to unclipped readings, for size and noise; then two fits to all readings within the kernel's reach.
PsfFit fitGaussianInStages(PointSpreadModel& model, int least_size) {
  PsfFit found = fitGaussian(model, kMaxKernelSize, kStartSigma);
  int size = gaussianKernelSize(found.fit.shared[0], least_size);
  for (int round = 0; round < 2; ++round) {
    model.noise = noiseOf(model, found.fit);
    for (std::size_t g = 0; g < model.images.size(); ++g) model.images[g].amplitude = found.fit.own[g][0];
    chooseTaxels(model, size, true);
    found = fitGaussian(model, size, found.fit.shared[0]);
    size = gaussianKernelSize(found.fit.shared[0], size);
  }
  return found;
}

Estimate sigmaEstimate(const PointSpreadModel& model, const PsfFit& found, bool is_clipped) {
  const int size = found.psf.size;
  const double sigma = found.fit.shared[0], half = found.fit.halfWidth(0);
  Estimate estimate{.parameter = "psf.gaussian.sigma", .unit = "taxels", .determined = true, .value = sigma, .remark = ""};
  const bool none_seen = !(sigma - half > kSeenSigma);
  const double upper = none_seen && found.fit.degrees_of_freedom > 0 ? upperSigma(model, found, size) : kMostSigma;
  if (is_clipped || sigma > 0.99 * kMostSigma || (none_seen && upper > 1)) {
    estimate.determined = false;
    estimate.remark = is_clipped ? "nearly all readings are 0 or saturated" : "not identifiable from the images";
  } else if (none_seen) {
    estimate.value = kLeastSigma, estimate.low = 0, estimate.high = upper;
    estimate.remark = "no spread found";
  } else {
    estimate.low = sigma - half, estimate.high = sigma + half;
    estimate.remark = std::to_string(model.images.size()) + (model.images.size() == 1 ? " image" : " images") + ", kernel of " +
                      std::to_string(size) + " x " + std::to_string(size);
  }
  return estimate;
}

// Replaces the Gaussian by a free kernel if that fits significantly better.
void tryFreeKernel(PointSpreadModel& model, int size, PsfFit& found, Characterization& result) {
  const auto num_weights = static_cast<std::size_t>(size * size);
  const double sigma = found.fit.shared[0];
  if (found.fit.num_rows <= num_weights + model.images.size()) return;
  PsfFit kernel = fitKernel(model, gaussianPsf(std::max(sigma, kSeenSigma), size));
  const double noise = std::exchange(model.noise, noiseOf(model, kernel.fit));
  if (model.noise < 0.9 * noise) {  // the misfit of the Gaussian was taken for noise
    found = fitGaussian(model, found.psf.size, sigma);
    kernel = fitKernel(model, kernel.psf);
  }
  const double squares = cutSquares(found.fit, model.noise), with_kernel = cutSquares(kernel.fit, model.noise);
  const auto freedom = static_cast<double>(kernel.fit.degrees_of_freedom);
  // Clipped rows have residuals of 0: counts them with the noise of the others.
  const double clipped = std::max(0.0, freedom * model.noise * model.noise - with_kernel);
  if (!isBetterFit(squares + clipped, with_kernel + clipped, static_cast<double>(num_weights - 2), freedom)) return;
  result.remarks.push_back("a free kernel fits significantly better than a Gaussian (" + tenThousandths(kernel.fit.residual_sd) +
                           " against " + tenThousandths(found.fit.residual_sd) + " counts rms): the sensor has the kernel");
  result.estimates.back().remark = "of the nearest Gaussian; the sensor has the kernel";
  result.sensor.psf = kernel.psf;
  addKernelEstimates(kernel, result);
  found = std::move(kernel);
}

void reportForceRatio(const PointSpreadModel& model, const PsfFit& found, Characterization& result) {
  std::vector<double> ratios;
  for (std::size_t g = 0; g < model.images.size(); ++g) {
    if (model.images[g].force > 0) ratios.push_back(found.fit.own[g][0] / model.images[g].force);
  }
  if (ratios.empty()) return;
  result.remarks.push_back("point images: force read / force measured has a median of " + tenThousandths(medianOf(std::move(ratios))));
}

}  // namespace

int gaussianKernelSize(double sigma, int least) {
  const auto weight = [&](int a) { return std::exp(-a * a / (2 * sigma * sigma)); };
  double all = 1;
  for (int a = 1; a <= 20; ++a) all += 2 * weight(a);
  int size = least;
  for (; size < kMaxKernelSize; size += 2) {
    double inside = 1;
    for (int a = 1; a <= size / 2; ++a) inside += 2 * weight(a);
    if (1 - inside * inside / (all * all) <= kOutsideKernel) break;
  }
  return size;
}

void fitPointSpread(Measured measurements, const ReadoutCovariance& covariance, Characterization& result) {
  PointSpreadModel model = modelOf(measurements, covariance, result);
  const int known_size = result.sensor.psf.sigma > 0 ? 1 : result.sensor.psf.size;
  chooseTaxels(model, kMaxKernelSize, false);
  const bool is_clipped = isNearlyClipped(model);
  PsfFit found = fitGaussianInStages(model, std::max(3, known_size));
  const Estimate estimate = sigmaEstimate(model, found, is_clipped);
  if (estimate.determined) result.sensor.psf = gaussianPsf(estimate.value, found.psf.size);
  result.estimates.push_back(estimate);
  if (estimate.determined) tryFreeKernel(model, std::clamp(known_size, 3, kMaxFreeKernel), found, result);
  reportForceRatio(model, found, result);
  result.fits.push_back({.measurement = namesOf(measurements),
                         .unit = "counts",
                         .rms = found.fit.residual_sd,
                         .num_rows = found.fit.num_rows,
                         .num_outliers = found.fit.num_outliers});
  result.figures.push_back(figureOf(model, found));
}

}  // namespace taxelsim
