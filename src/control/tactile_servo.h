// Tactile servoing for a batch of sensors at once: measured features in, twists of the sensor frames out. Allocates nothing after
// construction; moving the sensors is robots.h.
//
//        y of S            The object is fixed, the sensor moves. With s the rates that the PIDs ask for, c the centre of pressure, u the
//          |   / u         edge's direction and n across it:
//          |  /              w_z = -s_angle                            (the edge's angle in S falls by w_z)
//     c *--|-/ angle         v   = -w x c                              (turn about the contact, so that it does not slide away)
//          |/___             - (s_x, s_y) - s_across n               (a point fixed in the world moves by -v in S)
//          +------ x         + z s_force / stiffness of the contact
//                            + exploration_velocity u
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "taxelsim/control.h"
#include "taxelsim/pose.h"
#include "taxelsim/sensor.h"

namespace taxelsim {

// Features of N instances, all in S. `due` marks the instances whose control tick it is; the others keep their twists.
struct ServoInput {
  std::span<const float> edge_angle;          // (N), rad; of the major axis, so known up to pi
  std::span<const float> edge_confidence;     // (N), 0 to 1
  std::span<const float> total_force;         // (N), N
  std::span<const float> center_of_pressure;  // (N x 3), m
  std::span<const float> contact_area;        // (N), m^2
  std::span<const float> start_force;         // (N), N: reference of the force where the servo has none
  std::span<const std::uint8_t> due;          // (N)
};

class TactileServoController {
 public:
  // Throws Error(kInput) for a gain, reference or limit out of its range, and where nothing is selected.
  TactileServoController(const TactileServo& servo, const Sensor& sensor, int num_instances);

  // Forgets what the instance's integrals and rates know of its past.
  void reset(int instance);

  // Twists (N), of the sensor frame in S: v in m/s, w in rad/s. All spans must have the batch's N. `dt` (s, > 0): from tick to tick. An
  // instance whose features are not finite is held still and does not touch others. Without contact the sensor comes closer where a force
  // is to be held, and all loops rest.
  void command(const ServoInput& input, double dt, std::span<Twist> twists);

  // dF/dz (N/m) of a contact that carries `force` (N) on `area` (m^2): the skin's stiffness at the mean pressure, times the area.
  // Never less than one taxel in contact has, so that a vanishing contact does not command a leap.
  double contactStiffness(double force, double area) const;

 private:
  using Features = std::array<double, kNumServoFeatures>;

  // What one instance feels.
  struct Felt {
    double angle, confidence, force, area, center[2], start_force;
  };
  // What a PID knows of an instance's past.
  struct Memory {
    Features integral{};  // of the errors, unit s
    Features error;       // of the tick before, NaN where there was none
  };

  bool isSelected(ServoFeature feature) const { return servo_[feature].selected; }
  double forceReference(const Felt& felt) const;
  double directionOf(const Felt& felt) const;
  Features errorsOf(const Felt& felt) const;
  Features ratesOf(const Features& error, double dt, const Memory& before, Memory& after) const;
  Twist twistOf(const Felt& felt, const Features& rate) const;
  Twist commandOne(const Felt& felt, double dt, Memory& memory) const;

  TactileServo servo_;
  std::vector<Memory> memory_;  // (num_instances)
  double stiffness_;            // Pa / m^exponent
  double exponent_;
  double taxel_area_;  // m^2, of the smallest taxel
  double middle_[2];   // m, in S: mean of all taxel centres
};

}  // namespace taxelsim
