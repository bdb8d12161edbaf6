// Stage 4 of the reference: what the readout of one instance makes of forces over time. Keeps what lasts from step to step.
//
//   spread force -> hysteresis -> creep -> low-pass -> delay -> force that a frame shows
#pragma once

#include <cstddef>
#include <deque>
#include <span>
#include <vector>

#include "taxelsim/sensor.h"

namespace taxelsim::reference {

class Lag {
 public:
  // Of a sensor that was never loaded.
  Lag(const Readout& readout, std::size_t num_taxels);

  // Advances by dt (s, > 0) with `spread_force` ((num_taxels), N) held over it. Returns the force that a frame shows then, (num_taxels), N.
  std::vector<double> step(std::span<const double> spread_force, double dt);

 private:
  double advanced(double x, std::size_t taxel, double dt);

  struct Past {
    double length;              // s, of the step
    std::vector<double> force;  // (num_taxels), N, at its end
  };

  Readout readout_;
  std::vector<std::vector<double>> play_;   // (elements x num_taxels), N
  std::vector<std::vector<double>> creep_;  // (terms x num_taxels), N
  std::vector<double> low_pass_;            // (num_taxels), N
  std::deque<Past> past_;                   // newest first
};

}  // namespace taxelsim::reference
