// Relaxation of the reference: what every sample of the skin has been through, and the pressure that this leaves of a press.
//
// The hereditary integral p(t) = int g(t - u) dP(u), g(t) = 1 - sum fraction (1 - e^(-t / time)), over the skin's whole past (R. M.
// Christensen, Theory of Viscoelasticity, 2nd ed., Academic Press 1982, section 1.2). P, the pressure of an instantaneous press, measures
// the strain; it jumps in the first step and runs straight through each later one. Skin that an object leaves behind is free: the strain at
// which p = 0.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "taxelsim/sensor.h"

namespace taxelsim::reference {

// The skin at the end of a step, whatever is going to press it.
struct SkinStep {
  std::vector<double> strain;  // (samples), Pa, before the step; empty for skin that was never pressed
  std::vector<double> held;    // (samples), Pa: pressure at the end if the strain stays
  double gain = 1;             // Pa of pressure per Pa of strain that the step adds

  struct Pressed {
    double pressure;  // Pa, >= 0
    double strain;    // Pa
  };
  // Strain (Pa) to which a sample recovers that nothing presses.
  double recovered(std::size_t sample) const;
  // A sample that an object presses to the strain `elastic` (Pa), or not at all (0).
  Pressed press(std::size_t sample, double elastic) const;
};

class SkinHistory {
 public:
  explicit SkinHistory(std::span<const RelaxationTerm> terms) : terms_(terms.begin(), terms.end()) {}

  // What a step of dt (s, > 0) begins with.
  SkinStep step(double dt) const;
  // A step of dt has brought the samples to `strain` (Pa).
  void advance(double dt, std::span<const double> strain);

 private:
  // Mean of g over the ages from `age` to `age + span`.
  double meanKernel(double age, double span) const;

  std::vector<RelaxationTerm> terms_;
  std::vector<double> dt_;                   // s, of each step
  std::vector<std::vector<double>> strain_;  // (steps x samples), Pa
};

}  // namespace taxelsim::reference
