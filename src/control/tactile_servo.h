// Tactile servoing for a batch of sensors at once: measured features in, twists of the sensor frames out. Allocates nothing after
// construction; moving the sensors is robots.h.
//
//        y of S            The object is fixed, the sensor moves. With s the rates that the PIDs ask for, c the centre of pressure, u the
//          |   / u         edge's direction and n across it, r the rolling radius of a centre that is held by turning:
//          |  /              w_z = -s_angle                            (the edge's angle in S falls by w_z)
//     c *--|-/ angle         w_x = -s_tilt_x + s_y / r, w_y = -s_tilt_y - s_x / r   (a face's tilt falls by w; the contact rolls by r w)
//          |/___             v   = -w x c                              (turn about the contact, so that it does not slide away)
//          +------ x         - (s_x, s_y) - s_across n               (of centres held by sliding: a fixed point moves by -v in S)
//                            + z s_force / stiffness of the contact
//                            + exploration_velocity u, turned by exploration_direction
//
// That is the inverse of a nominal tactile Jacobian. With a measured one J (features by v and w), the twist minimises |J t - s|^2 + damping
// over the motions that the features take: sliding for centres, or turning where they roll; z for the force; turning about z for the angle
// and about x and y for tilts. Exploration comes on top of either.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "taxelsim/control.h"
#include "taxelsim/pose.h"
#include "taxelsim/sensor.h"

namespace taxelsim {

// Features of N instances, all in S. `due` marks the instances whose control tick it is; the others keep their twists.
struct ServoInput {
  // (N x num_rows): the first row of each instance is of all that touches it, region_row of its largest region.
  int num_rows = 1;
  int region_row = 0;
  std::span<const float> edge_angle;          // rad; of the major axis, so known up to pi
  std::span<const float> edge_confidence;     // 0 to 1
  std::span<const float> total_force;         // N
  std::span<const float> center_of_pressure;  // (x 3), m
  std::span<const float> contact_area;        // m^2
  // The same; they may be empty where no servo looks at contact features.
  std::span<const float> windowed_edge_angle = {};       // rad
  std::span<const float> windowed_edge_confidence = {};  // 0 to 1
  std::span<const float> tilt = {};                      // (x 2), rad
  std::span<const float> tilt_confidence = {};           // 0 to 1
  // The first row of each instance's num_jacobian_rows, by v and w of S; they may be empty where no servo looks at the Jacobian.
  int num_jacobian_rows = 1;
  std::span<const float> center_jacobian = {};      // (x 3 x 6), m/m, m/rad
  std::span<const float> force_jacobian = {};       // (x 6), N/m, N/rad
  std::span<const float> edge_angle_jacobian = {};  // (x 6), rad/m, rad/rad: of the principal axis
  // (N). The exact angle is NaN where there is none, and may be empty where no servo looks at it.
  std::span<const float> exact_edge_angle = {};  // rad
  std::span<const float> start_force;            // N: reference of the force where the servo has none
  std::span<const std::uint8_t> due;
};

class TactileServoController {
 public:
  // `servos`: at least one. Throws Error(kInput) for a gain, reference or limit out of its range, and where nothing is selected.
  TactileServoController(std::span<const TactileServo> servos, const Sensor& sensor, int num_instances);
  TactileServoController(const TactileServo& servo, const Sensor& sensor, int num_instances)
      : TactileServoController(std::span(&servo, 1), sensor, num_instances) {}

  // Forgets what the instance's integrals and rates know of its past; from now on it has servo number `servo`, which explores at
  // exploration_velocity (m/s) instead of its own where given.
  void reset(int instance, int servo = 0, std::optional<double> exploration_velocity = {});
  double explorationVelocity(int instance) const { return memory_[static_cast<std::size_t>(instance)].exploration_velocity; }

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
    double angle, confidence, force, area, center[2], tilt[2], tilt_confidence, start_force;
    double edge[2];                                                  // the way along it, of length 1; 0 where the edge is not known
    const float *center_jacobian, *force_jacobian, *angle_jacobian;  // null where it is not looked at
  };
  // What a PID knows of an instance's past.
  struct Memory {
    Features integral{};  // of the errors, unit s
    Features error;       // of the tick before, NaN where there was none
    int servo = 0;
    double exploration_velocity = 0;
  };

  Felt feltBy(const TactileServo& servo, const ServoInput& input, std::size_t i) const;
  Features errorsOf(const TactileServo& servo, const Felt& felt) const;
  Twist nominalTwist(const TactileServo& servo, const Felt& felt, const Features& rate) const;
  Twist measuredTwist(const TactileServo& servo, const Felt& felt, const Features& rate) const;
  Twist exploration(const TactileServo& servo, const Felt& felt, double velocity) const;
  Twist commandOne(const TactileServo& servo, const Felt& felt, double dt, Memory& memory) const;

  std::vector<TactileServo> servos_;
  std::vector<Memory> memory_;  // (num_instances)
  double stiffness_;            // Pa / m^exponent
  double exponent_;
  double taxel_area_;  // m^2, of the smallest taxel
  Vector3 middle_;     // of the array
};

}  // namespace taxelsim
