// Input of the tactile servo from the public view of a batch.
#pragma once

#include "control/tactile_servo.h"
#include "taxelsim/environment.h"

namespace taxelsim {

// For servos that read neither contact features nor the tactile Jacobian. Spans into `view`.
inline ServoInput servoInputOf(const EnvironmentView& view) {
  return {.num_rows = static_cast<int>(view.X_WS.size() / view.active.size()),
          .edge_angle = view.frame.edge_angle,
          .edge_confidence = view.frame.edge_confidence,
          .total_force = view.frame.total_force,
          .center_of_pressure = view.frame.center_of_pressure,
          .contact_area = view.frame.contact_area,
          .start_force = view.start_force,
          .due = view.control_due};
}

}  // namespace taxelsim
