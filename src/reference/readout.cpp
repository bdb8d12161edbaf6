#include "reference/readout.h"

#include <algorithm>
#include <cmath>

#include "sensor/curve.h"

namespace taxelsim::reference {

namespace {

// Piecewise linear through (0, 0) and the points, extrapolated linearly.
double interpolate(std::span<const CurvePoint> points, double x) {
  CurvePoint from, to = points.front();
  for (std::size_t k = 1; k < points.size() && x > to.force; ++k) {
    from = to;
    to = points[k];
  }
  return from.counts + (x - from.force) / (to.force - from.force) * (to.counts - from.counts);
}

}  // namespace

double triggerOf(const Readout& readout, std::size_t taxel) {
  return readout.taxel_trigger.empty() ? readout.trigger : readout.taxel_trigger[taxel];
}

double gainOf(const Readout& readout, std::size_t taxel) {
  return readout.taxel_gain.empty() ? 1 : readout.taxel_gain[taxel];
}

double analogueOutput(const Readout& readout, double force, double gain, double trigger, double noise) {
  const double x = gain * force - trigger;
  double value = 0;
  if (!readout.curve_points.empty()) {
    value = interpolate(readout.curve_points, x);
  } else if (x < 0) {
    value = readout.curve[0] * x;
  } else {
    const double held = std::min(x, curveTop(readout.curve, withoutLimit(readout.saturation / readout.output_scale, readout.curve_limit)));
    double power = held;
    for (const double coefficient : readout.curve) {
      value += coefficient * power;
      power *= held;
    }
    if (readout.curve_limit > 0) value = value * readout.curve_limit / (readout.curve_limit + value);
  }
  return readout.output_scale * value + noise;
}

std::vector<std::uint32_t> readOut(const Sensor& sensor, std::span<const double> spread_force, const ReadoutDraw& draw) {
  const Readout& readout = sensor.readout;
  std::vector<std::uint32_t> counts;
  for (std::size_t t = 0; t < spread_force.size(); ++t) {
    const double gain = gainOf(readout, t) * (draw.gain.empty() ? 1 : draw.gain[t]);
    const double noise = draw.noise.empty() ? 0 : draw.noise[t];
    const double value = std::round(analogueOutput(readout, spread_force[t], gain, triggerOf(readout, t), noise));
    const bool dead = !draw.dead.empty() && draw.dead[t];
    counts.push_back(dead ? 0 : static_cast<std::uint32_t>(std::clamp(value, 0.0, static_cast<double>(readout.saturation))));
  }
  return counts;
}

std::vector<double> measuredForce(const Sensor& sensor, std::span<const std::uint32_t> counts) {
  std::vector<double> force;
  for (const std::uint32_t value : counts) {
    force.push_back(nominalForce(sensor.readout, value));
  }
  return force;
}

double saturatedFraction(const Sensor& sensor, std::span<const std::uint32_t> counts) {
  const auto num_saturated = std::count(counts.begin(), counts.end(), static_cast<std::uint32_t>(sensor.readout.saturation));
  return static_cast<double>(num_saturated) / static_cast<double>(counts.size());
}

}  // namespace taxelsim::reference
