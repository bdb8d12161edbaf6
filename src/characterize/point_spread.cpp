// Images under an indenter at known places: footprint x amplitude -> point spread function -> readout; paper, eq. (1) and section II.A.
//
// The footprint is that of an elastic foundation (footprint.h), by exact overlap with the taxels; its force is free in every image, so that
// what the press or the load cell adds does not reach the spread.
#include <algorithm>
#include <cmath>
#include <utility>

#include "base/text.h"
#include "characterize/clipped_mean.h"
#include "characterize/fits.h"
#include "characterize/footprint.h"
#include "characterize/least_squares.h"
#include "reference/readout.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

constexpr double kStill = 2;             // counts: an image with no more shows nothing
constexpr std::size_t kMaxImages = 600;  // more are thinned evenly
constexpr double kLeastSigma = 0.15;     // taxels: a sampled Gaussian so narrow leaves all on its taxel
constexpr double kSeenSigma = 0.2;       // taxels: 4e-6 on a neighbour; a narrower one cannot be told from none
constexpr double kMostSigma = 4;         // taxels
constexpr double kStartSigma = 0.6;      // taxels
constexpr double kOutsideKernel = 5e-3;  // of a Gaussian's weight: what a kernel may leave out
constexpr double kLeastOnArray = 1e-3;   // of an indenter's force
constexpr int kMaxFreeKernel = 5;        // taxels per side of a kernel without a formula
constexpr double kLeastFreedom = 10;     // of readings that the noise is taken from
constexpr std::size_t kLeastInside = 2;  // readings of an image between the ends, on average
constexpr double kUpperSquares = 3.84;   // variances by which the sum of squares grows at a one-sided bound's 95 %

struct Image {
  std::vector<double> share;        // (num_taxels), of the indenter's force
  std::vector<std::size_t> loaded;  // taxels with a share
  std::vector<std::size_t> taxels;  // that are fitted
  const float* counts = nullptr;    // (num_taxels)
  double amplitude = 0;             // N, to begin with
  double force = 0;                 // N, measured; 0 for none
};

struct Model {
  Sensor sensor;  // but for its point spread function, which is what is fitted
  ReadoutDoubt doubt;
  std::vector<Image> images;
  double noise = kLeastNoise;  // counts

  double top() const { return sensor.readout.saturation; }
};

struct PsfFit {
  Psf psf;
  GroupedFit fit;
};

// Force of an indenter at `place` (m, in P) on each taxel, of one in all.
std::vector<double> sharesOf(const GridPatch& patch, const Indenter& indenter, const std::array<double, 2>& place,
                             const std::vector<PressedSection>& sections) {
  std::vector<double> shares(static_cast<std::size_t>(patch.num_rows * patch.num_cols));
  double total = 0;
  for (const PressedSection& section : sections) {
    const Polygon polygon = moved(sectionOf(indenter, section.height), place);
    const double per_area = section.volume / indenter.sectionAt(section.height);
    total += section.volume;
    for (int i = 0; i < patch.num_rows; ++i) {
      for (int j = 0; j < patch.num_cols; ++j) {
        const double x = (i - patch.num_rows / 2.0) * patch.pitch[0], y = (j - patch.num_cols / 2.0) * patch.pitch[1];
        shares[static_cast<std::size_t>(i * patch.num_cols + j)] +=
            per_area * overlap(polygon, {x, y}, {x + patch.pitch[0], y + patch.pitch[1]});
      }
    }
  }
  for (double& share : shares) share /= total;
  return shares;
}

double sumOf(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return sum;
}

std::vector<Image> imagesOf(Measured measurements, const Sensor& sensor, std::size_t& num_off) {
  std::vector<Image> images;
  bool any = false;
  const Winkler foundation = foundationOf(sensor.skin);
  for (const Measurement* measurement : measurements) {
    const auto& points = std::get<PointImages>(measurement->data);
    for (std::size_t row = 0; row < points.position.size(); ++row) {
      Image image{.share = {}, .loaded = {}, .taxels = {}, .counts = &points.images.counts[row * points.images.num_taxels]};
      double most = 0;
      for (std::size_t t = 0; t < points.images.num_taxels; ++t) {
        const double counts = image.counts[t];
        most = std::max(most, counts);
        image.amplitude += nominalForce(sensor.readout, counts);
      }
      if (most <= kStill) continue;
      any = true;
      if (!points.force.empty()) image.force = std::max(0.0, points.force[row]);
      // As deep as carries the force; what the image reads where none was measured.
      const double force = image.force > 0 ? image.force : image.amplitude;
      const double depth = depthOfVolume(points.indenter, foundation.normal_exponent, force / foundation.normal_contact_stiffness);
      image.share = sharesOf(sensor.patches[0], points.indenter, points.position[row],
                             pressedSections(points.indenter, foundation.normal_exponent, depth));
      const double on_array = sumOf(image.share);
      if (on_array < kLeastOnArray) {
        ++num_off;
        continue;
      }
      image.amplitude = std::max(image.amplitude, 1e-6) / on_array;
      for (std::size_t t = 0; t < image.share.size(); ++t) {
        if (image.share[t] > 0) image.loaded.push_back(t);
      }
      images.push_back(std::move(image));
    }
  }
  const std::string file = measurements.front()->file.generic_string();
  if (!any) throw Error(ErrorKind::kInput, file + ": nothing touches: no taxel reads more than " + numberText(kStill) + " counts");
  if (images.empty())
    throw Error(ErrorKind::kInput, file + ": the indenter lies off the array in all images: x and y are in its patch's frame");
  if (images.size() > kMaxImages) {
    std::vector<Image> thinned;
    for (std::size_t k = 0; k < kMaxImages; ++k) thinned.push_back(std::move(images[k * images.size() / kMaxImages]));
    images = std::move(thinned);
  }
  return images;
}

// As reference::spread() per source, of the few taxels that are loaded: force on each taxel, (num_taxels), of one in all.
void spreadShares(const GridPatch& patch, const Psf& psf, const Image& image, std::vector<double>& spread) {
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

// What a taxel of that gain and trigger (N) counts on average.
double readingOf(const Model& model, double force, double gain, double trigger) {
  return clippedMean(reference::analogueOutput(model.sensor.readout, force, gain, trigger, 0), model.noise, model.top());
}

// All taxels that a kernel of `size` reaches from the footprint, but for dead ones; `all` or only those that read between the ends.
void chooseTaxels(Model& model, int size, bool all) {
  const GridPatch& patch = model.sensor.patches[0];
  const int reach = size / 2;
  for (Image& image : model.images) {
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

// Standard deviation (counts) of readings that no end clips; of all where there are too few.
double noiseOf(const Model& model, const GroupedFit& fit) {
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
  // It is these that the parameters are fitted to.
  const double freedom = count - (used - static_cast<double>(fit.degrees_of_freedom));
  return std::max(kLeastNoise, freedom >= kLeastFreedom ? std::sqrt(squares / freedom) : guess);
}

// What is not known of gains and triggers moves the shared parameters, each image's readings being all they have.
void addDoubt(const Model& model, const std::function<Psf(const double*)>& psf, GroupedFit& fit) {
  if (model.doubt.empty() || fit.shared.empty()) return;
  constexpr double kStep = 1e-6;  // of the gain; N
  const Readout& readout = model.sensor.readout;
  const Psf found = psf(fit.shared.data());
  std::vector<Eigen::MatrixXd> moved(model.doubt.size(), Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(fit.shared.size()), 2));
  std::vector<double> spread;
  for (std::size_t g = 0; g < model.images.size(); ++g) {
    const Image& image = model.images[g];
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
  for (std::size_t t = 0; t < moved.size(); ++t) fit.covariance += moved[t] * model.doubt[t] * moved[t].transpose();
}

// `psf` of the shared parameters; none: a point spread function that stays.
PsfFit fitPsf(const Model& model, const std::vector<FitParameter>& shared, const std::function<Psf(const double*)>& psf) {
  GroupedProblem problem{.shared = shared, .own = {}, .num_rows = {}, .noise = model.noise, .residuals = {}};
  for (const Image& image : model.images) {
    problem.own.push_back({{.start = image.amplitude, .scale = image.amplitude, .low = 1e-3 * image.amplitude}});
    problem.num_rows.push_back(image.taxels.size());
  }
  std::vector<double> spread;
  problem.residuals = [&](std::size_t g, const double* values, const double* own, double* residuals) {
    const Image& image = model.images[g];
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
  addDoubt(model, psf, result.fit);
  return result;
}

PsfFit fitGaussian(const Model& model, int size, double start) {
  const std::vector<FitParameter> sigma{{.start = start, .scale = 1, .low = kLeastSigma, .high = kMostSigma}};
  return fitPsf(model, sigma, [size](const double* values) { return gaussianPsf(values[0], size); });
}

// Weights but the middle one, which is 1. Of the size of `start`: weights far out, which the trigger hides, would be anything.
PsfFit fitKernel(const Model& model, const Psf& start) {
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

// The largest sigma that the images do not speak against; kMostSigma where they speak against none up to one taxel.
double upperSigma(const Model& model, const PsfFit& found, int size) {
  const double least = cutSquares(found.fit, model.noise), variance = model.noise * model.noise;
  for (double sigma = kSeenSigma; sigma <= 1; sigma += 0.05) {
    const PsfFit other = fitPsf(model, {}, [&](const double*) { return gaussianPsf(sigma, size); });
    if (sigma > found.fit.shared[0] && cutSquares(other.fit, model.noise) - least > kUpperSquares * variance) return sigma;
  }
  return kMostSigma;
}

void addKernelEstimates(const PsfFit& found, Characterization& result) {
  const int size = found.psf.size;
  const std::size_t count = found.psf.kernel.size(), middle = count / 2;
  const double sum = 1 / found.psf.kernel[middle];
  for (std::size_t k = 0; k < count; ++k) {
    // A weight is v = w / sum of w, dv / dw_j = (delta - v) / sum.
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

FitFigure figureOf(const Model& model, const PsfFit& found) {
  FitFigure figure{.title = "Readings under points", .x_label = "as fitted, counts", .y_label = "counts", .curves = {}};
  FitFigure::Curve dots{.name = "taxels", .measured = true, .x = {}, .y = {}}, line{.name = "equal", .x = {0, 0}, .y = {0, 0}};
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

std::string rounded(double value) {
  return numberText(std::round(value * 1e4) / 1e4);
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

void fitPointSpread(Measured measurements, const ReadoutDoubt& doubt, Characterization& result) {
  const std::string file = measurements.front()->file.generic_string();
  if (result.sensor.patches.size() != 1) {
    throw Error(ErrorKind::kInput, file + ": images under points need a sensor of one grid, not of " +
                                       std::to_string(result.sensor.patches.size()) + " patches");
  }
  Model model{.sensor = result.sensor, .doubt = doubt, .images = {}};
  for (const int dead : result.dead_taxels) {
    model.sensor.readout.taxel_gain.resize(static_cast<std::size_t>(numTaxels(model.sensor)), 1.0);
    model.sensor.readout.taxel_gain[static_cast<std::size_t>(dead)] = 0;
  }
  std::size_t num_off = 0;
  model.images = imagesOf(measurements, model.sensor, num_off);
  if (num_off > 0) result.remarks.push_back(std::to_string(num_off) + " images under points off the array were left out");
  model.noise = std::max(kLeastNoise, result.sensor.readout.noise);

  // First by what reads between the ends, to see how far it spreads and how noisy it is.
  const int known_size = result.sensor.psf.sigma > 0 ? 1 : result.sensor.psf.size;
  int size = std::max(3, known_size);
  chooseTaxels(model, kMaxKernelSize, false);
  std::size_t num_inside = 0, num_saturated = 0;
  for (const Image& image : model.images) {
    num_inside += image.taxels.size();
    num_saturated += static_cast<std::size_t>(
        std::count_if(image.counts, image.counts + image.share.size(), [&](float counts) { return counts >= model.top(); }));
  }
  PsfFit found = fitGaussian(model, kMaxKernelSize, kStartSigma);
  size = gaussianKernelSize(found.fit.shared[0], size);
  for (int round = 0; round < 2; ++round) {
    model.noise = noiseOf(model, found.fit);
    for (std::size_t g = 0; g < model.images.size(); ++g) model.images[g].amplitude = found.fit.own[g][0];
    chooseTaxels(model, size, true);
    found = fitGaussian(model, size, found.fit.shared[0]);
    size = gaussianKernelSize(found.fit.shared[0], size);
  }
  size = found.psf.size;

  const double sigma = found.fit.shared[0], half = found.fit.halfWidth(0);
  Estimate estimate{.parameter = "psf.gaussian.sigma", .unit = "taxels", .determined = true, .value = sigma, .remark = ""};
  const bool none_seen = !(sigma - half > kSeenSigma);
  const double upper = none_seen && found.fit.degrees_of_freedom > 0 ? upperSigma(model, found, size) : kMostSigma;
  const bool at_ends = num_inside < kLeastInside * model.images.size() && num_saturated >= model.images.size();
  if (at_ends || sigma > 0.99 * kMostSigma || (none_seen && upper > 1)) {
    estimate.determined = false;
    estimate.remark = at_ends ? "nearly all readings are 0 or saturated" : "the images do not tell it";
  } else if (none_seen) {
    estimate.value = kLeastSigma, estimate.low = 0, estimate.high = upper;
    estimate.remark = "no spread is seen";
  } else {
    estimate.low = sigma - half, estimate.high = sigma + half;
    estimate.remark = std::to_string(model.images.size()) + (model.images.size() == 1 ? " image" : " images") + ", kernel of " +
                      std::to_string(size) + " x " + std::to_string(size);
  }
  const bool determined = estimate.determined;
  if (determined) result.sensor.psf = gaussianPsf(estimate.value, size);
  result.estimates.push_back(std::move(estimate));

  const int free_size = std::clamp(known_size, 3, kMaxFreeKernel);
  const auto num_weights = static_cast<std::size_t>(free_size * free_size);
  if (determined && found.fit.num_rows > num_weights + model.images.size()) {
    PsfFit kernel = fitKernel(model, gaussianPsf(std::max(sigma, kSeenSigma), free_size));
    const double noise = std::exchange(model.noise, noiseOf(model, kernel.fit));
    if (model.noise < 0.9 * noise) {  // what the Gaussian missed was taken for noise
      found = fitGaussian(model, size, sigma);
      kernel = fitKernel(model, kernel.psf);
    }
    const double squares = cutSquares(found.fit, model.noise), with_kernel = cutSquares(kernel.fit, model.noise);
    const auto freedom = static_cast<double>(kernel.fit.degrees_of_freedom);
    const double pinned = std::max(0.0, freedom * model.noise * model.noise - with_kernel);  // by rows that tell nothing
    if (isBetterFit(squares + pinned, with_kernel + pinned, static_cast<double>(num_weights - 2), freedom)) {
      result.remarks.push_back("a Gaussian leaves " + rounded(found.fit.residual_sd) + " counts, a free kernel " +
                               rounded(kernel.fit.residual_sd) + ", better by more than chance: the kernel is taken");
      result.estimates.back().remark = "of the nearest Gaussian; the sensor has the kernel";
      result.sensor.psf = kernel.psf;
      addKernelEstimates(kernel, result);
      found = std::move(kernel);
    }
  }
  std::vector<double> ratios;
  for (std::size_t g = 0; g < model.images.size(); ++g) {
    if (model.images[g].force > 0) ratios.push_back(found.fit.own[g][0] / model.images[g].force);
  }
  if (!ratios.empty())
    result.remarks.push_back("images under points read " + rounded(medianOf(ratios)) + " of the forces measured (median)");
  result.fits.push_back({.measurement = measurements.front()->name,
                         .unit = "counts",
                         .rms = found.fit.residual_sd,
                         .num_rows = found.fit.num_rows,
                         .num_outliers = found.fit.num_outliers});
  result.figures.push_back(figureOf(model, found));
}

}  // namespace taxelsim
