// A sensor that passes every check. Tests change one field at a time.
#pragma once

#include "taxelsim/sensor.h"

namespace taxelsim {

inline Sensor exampleSensor() {
  Sensor sensor;
  sensor.name = "example";
  sensor.patches = {{.name = "pad", .num_rows = 6, .num_cols = 14, .pitch = {0.0034, 0.0034}, .X_SP = {}}};
  sensor.skin = {.thickness = 0.00145, .law = Winkler{.normal_contact_stiffness = 1.73e8, .normal_exponent = 1, .normal_damping = 0}};
  sensor.psf = gaussianPsf(0.5, 3);
  sensor.readout.curve = {2400};
  sensor.readout.trigger = 0.02;
  sensor.readout.noise = 3;
  sensor.frame_rate = 100;
  return sensor;
}

}  // namespace taxelsim
