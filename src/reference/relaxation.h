// Stress relaxation of the skin: linear viscoelasticity by the hereditary integral over the full loading history.
//
//   p(t) = int g(t - u) dP(u),   g(t) = 1 - sum fraction (1 - exp(-t / time))   (Prony series)
//
// R. M. Christensen, Theory of Viscoelasticity, 2nd ed., Academic Press 1982, section 1.2. P, the pressure that the same indentation would
// cause instantaneously, serves as the strain measure (Pa). It jumps in the first step and is linear in time over each later step. A sample
// without contact recovers freely: its strain is the one at which p = 0. The reference stores the whole history; the device keeps one
// internal variable per Prony term.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "taxelsim/sensor.h"

namespace taxelsim::reference {

// Response of the samples at the end of a step: p = held_pressure + gain * (strain_after - strain). Default-constructed: skin never loaded.
struct SkinStep {
  std::vector<double> strain;         // (num_samples), Pa, before the step; empty for a skin never loaded
  std::vector<double> held_pressure;  // (num_samples), Pa: pressure at the end of the step if the strain does not change
  double gain = 1;                    // Pa of pressure per Pa of strain added in the step
  std::vector<double> compliance;     // (num_samples), m/Pa: LayerContact::dent_compliance before the step; of an elastic layer's cells

  struct Pressed {
    double pressure;  // Pa, >= 0
    double strain;    // Pa
  };
  // Strain (Pa) to which a sample recovers without contact.
  double recoveredStrain(std::size_t sample) const;
  // Result for a sample pressed to the strain `elastic` (Pa); 0 means no contact.
  Pressed press(std::size_t sample, double elastic) const;
};

// Strain history of all samples.
class SkinHistory {
 public:
  explicit SkinHistory(std::span<const RelaxationTerm> terms) : terms_(terms.begin(), terms.end()) {}

  // The response of a step of dt (s, > 0) that follows the history.
  SkinStep step(double dt) const;
  // Appends a step of dt (s, > 0) that ended at `strain` (num_samples), Pa, and for an elastic layer's cells at `compliance` (num_samples),
  // m/Pa.
  void advance(double dt, std::span<const double> strain, std::span<const double> compliance = {});

 private:
  // Mean of g over ages from `age` to `age + span` (s).
  double meanKernel(double age, double span) const;

  std::vector<RelaxationTerm> terms_;
  std::vector<double> dt_;                   // s, of each step
  std::vector<std::vector<double>> strain_;  // (num_steps x num_samples), Pa
  std::vector<double> compliance_;           // (num_samples), m/Pa, after the last step
};

}  // namespace taxelsim::reference
