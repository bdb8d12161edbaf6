// Input of the tactile servo from the public view of a batch.
#pragma once

#include "control/tactile_servo.h"
#include "taxelsim/environment.h"

namespace taxelsim {

// For servos that read neither contact features nor the tactile Jacobian. Spans into `view`.
inline ServoInput servoInputOf(const EnvironmentView& view) {
  ServoInput input{
      .num_rows = static_cast<int>(view.X_WS.size() / view.active.size()), .start_force = view.start_force, .due = view.control_due};
  static_cast<FeatureView&>(input.features) = view.frame;
  return input;
}

}  // namespace taxelsim
