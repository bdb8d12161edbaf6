// Stage 2 of the reference: penetration -> pressure -> force per taxel (paper eq. (2), as an elastic foundation).
#pragma once

#include <array>
#include <span>
#include <vector>

#include "reference/relaxation.h"
#include "taxelsim/sensor.h"

namespace taxelsim::reference {

struct Contact {
  std::vector<double> pressure;          // (num_taxels x s x s), Pa
  std::vector<double> strain;            // (num_taxels x s x s), Pa, of a skin that relaxes: SkinHistory
  std::vector<double> taxel_force;       // (num_taxels), N
  std::vector<double> mean_penetration;  // (num_taxels), m: mean of max(d, 0)
  std::array<double, 6> wrench{};        // force (N) and torque (N m) on the sensor at S's origin, in S
  double total_force = 0;                // N: sum over the taxels
  double over_penetration = 0;           // fraction of samples at least as deep as the skin is thick
};

// By the sensor's law, which must not be ElasticLayer (reference/elastic_layer.h). Penetration d and that of the frame before, (num_taxels
// x s x s), m; an empty `previous`, or dt = 0, is a contact at rest. `skin`: of a skin that relaxes; none: of one that was never pressed.
Contact computeContact(const Sensor& sensor, std::span<const double> d, std::span<const double> previous, double dt,
                       const SkinStep& skin = {});

// Pressure (Pa) of one sample, d' in m/s, of a skin that has not relaxed: not negative, and zero where d <= 0; a damper never pulls. Not
// of ElasticLayer.
double contactPressure(const ContactLaw& law, double d, double rate);

}  // namespace taxelsim::reference
