#include "characterize/stamp_baselines.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>

namespace taxelsim {
namespace {

constexpr int kPoints = 4;  // per side of a taxel, for the mean over its area
constexpr std::array<double, 6> kRidges{0.003, 0.01, 0.03, 0.1, 0.3, 1};
constexpr int kNumTriggers = 25;
constexpr double kMostTrigger = 0.1;  // of the largest reading

// Integral of a unit Gaussian up to x.
double below(double x) {
  return std::erfc(-x / std::numbers::sqrt2) / 2;
}

// Share of the load on each taxel, (num_taxels). A disc counts as the square of the same area.
std::vector<double> sharesOf(const Sensor& sensor, const Indenter& indenter, const std::array<double, 2>& centre, double sigma) {
  std::array<double, 2> size = indenter.size;
  if (indenter.shape == Indenter::Shape::kFlatPin) size = {std::sqrt(indenter.sectionAt(0)), std::sqrt(indenter.sectionAt(0))};
  std::vector<double> shares;
  const std::vector<Vector3> positions = taxelPositions(sensor);
  for (const GridPatch& patch : sensor.patches) {
    for (int t = 0; t < patch.num_rows * patch.num_cols; ++t) {
      const Vector3& position = positions[shares.size()];
      double share = 1;
      for (std::size_t axis = 0; axis < 2; ++axis) {
        double mean = 0;
        for (int k = 0; k < kPoints; ++k) {
          const double at = position[axis] + ((k + 0.5) / kPoints - 0.5) * patch.pitch[axis] - centre[axis];
          mean += (below((at + size[axis] / 2) / sigma) - below((at - size[axis] / 2) / sigma)) / kPoints;
        }
        share *= mean * patch.pitch[axis] / size[axis];
      }
      shares.push_back(share);
    }
  }
  return shares;
}

// Mean centroid of the presses at the place of `wanted`, else its measured position; none if both are missing.
std::optional<std::array<double, 2>> centreOf(const Sensor& sensor, const std::vector<RecordedPress>& presses,
                                              const RecordedPress& wanted) {
  const std::vector<Vector3> positions = taxelPositions(sensor);
  std::array<double, 2> centre{0, 0};
  double count = 0;
  for (const RecordedPress& press : presses) {
    if (press.place != wanted.place) continue;
    double x = 0, y = 0, sum = 0;
    for (std::size_t t = 0; t < positions.size(); ++t) {
      x += press.image[t] * positions[t][0], y += press.image[t] * positions[t][1], sum += press.image[t];
    }
    centre[0] += x / sum, centre[1] += y / sum, ++count;
  }
  if (count == 0) return wanted.position;
  return std::array<double, 2>{centre[0] / count, centre[1] / count};
}

struct Blur {
  double sigma = 0;  // m
  double slope = 0;  // counts per newton
};

// Least squares over a grid of sigmas.
Blur blurOf(const Sensor& sensor, const std::vector<RecordedPress>& presses) {
  Blur best;
  double least = 1e300;
  std::vector<std::array<double, 2>> centres;
  for (const RecordedPress& press : presses) centres.push_back(*centreOf(sensor, presses, press));
  for (double sigma = 0.2; sigma <= 1.5; sigma *= 1.07) {
    double product = 0, power = 0, squares = 0;
    for (std::size_t p = 0; p < presses.size(); ++p) {
      const RecordedPress& press = presses[p];
      const std::vector<double> shares = sharesOf(sensor, *press.indenter, centres[p], sigma * sensor.patches[0].pitch[0]);
      for (std::size_t t = 0; t < shares.size(); ++t) {
        const double force = press.load * shares[t];
        product += force * press.image[t], power += force * force, squares += press.image[t] * press.image[t];
      }
    }
    const double misfit = squares - product * product / power;
    if (misfit < least) least = misfit, best = {sigma * sensor.patches[0].pitch[0], product / power};
  }
  return best;
}

struct GainFit {
  std::vector<double> slope;  // (num_taxels), counts per newton
  double trigger = 0;         // counts
};

// Forces (N) on the taxels of each press.
using PressForces = std::vector<std::vector<double>>;

// `training` gives the places of the presses.
PressForces forcesOf(const Sensor& sensor, const std::vector<RecordedPress>& training, const std::vector<RecordedPress>& presses,
                     const Blur& blur) {
  PressForces forces;
  for (const RecordedPress& press : presses) {
    forces.push_back(sharesOf(sensor, *press.indenter, *centreOf(sensor, training, press), blur.sigma));
    for (double& force : forces.back()) force *= press.load;
  }
  return forces;
}

GainFit gainsFor(double trigger, double ridge, const std::vector<RecordedPress>& presses, const PressForces& forces) {
  const std::size_t num_taxels = forces.front().size();
  std::vector<double> product(num_taxels), power(num_taxels);
  double all_products = 0, all_powers = 0;
  for (std::size_t p = 0; p < presses.size(); ++p) {
    for (std::size_t t = 0; t < num_taxels; ++t) {
      if (!(presses[p].image[t] > 0)) continue;
      product[t] += forces[p][t] * (presses[p].image[t] + trigger);
      power[t] += forces[p][t] * forces[p][t];
    }
  }
  for (std::size_t t = 0; t < num_taxels; ++t) all_products += product[t], all_powers += power[t];
  const double mean = all_products / all_powers, weight = ridge * all_powers / static_cast<double>(num_taxels);
  GainFit fit{.slope = {}, .trigger = trigger};
  for (std::size_t t = 0; t < num_taxels; ++t) fit.slope.push_back((product[t] + weight * mean) / (power[t] + weight));
  return fit;
}

double countsOf(const GainFit& fit, std::size_t taxel, double force) {
  return std::max(0.0, fit.slope[taxel] * force - fit.trigger);
}

double squaresOf(const GainFit& fit, const std::vector<RecordedPress>& presses, const PressForces& forces) {
  double squares = 0;
  for (std::size_t p = 0; p < presses.size(); ++p) {
    for (std::size_t t = 0; t < fit.slope.size(); ++t) squares += std::pow(countsOf(fit, t, forces[p][t]) - presses[p].image[t], 2);
  }
  return squares;
}

GainFit fitGains(double ridge, const std::vector<RecordedPress>& presses, const PressForces& forces) {
  double largest = 0;
  for (const RecordedPress& press : presses) largest = std::max(largest, *std::max_element(press.image.begin(), press.image.end()));
  GainFit best;
  double least = 1e300;
  for (int k = 0; k < kNumTriggers; ++k) {
    GainFit fit = gainsFor(kMostTrigger * largest * k / (kNumTriggers - 1), ridge, presses, forces);
    const double squares = squaresOf(fit, presses, forces);
    if (squares < least) least = squares, best = std::move(fit);
  }
  return best;
}

// Sum of squared errors when each load is left out in turn.
double errorOfLoadsLeftOut(double ridge, const Sensor& sensor, const std::vector<RecordedPress>& presses) {
  std::vector<double> loads;
  for (const RecordedPress& press : presses) loads.push_back(press.load);
  std::sort(loads.begin(), loads.end());
  loads.erase(std::unique(loads.begin(), loads.end()), loads.end());
  double squares = 0;
  for (const double load : loads) {
    std::vector<RecordedPress> seen, scored;
    for (const RecordedPress& press : presses) (press.load == load ? scored : seen).push_back(press);
    std::erase_if(scored, [&](const RecordedPress& press) { return !centreOf(sensor, seen, press); });
    if (scored.empty()) continue;
    const Blur blur = blurOf(sensor, seen);
    squares += squaresOf(fitGains(ridge, seen, forcesOf(sensor, seen, seen, blur)), scored, forcesOf(sensor, seen, scored, blur));
  }
  return squares;
}

}  // namespace

std::vector<double> blurredFootprint(const Sensor& sensor, const std::vector<RecordedPress>& training, const RecordedPress& wanted) {
  const Blur blur = blurOf(sensor, training);
  std::vector<double> counts = forcesOf(sensor, training, {wanted}, blur).front();
  for (double& value : counts) value *= blur.slope;
  return counts;
}

std::vector<double> blurredFootprintWithGains(const Sensor& sensor, const std::vector<RecordedPress>& training,
                                              const RecordedPress& wanted) {
  double least = 1e300, best = kRidges.front();
  for (const double ridge : kRidges) {
    const double error = errorOfLoadsLeftOut(ridge, sensor, training);
    if (error < least) least = error, best = ridge;
  }
  const Blur blur = blurOf(sensor, training);
  const GainFit fit = fitGains(best, training, forcesOf(sensor, training, training, blur));
  std::vector<double> counts = forcesOf(sensor, training, {wanted}, blur).front();
  for (std::size_t t = 0; t < counts.size(); ++t) counts[t] = countsOf(fit, t, counts[t]);
  return counts;
}

std::vector<double> linePerTaxel(const std::vector<RecordedPress>& training, const RecordedPress& wanted) {
  std::vector<RecordedPress> there;
  std::copy_if(training.begin(), training.end(), std::back_inserter(there),
               [&](const RecordedPress& press) { return press.place == wanted.place; });
  const auto count = static_cast<double>(there.size());
  double mean_load = 0, spread = 0;
  for (const RecordedPress& press : there) mean_load += press.load / count;
  for (const RecordedPress& press : there) spread += std::pow(press.load - mean_load, 2);
  std::vector<double> counts;
  for (std::size_t t = 0; t < there.front().image.size(); ++t) {
    double mean = 0, product = 0;
    for (const RecordedPress& press : there) mean += press.image[t] / count;
    for (const RecordedPress& press : there) product += (press.load - mean_load) * press.image[t];
    const double slope = spread > 0 ? product / spread : 0;
    counts.push_back(std::max(0.0, mean + slope * (wanted.load - mean_load)));
  }
  return counts;
}

}  // namespace taxelsim
