// Contact law `elastic_layer` of the reference: frictionless normal contact of an elastic skin, solved to convergence in double precision.
//
// Unknowns are the pressures p on the nodes of a patch and its margin. Surface displacements are w = A p, with A the influence matrix
// (sensor/elastic_layer.h). With d the signed overlap of object and undeformed skin, the contact conditions
//
//     p >= 0,   w >= d,   p (w - d) = 0        (linear complementarity: the skin follows the object where it presses, bulges elsewhere)
//
// are those of the quadratic program  min p.A p / 2 - p.d  over p >= 0. Solved by non-negative conjugate gradients (I. A. Polonsky and L.
// M. Keer, "A numerical method for solving rough contact problems based on the multi-level multi-summation and conjugate gradient
// techniques", Wear 231 (1999) 206):
//
//     r = A p - d                                    residual
//     t = r + (|r|^2 / |r_prev|^2) t on the active set {p > 0}, 0 elsewhere      search direction; restarted when the active set grew
//     p = max(0, p - (r.t / t.A t) t)                step and projection
//     nodes with p = 0 and r < 0 are penetrated:     they join the active set, p = -step r
//
// Under a given load the depth is the root of a monotone function of the force, found by bisection and then the Illinois method (M. Dowell
// and P. Jarratt, BIT 11 (1971) 168).
#pragma once

#include <array>
#include <span>
#include <vector>

#include "reference/depth.h"
#include "reference/friction.h"
#include "reference/layer_cells.h"
#include "reference/relaxation.h"
#include "sensor/elastic_layer.h"

namespace taxelsim::reference {

// Nodes and influence matrix of a patch. A is block Toeplitz: A_mn = influence[|row_m - row_n|][|column_m - column_n|].
struct Layer {
  LayerNodes nodes;
  std::vector<double> influence;  // (num_rows x num_cols), m/Pa
};

// Layer of a sensor with law ElasticLayer.
Layer makeLayer(const Sensor& sensor);

struct LayerSolution {
  std::vector<double> pressure;  // (num_rows x num_cols), Pa
  double residual = 0;           // max of |w - d| where p > 0 and of d - w elsewhere, relative to the deepest overlap
  int iterations = 0;
};

// Solves for the pressures under the signed overlap d, (num_rows x num_cols), m; -infinity where there is no surface. `compliance`: of
// LayerCells, added to the diagonal of A; empty for whole cells. Throws std::runtime_error if the residual does not reach `tolerance`.
LayerSolution solveLayer(const Layer& layer, std::span<const double> overlap, double tolerance = 1e-10,
                         std::span<const double> compliance = {});

// Sum of p dA over all nodes, N.
double totalForce(const Layer& layer, std::span<const double> pressure);

// One frame of contact. Arrays over nodes have shape (num_rows x num_cols).
struct LayerContact {
  LayerSolution solution;                // relaxing skin: residual and iterations are those of the problem with residual strains
  std::vector<double> strain;            // (nodes), Pa: strain measure of a relaxing skin, see relaxation.h
  std::vector<double> dent_compliance;   // (nodes), m/Pa: of the strain on its own node, less that of a whole cell; of cells
  std::vector<double> overlap;           // (nodes), m: d, at most the thickness
  LayerCells cells;                      // with DepthSampling::kArea
  std::vector<double> taxel_force;       // (num_taxels), N
  std::vector<double> mean_penetration;  // (num_taxels), m: mean of clamp(d, 0, thickness)
  std::array<double, 6> wrench{};        // force (N) and torque (N m) on the sensor at the origin of S, in S; margin included
  double total_force = 0;                // N: sum over the taxels
  double off_array_load = 0;             // N: sum over the margin
  double over_penetration = 0;           // fraction of the taxels' samples with d >= thickness
  double offset = 0;                     // m: translation of the objects along z of S
  bool load_reached = true;
  double gain = 1;  // SkinStep::gain of a relaxing skin
};

// Sums over the nodes as samples: `sensor` has as many samples per taxel as nodes. Reads solution.pressure and overlap,
// sets taxel_force, mean_penetration, wrench, total_force, off_array_load and over_penetration.
void sumForces(const Sensor& sensor, const LayerNodes& nodes, LayerContact& contact);

// Linearisation of the solution: rates of the pressures, (nodes), Pa, for rates of the overlap, (nodes), m, both per unit
// of the same parameter. The active set is held fixed: A p' = d' on the nodes with pressure. Instantaneous, also for a relaxing skin.
std::vector<double> pressureRates(const Layer& layer, const LayerContact& contact, std::span<const double> overlap_rates);

// The nodes as samples of the first patch; taxel kNoTaxel in the margin.
std::vector<Sample> layerSamples(const Sensor& sensor, const LayerNodes& nodes);

// Height of the lowest surface over every node, (nodes), m along z of P; +infinity where there is none.
std::vector<double> layerHeights(const Sensor& sensor, const LayerNodes& nodes, std::span<const PlacedObject> objects);

// The nodes as input of contactShear(): touched where they have pressure, by the object with the lowest surface. `objects` have the poses
// of `contact`.
PressedSkin pressedNodes(const Sensor& sensor, std::span<const PlacedObject> objects, const LayerContact& contact);

// Contact with the objects at their poses. `skin`: state of a relaxing skin over the nodes; default: never loaded.
//
// Relaxation: all moduli follow one kernel g(t), so p = g * dP/dt (convolution) with A P = w. A step that starts from `skin` gives p = gain
// (P - q), q the recovered strains; p / gain solves the elastic problem with overlap d - A q. With cells, A q takes the compliance of a
// cell for the dent that is nearer to a whole cell's: that of what is covered now, or that of what was covered when the strain was added,
// the mean over the strain. It is the displacement of a part of a cell by a force on another one, if one of the parts contains the other.
LayerContact layerContact(const Sensor& sensor, std::span<const PlacedObject> objects, const SkinStep& skin = {});

// Contact with the objects translated along z of S so that taxels and margin together carry `load` (N). If the skin carries less at full
// depth (deepest sample at the skin thickness), load_reached is false and the objects are at full depth. Requires z of P parallel to z of
// S. Throws std::runtime_error if the root is not found.
LayerContact loadedLayerContact(const Sensor& sensor, std::span<const PlacedObject> objects, double load, const SkinStep& skin = {});

}  // namespace taxelsim::reference
