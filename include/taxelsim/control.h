// Gains and limits of the controllers that move a sensor by what it feels. Not the controllers: those belong to the scheduler.
#pragma once

namespace taxelsim {

// Edge-orientation and force control of a free-flying sensor (paper section IV, with a force loop and exploration along the edge).
struct EdgeServo {
  double angle_gain = 0.8;            // 1/s, >= 0: turning speed per edge-angle error; 0.78 is the paper's 5 s
  double force_gain = 2;              // 1/s, >= 0: of the force error, through the skin's stiffness over the measured contact area
  double centre_gain = 1;             // 1/s, >= 0: keeps the centre of pressure at the array's middle, across the edge
  double target_angle = 0;            // rad, in (-pi/2, pi/2]
  double exploration_velocity = 0;    // m/s, along the edge
  double max_angular_velocity = 1;    // rad/s, > 0
  double max_linear_velocity = 0.02;  // m/s, > 0
  double min_confidence = 0.2;        // 0 to 1: below it the edge angle is left alone
};

}  // namespace taxelsim
