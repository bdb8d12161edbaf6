#include "reference/lag.h"

#include <algorithm>
#include <cmath>

namespace taxelsim::reference {

Lag::Lag(const Readout& readout, std::size_t num_taxels)
    : readout_(readout),
      play_(readout.hysteresis_strength.size(), std::vector<double>(num_taxels, 0.0)),
      creep_(readout.creep.size(), std::vector<double>(num_taxels, 0.0)),
      low_pass_(num_taxels, 0.0) {}

double Lag::filter(double x, std::size_t taxel, double dt) {
  double y = x;
  for (std::size_t e = 0; e < play_.size(); ++e) {
    double& play = play_[e][taxel];
    const double width = readout_.hysteresis_width[e];
    play = std::clamp(play, x - width, x + width);
    y += readout_.hysteresis_strength[e] * (play - x);
  }
  const double input = y;
  for (std::size_t m = 0; m < creep_.size(); ++m) {
    double& state = creep_[m][taxel];
    state = input + (state - input) * std::exp(-dt / readout_.creep[m].time);
    y += readout_.creep[m].fraction * state;
  }
  if (readout_.low_pass_time > 0) y = low_pass_[taxel] = y + (low_pass_[taxel] - y) * std::exp(-dt / readout_.low_pass_time);
  return y;
}

std::vector<double> Lag::step(std::span<const double> spread_force, double dt) {
  std::vector<double> force;
  for (std::size_t t = 0; t < spread_force.size(); ++t) force.push_back(filter(spread_force[t], t, dt));
  past_.push_front({dt, force});
  constexpr double kRounding = 1e-9;  // relative: a delay of a whole number of steps must not round up to one more
  double age = 0;
  for (const PastStep& past : past_) {
    if (age >= readout_.delay * (1 - kRounding)) return past.force;
    age += past.length;
  }
  return std::vector<double>(spread_force.size(), 0.0);
}

}  // namespace taxelsim::reference
