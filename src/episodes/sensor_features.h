// What a tactile servo reads from the frames of a batch.
#pragma once

#include "control/tactile_servo.h"
#include "taxelsim/simulator.h"

namespace taxelsim {

// Features of one of the num_sensors sensors that each instance has in `frame`, as views of it. contact_features: whether the servos need
// the contact features (needsContactFeatures()). The caller adds exact_edge_angle, start_force and due.
ServoInput featuresOfSensor(const FrameView& frame, int num_sensors, int sensor, bool contact_features);

}  // namespace taxelsim
