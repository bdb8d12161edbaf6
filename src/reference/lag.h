// Stage 4 of the reference, time: dynamics of the readout at the taxel, one instance.
//
//   spread force -> hysteresis -> creep -> low-pass -> delay -> force shown by the frame
//
//   hysteresis  sum of play operators (Prandtl-Ishlinskii): y = x + sum strength (play - x), play = clamp(play, x - width, x + width).
//               M. A. Krasnosel'skii and A. V. Pokrovskii, Systems with Hysteresis, Springer 1989. Rate-independent.
//   creep       y += fraction * (first-order lag of the input with `time`), one term per entry of Readout::creep
//   low-pass    first-order lag with low_pass_time
//   delay       the newest stored force that is at least `delay` old
//
// First-order lags are integrated exactly for an input held over the step.
#pragma once

#include <cstddef>
#include <deque>
#include <span>
#include <vector>

#include "taxelsim/sensor.h"

namespace taxelsim::reference {

class Lag {
 public:
  // State of a sensor that was never loaded.
  Lag(const Readout& readout, std::size_t num_taxels);

  // Advances by dt (s, > 0) with `spread_force`, (num_taxels), N, held over the step. Returns the force at the end, (num_taxels), N; zero
  // until the delay has passed.
  std::vector<double> step(std::span<const double> spread_force, double dt);

 private:
  double filter(double x, std::size_t taxel, double dt);

  struct PastStep {
    double length;              // s
    std::vector<double> force;  // (num_taxels), N, at its end
  };

  Readout readout_;
  std::vector<std::vector<double>> play_;   // (num_elements x num_taxels), N
  std::vector<std::vector<double>> creep_;  // (num_terms x num_taxels), N
  std::vector<double> low_pass_;            // (num_taxels), N
  std::deque<PastStep> past_;               // newest first
};

}  // namespace taxelsim::reference
