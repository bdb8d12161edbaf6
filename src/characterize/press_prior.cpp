#include "characterize/press_prior.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>

#include "taxelsim/characterize.h"

namespace taxelsim {
namespace {

constexpr std::array<double, 6> kLengths{0.1, 0.15, 0.2, 0.3, 0.45, 0.65};  // of the range of log(load)
constexpr std::array<double, 9> kLoadSpreads{0.02, 0.03, 0.045, 0.065, 0.09, 0.13, 0.18, 0.25, 0.35};
constexpr std::array<double, 9> kPressSpreads{0.005, 0.01, 0.015, 0.02, 0.03, 0.045, 0.065, 0.09, 0.13};

double logDeterminant(const Eigen::LLT<Eigen::MatrixXd>& factor) {
  return 2 * factor.matrixLLT().diagonal().array().log().sum();
}

Eigen::MatrixXd inverseOf(const Eigen::MatrixXd& matrix) {
  return matrix.llt().solve(Eigen::MatrixXd::Identity(matrix.rows(), matrix.cols()));
}

// What the images say of the gains u, as a likelihood exp(-u' precision u / 2 + u' pull).
struct Evidence {
  Eigen::MatrixXd precision;
  Eigen::VectorXd pull;

  // Logarithm of the integral of prior times likelihood, without constants.
  double of(const Eigen::MatrixXd& prior) const {
    const Eigen::LLT<Eigen::MatrixXd> factor(prior);
    const Eigen::LLT<Eigen::MatrixXd> posterior(factor.solve(Eigen::MatrixXd::Identity(prior.rows(), prior.cols())) + precision);
    return (pull.dot(posterior.solve(pull)) - logDeterminant(factor) - logDeterminant(posterior)) / 2;
  }
};

}  // namespace

double PressPrior::processCovariance(double load, double other) const {
  const double distance = std::log(load / other) / length;
  return load_spread * load_spread * std::exp(-distance * distance / 2);
}

Eigen::MatrixXd PressPrior::covariance(const std::vector<double>& loads) const {
  const auto count = static_cast<Eigen::Index>(loads.size());
  Eigen::MatrixXd matrix = press_spread * press_spread * Eigen::MatrixXd::Identity(count, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    for (Eigen::Index j = 0; j < count; ++j) {
      matrix(i, j) += processCovariance(loads[static_cast<std::size_t>(i)], loads[static_cast<std::size_t>(j)]);
    }
  }
  return matrix;
}

double BenchGains::at(double load) const {
  const auto [low, high] = std::minmax_element(loads.begin(), loads.end());
  if (loads.empty() || load < *low || load > *high) return 0;
  const PressPrior prior{.load_spread = load_spread, .length = length, .press_spread = press_spread};
  const auto count = static_cast<Eigen::Index>(loads.size());
  Eigen::VectorXd shared(count);
  for (Eigen::Index i = 0; i < count; ++i) shared[i] = prior.processCovariance(load, loads[static_cast<std::size_t>(i)]);
  return shared.dot(prior.covariance(loads).llt().solve(Eigen::Map<const Eigen::VectorXd>(log_gains.data(), count)));
}

PressPriorChoice choosePressPrior(const std::vector<double>& loads, const Eigen::VectorXd& fitted, const Eigen::MatrixXd& covariance,
                                  const PressPrior& used) {
  const Eigen::MatrixXd known = inverseOf(covariance);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> from_images(known - inverseOf(used.covariance(loads)));
  // Rounding may leave precisions below 0 along directions of which the images say nothing.
  const Evidence evidence{
      .precision = from_images.eigenvectors() * from_images.eigenvalues().cwiseMax(0).asDiagonal() * from_images.eigenvectors().transpose(),
      .pull = known * fitted};
  const auto [low, high] = std::minmax_element(loads.begin(), loads.end());
  const double range = std::log(*high / *low);
  double without = -1e300, best = -1e300;
  PressPriorChoice choice;
  const auto tryPrior = [&](const PressPrior& prior) {
    const double found = evidence.of(prior.covariance(loads));
    if (prior.load_spread == 0) without = std::max(without, found);
    if (found > best) best = found, choice.prior = prior;
  };
  for (const double spread : kPressSpreads) tryPrior({.load_spread = 0, .length = range, .press_spread = spread});
  for (const double spread : kLoadSpreads) tryPrior({.load_spread = 0, .length = range, .press_spread = spread});
  for (const double part : kLengths) {
    for (const double load_spread : kLoadSpreads) {
      for (const double spread : kPressSpreads) tryPrior({.load_spread = load_spread, .length = part * range, .press_spread = spread});
    }
  }
  choice.gain = best - without;
  return choice;
}

}  // namespace taxelsim
