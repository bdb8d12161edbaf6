// Stages 1 and 2 of the reference for contact points from an external physics engine: each point is assigned to one taxel, Kappassov,
// Corrales and Perdereau, AIM 2020, eq. (2). The assignment rule is that of include/taxelsim/contact_point.h.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "taxelsim/contact_point.h"
#include "taxelsim/sensor.h"

namespace taxelsim::reference {

struct ContactSums {
  std::vector<double> taxel_force;  // (num_taxels), N
  std::array<double, 6> wrench{};   // force (N) and torque (N m) on the sensor at the origin of S, in S
  double total_force = 0;           // N: sum over the taxels
  double off_array_load = 0;        // N: contacts on no taxel, which are excluded from all other sums
  int off_array_contacts = 0;
};

// contact_band: see SimulatorOptions, m.
ContactSums sumContacts(const Sensor& sensor, std::span<const ContactPoint> contacts, double contact_band);

// Taxel of a contact point at p_SQ_S (m); empty if it is off the array.
std::optional<int> taxelAt(const Sensor& sensor, const Vector3& p_SQ_S, double contact_band);

}  // namespace taxelsim::reference
