#include "characterize/load_deviation.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <utility>

namespace taxelsim {
namespace {

constexpr std::array<double, 4> kLengths{0.15, 0.3, 0.6, 1.2};  // of the range of log(load)
constexpr std::array<double, 4> kRatios{0.3, 1, 3, 10};

using Press = LoadDeviation::Press;

// Mean of the process at `load` given the presses.
double meanAt(const std::vector<Press>& presses, double length, double ratio, double load) {
  const auto count = static_cast<Eigen::Index>(presses.size());
  if (count == 0 || ratio == 0) return 0;
  const auto covariance = [&](double a, double b) { return ratio * std::exp(-std::pow(std::log(a / b) / length, 2) / 2); };
  Eigen::MatrixXd matrix(count, count);
  Eigen::VectorXd gains(count), with(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Press& press = presses[static_cast<std::size_t>(i)];
    gains[i] = press.log_gain;
    with[i] = covariance(press.load, load);
    for (Eigen::Index j = 0; j < count; ++j)
      matrix(i, j) = covariance(press.load, presses[static_cast<std::size_t>(j)].load) + (i == j ? 1 : 0);
  }
  return with.dot(matrix.ldlt().solve(gains));
}

}  // namespace

LoadDeviation::LoadDeviation(std::vector<Press> presses) : presses_(std::move(presses)) {
  std::vector<double> loads;
  for (const Press& press : presses_) loads.push_back(press.load);
  std::sort(loads.begin(), loads.end());
  loads.erase(std::unique(loads.begin(), loads.end()), loads.end());
  if (loads.size() < kLeastLoads) return;
  const auto errorOf = [&](double length, double ratio) {
    double squares = 0;
    for (const double load : loads) {
      std::vector<Press> others;
      std::copy_if(presses_.begin(), presses_.end(), std::back_inserter(others), [&](const Press& press) { return press.load != load; });
      const double expected = meanAt(others, length, ratio, load);
      for (const Press& press : presses_) squares += press.load == load ? std::pow(press.log_gain - expected, 2) : 0;
    }
    return squares;
  };
  double least = errorOf(1, 0);
  for (const double part : kLengths) {
    for (const double ratio : kRatios) {
      const double length = part * std::log(loads.back() / loads.front()), error = errorOf(length, ratio);
      if (error < least) least = error, length_ = length, ratio_ = ratio;
    }
  }
}

double LoadDeviation::at(double load) const {
  const auto [low, high] =
      std::minmax_element(presses_.begin(), presses_.end(), [](const Press& a, const Press& b) { return a.load < b.load; });
  if (presses_.empty() || load < low->load || load > high->load) return 0;
  return meanAt(presses_, length_, ratio_, load);
}

}  // namespace taxelsim
