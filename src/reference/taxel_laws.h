// Stage 2 of the reference, response of whole taxels: contact laws whose taxel reads something other than the sum over its samples.
//
//   MassSpringDamper  m x" + c x' + k x = F per taxel (SkinSim: Habib et al., CASE 2014). The reading is the spring force k x. Integrated
//                     exactly for F constant over a step: matrix exponential of the 2 x 2 system by scaling and squaring.
//   DeformationMask   mask over the neighbouring taxels (3 x 3 on grids), saturation, then rescaling to the total force (class
//                     TactileArraySensor of RobWorkSim: Jorgensen, Ellekilde and Petersen, ISR 2010).
//   all others        the reading is the contact force.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "reference/friction.h"
#include "taxelsim/sensor.h"

namespace taxelsim::reference {

// State of a MassSpringDamper taxel: spring force (N) and its rate (N/s).
using TaxelState = std::array<double, 2>;

// Readings (N) of the taxels under the contact forces `pressed` (N), both (num_taxels). `state`, (num_taxels) or empty for a sensor at
// rest, is advanced by dt (s) with the forces held constant. Laws without state ignore it.
std::vector<double> taxelResponse(const Sensor& sensor, std::span<const double> pressed, double dt, std::vector<TaxelState>& state);

// Shear readings (N) for the contact shear `shear` (N) and the normal readings `response` (N), all (num_taxels). MassSpringDamper: shear is
// clamped to the friction cone of the lagging normal reading.
std::vector<Shear> taxelShear(const Sensor& sensor, std::span<const Shear> shear, std::span<const double> response);

// Weights of DeformationMask for the taxel itself, an edge neighbour and a corner neighbour: RobWorkSim's mask function integrated over
// each taxel, normalised to a sum of 1 over the 3 x 3 taxels.
std::array<double, 3> maskWeights();

}  // namespace taxelsim::reference
