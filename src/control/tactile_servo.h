// Tactile servo controller for a batch of sensors: tactile features in, commanded twists of the sensor frames out (Q. Li et al., "A control
// framework for tactile servoing", RSS 2013). robots.h moves the sensors.
//
// Each selected feature has a PID loop that outputs the rate s of the feature. An inverse tactile Jacobian maps the rates to the twist (v,
// w) of the sensor frame S. The object is assumed to be fixed in the world.
//
//        y of S            Inverse of the nominal Jacobian, with c: center of pressure, u: direction of the edge, n: normal to the edge,
//          |   / u         r: rolling radius:
//          |  /
//     c *--|-/ angle         w_z = -s_angle                                     (the edge's angle in S falls by w_z)
//          |/___             w_x = -s_tilt_x + s_y / r                          (a face's tilt falls by w; a rolling contact moves by r w)
//          +------ x         w_y = -s_tilt_y - s_x / r
//                            v   = -w x c                                       (rotate about the contact, which stays in place)
//                                  - (s_x, s_y) - s_across n                    (centers controlled by translation)
//                                  + z s_force / stiffness of the contact
//                                  + exploration_velocity (u rotated by exploration_direction)
//
// With the measured Jacobian J of the frame, the twist minimises |J t - s|^2 + damping over the motions that the selected features are
// controlled by: translation (or rotation, if rolling) for centers, z for the force, rotation about z for the angle and about x and y for
// tilts. The exploration velocity is added to either.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "taxelsim/control.h"
#include "taxelsim/features.h"
#include "taxelsim/pose.h"
#include "taxelsim/sensor.h"

namespace taxelsim {

// Features of N instances, all in S.
struct ServoInput {
  // (N x num_rows): row `whole_row` of each instance describes the whole contact, row `region_row` its largest region.
  int num_rows = 1;
  int whole_row = 0;
  int region_row = 0;
  // Image features; contact features may be empty if no servo needs them (needsContactFeatures()). Its own num_rows is not read.
  ContactFeatureView features{};
  // Row `jacobian_row` of each instance's num_jacobian_rows is used. May be empty if no servo needs it (needsTactileJacobian()).
  int num_jacobian_rows = 1;
  int jacobian_row = 0;
  TactileJacobianView jacobian{};
  std::span<const float> exact_edge_angle = {};  // (N), rad, NaN if the object has no edge; may be empty if no servo uses it
  std::span<const float> start_force;            // (N), N: reference of the force for servos without one
  std::span<const std::uint8_t> due;             // (N): instances with a control tick now; the others keep their twists
};

class TactileServoController {
 public:
  // `servos`: at least one; all instances start with the first. Throws Error(kInput) like checkServo().
  TactileServoController(std::span<const TactileServo> servos, const Sensor& sensor, int num_instances);
  TactileServoController(const TactileServo& servo, const Sensor& sensor, int num_instances)
      : TactileServoController(std::span(&servo, 1), sensor, num_instances) {}

  // Resets the integrals and derivatives of an instance and assigns it servos[servo]. `exploration_velocity` (m/s) replaces that of the
  // servo, if given.
  void reset(int instance, int servo = 0, std::optional<double> exploration_velocity = {});
  double explorationVelocity(int instance) const { return pid_states_[static_cast<std::size_t>(instance)].exploration_velocity; }

  // Writes twists[i] (N) of the instances that are due: v in m/s, w in rad/s, of S in S. `dt` (s, > 0): control period. An instance with
  // features that are not finite gets a zero twist; others are not affected. Without contact the sensor approaches along z if the force is
  // controlled with a positive reference, and the other loops are inactive.
  void command(const ServoInput& input, double dt, std::span<Twist> twists) {
    command(input, dt, twists, 0, static_cast<int>(twists.size()));
  }
  // The same for the instances from `first` to before `last`. Several threads may command parts that do not overlap.
  void command(const ServoInput& input, double dt, std::span<Twist> twists, int first, int last);

  // Stiffness dF/dz (N/m) of a contact with `force` (N) on `area` (m^2): the skin's stiffness per area at the mean pressure, times the
  // area. The area is at least that of one taxel, which limits the velocity commanded for a vanishing contact.
  double contactStiffness(double force, double area) const;

 private:
  using Features = std::array<double, kNumServoFeatures>;

  // A servo, and what follows from its settings.
  struct PreparedServo : TactileServo {
    explicit PreparedServo(const TactileServo& servo);
    std::array<double, 2> exploration;  // cosine and sine of exploration_direction
  };

  // Features of one instance.
  struct ContactState {
    double angle, confidence, force, area, center[2], tilt[2], tilt_confidence, start_force;
    double edge[2];                                                  // unit vector along the edge; 0 if the edge is not known
    const float *center_jacobian, *force_jacobian, *angle_jacobian;  // null if not used
  };
  struct PidState {
    Features integral{};  // of the error, in unit of the feature times s
    Features error;       // of the previous tick, NaN if undefined
    int servo = 0;
    double exploration_velocity = 0;
  };

  ContactState contactState(const TactileServo& servo, const ServoInput& input, std::size_t i) const;
  Features featureErrors(const TactileServo& servo, const ContactState& contact) const;
  Twist nominalTwist(const TactileServo& servo, const ContactState& contact, const Features& rate) const;
  Twist measuredTwist(const TactileServo& servo, const ContactState& contact, const Features& rate) const;
  Twist explorationTwist(const PreparedServo& servo, const ContactState& contact, double velocity) const;
  Twist commandInstance(const PreparedServo& servo, const ContactState& contact, double dt, PidState& pid) const;

  std::vector<PreparedServo> servos_;
  std::vector<PidState> pid_states_;  // (num_instances)
  double stiffness_;                  // Pa / m^exponent
  double exponent_;
  double taxel_area_;     // m^2, smallest pitch area of a taxel
  Vector3 array_center_;  // m, in S
};

}  // namespace taxelsim
