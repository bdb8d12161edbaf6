// Tactile servoing on an edge, for a batch of sensors at once: measured features in, twists of the sensor frames out. Keeps no state and
// allocates nothing; moving the sensors is twist.h.
//
//        y of S            The object is fixed, the sensor moves. With e = edge angle - target, c the centre of pressure, u the
//          |   / u         edge's direction and n across it:
//          |  /              w_z = angle_gain e                        (the edge's angle in S falls by w_z)
//     c *--|-/ e             v   = -w x c                              (turn about the contact, so that it does not slide away)
//          |/___ target          + centre_gain ((c - middle) . n) n    (a point fixed in the world moves by -v in S)
//          +------ x             + exploration_velocity u
//                                + z force_gain (F_target - F) / stiffness
#pragma once

#include <cstdint>
#include <span>

#include "control/twist.h"
#include "taxelsim/control.h"
#include "taxelsim/sensor.h"

namespace taxelsim {

// Features of N instances, all in S. `due` marks the instances whose control tick it is; the others keep their twists.
struct EdgeServoInput {
  std::span<const float> edge_angle;          // (N), rad; of the major axis, so known up to pi
  std::span<const float> edge_confidence;     // (N), 0 to 1
  std::span<const float> total_force;         // (N), N
  std::span<const float> center_of_pressure;  // (N x 3), m
  std::span<const float> contact_area;        // (N), m^2
  std::span<const float> target_force;        // (N), N
  std::span<const std::uint8_t> due;          // (N)
};

class EdgeServoController {
 public:
  // Throws Error(kInput) for a gain or limit out of its range.
  EdgeServoController(const EdgeServo& servo, const Sensor& sensor);

  // twists (N), of the sensor frame in S: v in m/s, w in rad/s. All spans must have the same N.
  void command(const EdgeServoInput& input, std::span<Twist> twists) const;

  // dF/dz (N/m) of a contact that carries `force` (N) on `area` (m^2): the skin's stiffness at the mean pressure, times the area.
  // Never less than one taxel in contact has, so that a vanishing contact does not command a leap.
  double contactStiffness(double force, double area) const;

 private:
  Twist commandOne(double angle, double confidence, double force, const float* center, double area, double target_force) const;

  EdgeServo servo_;
  double stiffness_;  // Pa / m^exponent
  double exponent_;
  double taxel_area_;  // m^2, of the smallest taxel
  double middle_[2];   // m, in S: mean of all taxel centres
};

}  // namespace taxelsim
