#include "characterize/point_spread_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "reference/readout.h"

namespace taxelsim {
namespace {

constexpr double kLeastFreedom = 10;    // unclipped readings that a noise estimate needs
constexpr double kUpperSquares = 3.84;  // variances by which the sum of squares grows at the end of a 95 % interval

// reference::spread() with per-source normalization for the few loaded taxels: share of the force on each taxel, (num_taxels).
void spreadShares(const GridPatch& patch, const Psf& psf, const PointImage& image, std::vector<double>& spread) {
  spread.assign(image.share.size(), 0);
  const int reach = psf.size / 2;
  for (const std::size_t source : image.loaded) {
    const int i = static_cast<int>(source) / patch.num_cols, j = static_cast<int>(source) % patch.num_cols;
    const int first_a = std::max(-reach, -i), last_a = std::min(reach, patch.num_rows - 1 - i);
    const int first_b = std::max(-reach, -j), last_b = std::min(reach, patch.num_cols - 1 - j);
    const auto weight = [&](int a, int b) { return psf.kernel[static_cast<std::size_t>((a + reach) * psf.size + b + reach)]; };
    double total = 0;
    for (int a = first_a; a <= last_a; ++a) {
      for (int b = first_b; b <= last_b; ++b) total += weight(a, b);
    }
    if (total <= 0) continue;
    for (int a = first_a; a <= last_a; ++a) {
      for (int b = first_b; b <= last_b; ++b) {
        spread[static_cast<std::size_t>((i + a) * patch.num_cols + j + b)] += image.share[source] * weight(a, b) / total;
      }
    }
  }
}

// Expected reading (counts) of a taxel; `trigger` in N.
double readingOf(const PointSpreadModel& model, double force, double gain, double trigger) {
  return clippedMean(reference::analogueOutput(model.sensor.readout, force, gain, trigger, 0), model.noise, model.top());
}

// Adds the uncertainty of gains and triggers to the covariance of the shared parameters, by error propagation.
void addReadoutUncertainty(const PointSpreadModel& model, const std::function<Psf(const double*)>& psf, GroupedFit& fit) {
  if (model.covariance.empty() || fit.shared.empty()) return;
  constexpr double kStep = 1e-6;  // gain: relative; trigger: N
  const Readout& readout = model.sensor.readout;
  const Psf found = psf(fit.shared.data());
  std::vector<Eigen::MatrixXd> moved(model.covariance.size(), Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(fit.shared.size()), 2));
  std::vector<double> spread;
  for (std::size_t g = 0; g < model.images.size(); ++g) {
    const PointImage& image = model.images[g];
    spreadShares(model.sensor.patches[0], found, image, spread);
    for (std::size_t k = 0; k < image.taxels.size(); ++k) {
      const std::size_t t = image.taxels[k];
      const double force = fit.own[g][0] * spread[t], gain = reference::gainOf(readout, t), trigger = reference::triggerOf(readout, t);
      const Eigen::RowVector2d growth{
          (readingOf(model, force, gain + kStep, trigger) - readingOf(model, force, gain - kStep, trigger)) / (2 * kStep),
          (readingOf(model, force, gain, trigger + kStep) - readingOf(model, force, gain, trigger - kStep)) / (2 * kStep)};
      moved[t] += fit.response[g].col(static_cast<Eigen::Index>(k)) * growth;
    }
  }
  for (std::size_t t = 0; t < moved.size(); ++t) {
    const Eigen::Matrix2d of_taxel = Eigen::Matrix2d::Map(model.covariance[t].data());
    fit.covariance += moved[t] * of_taxel * moved[t].transpose();
  }
}

// `psf` maps the shared parameters to a point spread function; no parameters: a constant one.
PsfFit fitPsf(const PointSpreadModel& model, const std::vector<FitParameter>& shared, const std::function<Psf(const double*)>& psf) {
  GroupedProblem problem{.shared = shared, .own = {}, .num_rows = {}, .noise = model.noise, .residuals = {}};
  std::vector<PointImage> moved = model.images;
  std::vector<std::array<double, 2>> at(moved.size(), {0, 0});  // m, where the shares of `moved` are
  for (const PointImage& image : model.images) {
    std::vector<FitParameter>& own = problem.own.emplace_back(
        std::vector<FitParameter>{{.start = image.amplitude, .scale = image.amplitude, .low = 1e-3 * image.amplitude}});
    problem.num_rows.push_back(image.taxels.size());
    if (!(image.points->position_error > 0)) continue;
    own.resize(3, {.start = 0, .scale = image.points->position_error});
    problem.num_rows.back() += 2;  // their prior
  }
  std::vector<double> spread;
  problem.residuals = [&](std::size_t g, const double* values, const double* own, double* residuals) {
    PointImage& image = moved[g];
    if (const double error = image.points->position_error; error > 0) {
      const std::array<double, 2> offset{own[1], own[2]};
      if (offset != at[g]) image.place(model.sensor.patches[0], offset);
      at[g] = offset;
      for (std::size_t axis = 0; axis < 2; ++axis) residuals[image.taxels.size() + axis] = model.noise * offset[axis] / error;
    }
    spreadShares(model.sensor.patches[0], psf(values), image, spread);
    for (std::size_t k = 0; k < image.taxels.size(); ++k) {
      const std::size_t t = image.taxels[k];
      residuals[k] =
          readingOf(model, own[0] * spread[t], reference::gainOf(model.sensor.readout, t), reference::triggerOf(model.sensor.readout, t)) -
          image.counts[t];
    }
  };
  PsfFit result{.psf = {}, .fit = fitGroups(problem)};
  result.psf = psf(result.fit.shared.data());
  addReadoutUncertainty(model, psf, result.fit);
  return result;
}

}  // namespace

void chooseTaxels(PointSpreadModel& model, int size, bool all) {
  const GridPatch& patch = model.sensor.patches[0];
  const int reach = size / 2;
  for (PointImage& image : model.images) {
    image.taxels.clear();
    for (int i = 0; i < patch.num_rows; ++i) {
      for (int j = 0; j < patch.num_cols; ++j) {
        const auto t = static_cast<std::size_t>(i * patch.num_cols + j);
        bool reached = false;
        for (int a = std::max(0, i - reach); a <= std::min(patch.num_rows - 1, i + reach); ++a) {
          for (int b = std::max(0, j - reach); b <= std::min(patch.num_cols - 1, j + reach); ++b) {
            reached = reached || image.share[static_cast<std::size_t>(a * patch.num_cols + b)] > 0;
          }
        }
        const bool inside = image.counts[t] > 0 && image.counts[t] < model.top();
        if (reached && (all || inside) && reference::gainOf(model.sensor.readout, t) > 0) image.taxels.push_back(t);
      }
    }
  }
}

double noiseOf(const PointSpreadModel& model, const GroupedFit& fit) {
  double squares = 0, count = 0;
  const double guess = fit.residual_sd;
  for (std::size_t g = 0; g < model.images.size(); ++g) {
    for (std::size_t k = 0; k < model.images[g].taxels.size(); ++k) {
      const double residual = fit.residual[g][k], mean = model.images[g].counts[model.images[g].taxels[k]] + residual;
      if (fit.outlier[g][k] || mean < kFarNoise * guess || mean > model.top() - kFarNoise * guess) continue;
      squares += residual * residual;
      ++count;
    }
  }
  const auto used = static_cast<double>(fit.num_rows - fit.num_outliers);
  // Unclipped readings determine all parameters.
  const double freedom = count - (used - static_cast<double>(fit.degrees_of_freedom));
  return std::max(kLeastNoise, freedom >= kLeastFreedom ? std::sqrt(squares / freedom) : guess);
}

PsfFit fitGaussian(const PointSpreadModel& model, int size, double start) {
  const std::vector<FitParameter> sigma{{.start = start, .scale = 1, .low = kLeastSigma, .high = kMostSigma}};
  return fitPsf(model, sigma, [size](const double* values) { return gaussianPsf(values[0], size); });
}

PsfFit fitKernel(const PointSpreadModel& model, const Psf& start) {
  const std::size_t middle = start.kernel.size() / 2;
  std::vector<FitParameter> weights;
  for (std::size_t k = 0; k < start.kernel.size(); ++k) {
    if (k != middle) weights.push_back({.start = start.kernel[k] / start.kernel[middle], .scale = 0.1, .low = 0, .high = 100});
  }
  return fitPsf(model, weights, [size = start.size, middle](const double* values) {
    Psf psf{.size = size, .kernel = {}};
    const auto count = static_cast<std::size_t>(size * size);
    double sum = 0;
    for (std::size_t k = 0; k < count; ++k) {
      psf.kernel.push_back(k == middle ? 1 : values[k < middle ? k : k - 1]);
      sum += psf.kernel.back();
    }
    for (double& weight : psf.kernel) weight /= sum;
    return psf;
  });
}

double upperSigma(const PointSpreadModel& model, const PsfFit& found, int size) {
  const double least = cutSquares(found.fit, model.noise), variance = model.noise * model.noise;
  for (double sigma = kSeenSigma; sigma <= 1; sigma += 0.05) {
    const PsfFit other = fitPsf(model, {}, [&](const double*) { return gaussianPsf(sigma, size); });
    if (sigma > found.fit.shared[0] && cutSquares(other.fit, model.noise) - least > kUpperSquares * variance) return sigma;
  }
  return kMostSigma;
}

}  // namespace taxelsim
