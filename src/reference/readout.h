// Stage 5 of the reference, readout: spread force -> counts of the analogue-to-digital converter, and back by the nominal curve.
//
//   counts = clip(round(output_scale * curve(gain F - trigger) + noise), 0, saturation)
//
// Kappassov, Corrales and Perdereau, AIM 2020, sections II.B and III.B. Below the trigger the curve continues with its initial slope, so
// that noise can lift a force just below the trigger above zero.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "taxelsim/sensor.h"

namespace taxelsim::reference {

// Deviation of one instance from the nominal sensor, drawn by imperfections.h.
struct ReadoutDraw {
  std::vector<double> gain{};   // (num_taxels), multiplies the sensor's taxel_gain; empty for 1
  std::vector<double> noise{};  // (num_taxels), counts: noise, bias and random walk; empty for 0
  std::vector<bool> dead{};     // (num_taxels): dead taxels read 0; empty for none
};

// Output (counts) before rounding and clipping. force and trigger in N, noise in counts.
double analogueOutput(const Readout& readout, double force, double gain, double trigger, double noise);

// Trigger (N) and gain of a taxel: its own value, or the sensor's where there are none per taxel.
double triggerOf(const Readout& readout, std::size_t taxel);
double gainOf(const Readout& readout, std::size_t taxel);

// Counts from the spread force (N), both (num_taxels). Halves round away from zero.
std::vector<std::uint32_t> readOut(const Sensor& sensor, std::span<const double> spread_force, const ReadoutDraw& draw = {});

// Force (N) from counts by the inverse of the nominal curve, both (num_taxels).
std::vector<double> measuredForce(const Sensor& sensor, std::span<const std::uint32_t> counts);

// Fraction of taxels at saturation, 0 to 1.
double saturatedFraction(const Sensor& sensor, std::span<const std::uint32_t> counts);

}  // namespace taxelsim::reference
