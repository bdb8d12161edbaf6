// Stage 2 of the reference, contact: penetration -> pressure per sample -> force per taxel. Kappassov, Corrales and Perdereau, AIM 2020,
// eq. (2), as an elastic foundation (K. L. Johnson, Contact Mechanics, CUP 1985, section 4.3): the pressure at a sample depends on its own
// penetration only, F_taxel = sum p(d) dA. Covers all laws except ElasticLayer, whose pressures are coupled (elastic_layer.h).
#pragma once

#include <array>
#include <span>
#include <vector>

#include "reference/area_depth.h"
#include "reference/relaxation.h"
#include "taxelsim/sensor.h"

namespace taxelsim::reference {

struct Contact {
  std::vector<double> pressure;          // (num_taxels x s x s), Pa, >= 0
  std::vector<double> strain;            // (num_taxels x s x s), Pa: strain measure of a relaxing skin, see relaxation.h
  std::vector<double> taxel_force;       // (num_taxels), N
  std::vector<double> mean_penetration;  // (num_taxels), m: mean of max(d, 0)
  std::array<double, 6> wrench{};        // force (N) and torque (N m) on the sensor at the origin of S, in S
  double total_force = 0;                // N: sum over the taxels
  double over_penetration = 0;           // fraction of samples with d >= thickness
};

// d and `previous`, the penetration of this and of the preceding frame, have shape (num_taxels x s x s), m; dt (s) lies between them. An
// empty `previous` or dt = 0 means rest. `skin`: state of a relaxing skin; default: never loaded. Not for ElasticLayer (std::logic_error).
Contact computeContact(const Sensor& sensor, std::span<const double> d, std::span<const double> previous, double dt,
                       const SkinStep& skin = {});

// The same with area sampling; for exponents other than 1 the pressure of a cell is the mean over its points (cell_points.h), both of
// which approach at the mean rate of the covered part.
Contact computeContact(const Sensor& sensor, const AreaDepths& depths, std::span<const double> previous, double dt,
                       const SkinStep& skin = {});

// Pressure (Pa, >= 0) of a sample at penetration d (m) and rate d' (m/s), without relaxation. 0 for d <= 0; a damper never pulls. Not
// for ElasticLayer (std::logic_error).
double contactPressure(const ContactLaw& law, double d, double rate);

}  // namespace taxelsim::reference
