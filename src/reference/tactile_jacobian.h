// How features change with the sensor's twist, of the reference: from the depths of one frame, by the balance of force over each taxel.
//
// An object whose points move with u = v + w x p takes its surface z = -d(x, y) along, so that the pressure f(d) at a place of the skin
// obeys
//   df/dt = -div J - f' u_z,   J = (f v_x - G w_y - f y w_z,  f v_y + G w_x + f x w_z),   u_z = v_z + y w_x - x w_y,
// with f' = df/dd and G = d f - (integral of f from 0 to d): the horizontal part of u at the depth d, times f, less what w does to f by
// moving it up or down. Over a taxel div J is what flows through its sides, where f is the mean of the samples on both sides, at the rim of
// a patch what goes on as a straight line from inside. Of an elastic layer d changes by the same d_t = -u_z - u_x d_x - u_y d_y, with
// slopes from the neighbours at hand, and pressures as its own equations say.
#pragma once

#include <array>
#include <vector>

#include "reference/frame.h"

namespace taxelsim::reference {

// By the velocity v of S's origin (m), then by the angular velocity w (rad), of the sensor, in S; objects stay.
using ByTwist = std::array<double, 6>;

struct FeatureJacobian {
  double total_force = 0;      // N: of the row's own image
  Vector3 center{0, 0, 0};     // m, in S: its centre of pressure
  double edge_confidence = 0;  // of it
  double trace = 0;            // m^2: sum of its second moments
  std::array<ByTwist, 3> center_of_pressure{};
  ByTwist total_force_by_twist{};
  ByTwist edge_angle{};
};

struct TactileJacobian {
  std::vector<ByTwist> taxel_force;   // (num_taxels): of contact, in N
  std::vector<ByTwist> spread_force;  // (num_taxels)
  std::array<ByTwist, 6> contact_wrench{};
  FeatureJacobian clean, measured;                               // of the sensor
  std::vector<FeatureJacobian> clean_patches, measured_patches;  // of a list of taxels none
};

// Of a frame that simulateFrame() has made, for a sensor at rest. Measured are what the readout makes of the clean forces without noise,
// lag or rounding.
TactileJacobian tactileJacobian(const Sensor& sensor, const Frame& frame, const ReadoutDraw& draw = {});

}  // namespace taxelsim::reference
