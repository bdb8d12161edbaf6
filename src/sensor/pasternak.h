// Discretization and closed forms of a two-parameter foundation, law Pasternak. The solver is in src/reference/pasternak.h in double
// precision, shaders/pasternak.comp on the device.
#pragma once

#include "sensor/elastic_layer.h"
#include "taxelsim/sensor.h"

namespace taxelsim {

// Length (m) over which the free surface decays: sqrt(shear_stiffness / normal_contact_stiffness).
double decayLength(const Pasternak& law);

// Nodes per sample and side: at most a third of the decay length apart, four ninths with DepthSampling::kArea. May exceed kMaxRefinement,
// which checkSensor() refuses.
int pasternakRefinement(const Sensor& sensor);

// The solver's nodes, in the middle of equal parts of the samples' cells; no margin. The sensor's law must be Pasternak.
LayerNodes pasternakNodes(const Sensor& sensor);

// Those of the patch with the smallest taxels: the stiffest links, and the slowest sweeps.
LayerNodes finestPasternakNodes(const Sensor& sensor);

// Height (m) over the skin up to which surfaces matter: a node whose surface is 2 spacings higher than its neighbour's is beyond an
// outline.
double pasternakReach(const LayerNodes& nodes);

// Largest pressure (Pa) of a node: at full thickness, with all its links cut, and the surface around it at rest.
double largestPasternakPressure(const Sensor& sensor);

// Over-relaxation of a sweep over the nodes, 1 to 2: optimal for a free surface without end.
double sweepRelaxation(const Pasternak& law, const LayerNodes& nodes);

// Sweeps of the solver per frame or step of the load search: Pasternak::iterations, or where that is 0 the fewest n with n r^n <= 0.4 and
// falling. r, sweepRelaxation() - 1, is the asymptotic factor by which a sweep reduces an error, and n r^n the order of the norm of n
// sweeps (D. M. Young, 1954). The force is then within 0.8 % of the converged one (Pasternak.DefaultSweepsConverge in
// tests/simulation/pasternak_test.cpp), within 0.4 % where nodes are a third of the decay length apart.
int pasternakSweeps(const Sensor& sensor);

// Force per depth (N/m) of a rigid flat circular punch of this radius (m, > 0): k pi a^2 [1 + 2 (l / a) K1(a / l) / K0(a / l)].
double pasternakPunchStiffness(const Pasternak& law, double radius);

// K1(x) / K0(x), the modified Bessel functions of the second kind; x > 0.
double besselRatio(double x);

}  // namespace taxelsim
