// Stage 2 of the reference, second half: laws in which a taxel is more than the sum of its samples.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "reference/friction.h"
#include "taxelsim/sensor.h"

namespace taxelsim::reference {

// Of one taxel, MassSpringDamper: force in its spring (N), and its rate (N/s).
using TaxelState = std::array<double, 2>;

// What taxels read of the force (N) that contact presses on them, (num_taxels), by the sensor's law. `state` (num_taxels, or empty for a
// sensor at rest) moves on by dt, the force held; it is left empty by laws without one.
std::vector<double> taxelResponse(const Sensor& sensor, std::span<const double> pressed, double dt, std::vector<TaxelState>& state);

// What they read of its shear: where a mass lags, no more than friction holds by the force that the taxel reads.
std::vector<Shear> taxelShear(const Sensor& sensor, std::span<const Shear> shear, std::span<const double> response);

// Weights of DeformationMask for a taxel itself, a neighbour across an edge, and one across a corner: RobWorkSim's function integrated over
// taxels.
std::array<double, 3> maskWeights();

}  // namespace taxelsim::reference
