// Sensors of several patches on the two-parameter foundation of foundation_law.h, and their frames.
#pragma once

#include <vector>

#include "simulation/comparison.h"
#include "simulation/foundation_law.h"
#include "support/curved_sensor.h"

namespace taxelsim {

// `iterations`: sweeps; 0: the default of the law.
inline Sensor onFoundation(Sensor sensor, int samples_per_taxel, int iterations = 0) {
  sensor.skin = {.thickness = 2e-3, .law = Pasternak{kStiffness, kStiffness * kDecay * kDecay, iterations}};
  sensor.samples_per_taxel = samples_per_taxel;
  return sensor;
}

// Three grids side by side, the last one turned down along the seam, with a gap between the first two.
inline Sensor threeGrids(int iterations = 0) {
  Sensor sensor = onFoundation(support::gridSensor({.num_rows = 2, .num_cols = 3, .pitch_x = 2e-3, .pitch_y = 2.4e-3}), 3, iterations);
  GridPatch patch = sensor.patches[0];
  patch.X_SP.position = {0, 7.5e-3, 0};
  sensor.patches.push_back(patch);
  patch.num_rows = 3;
  patch.pitch = {1.6e-3, 2.4e-3};
  patch.X_SP = {{4.2e-3, 0, -0.4e-3}, axisAngle({0, 1, 0}, 0.2)};
  sensor.patches.push_back(patch);
  return sensor;
}

// The next frame.
inline FrameView step(Simulator& simulator, const std::vector<support::Touch>& touches) {
  constexpr double kStep = 1e-3;  // s
  support::setTouches(simulator, touches);
  simulator.step(kStep);
  return simulator.read();
}

}  // namespace taxelsim
