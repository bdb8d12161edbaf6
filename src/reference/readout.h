// Stage 5 of the reference: spread force -> counts, and back by the nominal curve.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "taxelsim/sensor.h"

namespace taxelsim::reference {

// How one instance differs from the nominal sensor; drawn outside (imperfections.h), so that stages have no random numbers of their own.
struct ReadoutDraw {
  std::vector<double> gain{};   // (num_taxels), factor on top of the sensor's taxel_gain; empty for 1
  std::vector<double> noise{};  // (num_taxels), counts, with bias and random walk; empty for 0
  std::vector<bool> dead{};     // (num_taxels): reads 0; empty for none
};

// Output before rounding and clipping, counts: output_scale sum curve[m] x^(m+1) + noise at x = gain F - trigger.
double analogueOutput(const Readout& readout, double force, double gain, double trigger, double noise);

// Smallest force that shows at one taxel, N, and its gain.
double triggerOf(const Readout& readout, std::size_t taxel);
double gainOf(const Readout& readout, std::size_t taxel);

// Counts from the spread force, (num_taxels). Halves round away from zero.
std::vector<std::uint32_t> readOut(const Sensor& sensor, std::span<const double> spread_force, const ReadoutDraw& draw = {});

// Newtons from counts by the nominal curve, (num_taxels).
std::vector<double> measuredForce(const Sensor& sensor, std::span<const std::uint32_t> counts);

// Fraction of taxels at the upper end.
double saturatedFraction(const Sensor& sensor, std::span<const std::uint32_t> counts);

}  // namespace taxelsim::reference
