#include "reference/relaxation.h"

#include <algorithm>
#include <cmath>

namespace taxelsim::reference {

double SkinStep::recoveredStrain(std::size_t sample) const {
  return strain.empty() ? 0 : std::max(0.0, strain[sample] - held_pressure[sample] / gain);
}

SkinStep::Pressed SkinStep::press(std::size_t sample, double elastic) const {
  const double recovered = recoveredStrain(sample);
  return elastic > recovered ? Pressed{gain * (elastic - recovered), elastic} : Pressed{0, recovered};
}

double SkinHistory::meanKernel(double age, double span) const {
  double mean = 1;
  for (const RelaxationTerm& term : terms_) {
    const double x = span / term.time;
    mean += term.fraction * (std::exp(-age / term.time) * (x > 0 ? -std::expm1(-x) / x : 1) - 1);
  }
  return mean;
}

SkinStep SkinHistory::step(double dt) const {
  SkinStep step;
  if (strain_.empty()) return step;
  step.strain = strain_.back();
  step.compliance = compliance_;
  step.held_pressure.assign(step.strain.size(), 0);
  step.gain = meanKernel(0, dt);
  double age = dt;
  for (std::size_t k = strain_.size(); k-- > 0;) {
    const double weight = meanKernel(age, k > 0 ? dt_[k] : 0);
    for (std::size_t n = 0; n < step.held_pressure.size(); ++n)
      step.held_pressure[n] += weight * (strain_[k][n] - (k > 0 ? strain_[k - 1][n] : 0));
    age += dt_[k];
  }
  return step;
}

void SkinHistory::advance(double dt, std::span<const double> strain, std::span<const double> compliance) {
  dt_.push_back(dt);
  strain_.emplace_back(strain.begin(), strain.end());
  compliance_.assign(compliance.begin(), compliance.end());
}

}  // namespace taxelsim::reference
