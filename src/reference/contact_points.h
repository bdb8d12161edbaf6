// Stages 1 and 2 of the reference where another engine has found contacts and forces: each contact to one taxel, paper eq. (2).
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
  std::array<double, 6> wrench{};   // force (N) and torque (N m) on the sensor at S's origin, in S
  double total_force = 0;           // N: sum over the taxels
  double off_array_load = 0;        // N: of contacts on no taxel, which are in nothing else
  int off_array_contacts = 0;
};

// contact_band in m, SimulatorOptions.
ContactSums sumContacts(const Sensor& sensor, std::span<const ContactPoint> contacts, double contact_band);

// The taxel that takes a contact at p_SQ_S (m), by the rule of contact_point.h; none off the array.
std::optional<int> taxelAt(const Sensor& sensor, const Vector3& p_SQ_S, double contact_band);

}  // namespace taxelsim::reference
