// A simulated bench: a sensor with known parameters and noisy readings by the formulas, independent of the simulator's code.
#pragma once

#include "support/test.h"
#include "taxelsim/measurement.h"

namespace taxelsim::testing {

inline Measurement measurementOf(std::string name, Sensor sensor, decltype(Measurement::data) data) {
  return {.file = name + ".yaml", .name = std::move(name), .sensor = std::move(sensor), .resolved_sensor = {}, .data = std::move(data)};
}

// A grid without spread, counts = clip(round(slope F), 0, 4095).
inline Sensor benchSensor(int num_rows, int num_cols) {
  Sensor sensor;
  sensor.name = "bench";
  sensor.patches = {{.name = "pad", .num_rows = num_rows, .num_cols = num_cols, .pitch = {3.4e-3, 3.4e-3}, .X_SP = {}}};
  sensor.skin.thickness = 2e-3;
  sensor.skin.law = Winkler{.normal_contact_stiffness = 1e8};
  sensor.readout.curve = {1000};
  return sensor;
}

struct TrueTaxel {
  double slope;    // counts/N
  double trigger;  // N
};

// One reading of a taxel that saturates at `top` counts.
inline double reading(const TrueTaxel& taxel, double force, double noise, double top, std::mt19937& random) {
  const double counts = taxel.slope * (force - taxel.trigger) + std::normal_distribution<double>(0, 1)(random) * noise;
  return std::clamp(std::round(counts), 0.0, top);
}

// Smallest number of hits of 95 % intervals in `runs`: four standard deviations of the binomial distribution, probability 1 in 30,000.
inline double leastHits(double runs) {
  return 0.95 * runs - 4 * std::sqrt(runs * 0.95 * 0.05);
}

}  // namespace taxelsim::testing
