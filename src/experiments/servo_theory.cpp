#include "experiments/servo_theory.h"
#include "base/constants.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace taxelsim {
namespace {}  // namespace

std::vector<double> expectedErrors(const AngleLoop& loop, int num_frames, const std::function<double(double)>& read) {
  // Errors of an ideal joint; the real joint follows `delay` frames later.
  std::vector<double> commanded{loop.start_error};
  std::vector<double> errors;
  double rate = 0;
  for (int n = 0; n < num_frames; ++n) {
    errors.push_back(commanded[static_cast<std::size_t>(std::max(0, n - loop.delay))]);
    if (n % loop.period == 0) rate = loop.gain * read(errors.back());
    commanded.push_back(commanded.back() - rate * loop.dt);
  }
  return errors;
}

double closedFormSettlingTime(const AngleLoop& loop, double band) {
  const double step = loop.dt * loop.period, gain = loop.gain * step;
  double z = kNaN;
  if (loop.delay == 0) z = 1 - gain;
  if (loop.delay == loop.period) z = (1 + std::sqrt(1 - 4 * gain)) / 2;
  return z > 0 && z < 1 ? step * std::log(band) / std::log(z) : kNaN;
}

double closedFormGrowth(double gain, bool late) {
  if (!late) return std::abs(1 - gain);
  const double discriminant = 1 - 4 * gain;
  return discriminant > 0 ? (1 + std::sqrt(discriminant)) / 2 : std::sqrt(gain);
}

double measuredGrowth(const std::vector<double>& errors) {
  const std::size_t third = errors.size() / 3;
  if (third == 0) return kNaN;
  double first = 0, last = 0;
  for (std::size_t n = 0; n < third; ++n) {
    first += errors[n] * errors[n];
    last += errors[errors.size() - 1 - n] * errors[errors.size() - 1 - n];
  }
  return std::pow(last / first, 0.5 / static_cast<double>(errors.size() - third));
}

double settlingTime(const std::vector<double>& errors, double dt, double band) {
  if (errors.empty()) return kNaN;
  const double limit = band * std::abs(errors.front());
  std::size_t outside = errors.size();  // last error outside the band
  for (std::size_t n = errors.size(); n > 0 && outside == errors.size(); --n) {
    if (!(std::abs(errors[n - 1]) <= limit)) outside = n - 1;
  }
  if (outside == errors.size()) return 0;
  if (outside + 1 == errors.size() || !(limit > 0)) return kNaN;
  const double before = errors[outside], after = errors[outside + 1];
  const bool decays = before * after > 0;
  const double part =
      decays ? std::log(std::abs(before) / limit) / std::log(before / after) : (std::abs(before) - limit) / std::abs(before - after);
  return (static_cast<double>(outside) + part) * dt;
}

}  // namespace taxelsim
