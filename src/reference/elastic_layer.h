// The law `elastic_layer` of the reference: pressures under which an elastic skin follows an object, in double precision, converged.
//
// Unknown are the pressures p >= 0 on the nodes of a patch and its margin, with displacements w = A p: w = d where p > 0, w >= d elsewhere.
// They minimise p.A p / 2 - p.d. Conjugate gradients over the nodes in contact, which are found along the way: a step that would pull a
// node lets go of it, a node that would be penetrated is pressed (Polonsky and Keer, Wear 231 (1999) 206).
#pragma once

#include <array>
#include <span>
#include <vector>

#include "reference/depth.h"
#include "reference/friction.h"
#include "reference/relaxation.h"
#include "sensor/elastic_layer.h"

namespace taxelsim::reference {

// The patch's nodes and how they give way: A_mn = influence[|u_m - u_n|][|v_m - v_n|].
struct Layer {
  LayerNodes nodes;
  std::vector<double> influence;  // (num_rows x num_cols), m/Pa
};

Layer makeLayer(const Sensor& sensor);

struct LayerSolution {
  std::vector<double> pressure;  // (num_rows x num_cols), Pa
  double residual = 0;           // largest |w - d| where p > 0 and d - w elsewhere, relative to the deepest overlap
  int iterations = 0;
};

// The signed overlap d (num_rows x num_cols), m; -infinity where there is no surface. Throws std::runtime_error where `tolerance` of the
// residual is not reached.
LayerSolution pressLayer(const Layer& layer, std::span<const double> overlap, double tolerance = 1e-10);

// Sum of p dA over all nodes, N.
double forceOn(const Layer& layer, std::span<const double> pressure);

// One frame of the contact: forces as of computeContact(), over the taxels, and what the margin carries.
struct LayerContact {
  LayerSolution solution;                // of a skin that relaxes: of the problem of its dents, but for the pressure
  std::vector<double> strain;            // (num_rows x num_cols), Pa, of a skin that relaxes: pressures of an instantaneous press
  std::vector<double> overlap;           // (num_rows x num_cols), m: d, at most the thickness
  std::vector<double> taxel_force;       // (num_taxels), N
  std::vector<double> mean_penetration;  // (num_taxels), m: mean of clamp(d, 0, thickness)
  std::array<double, 6> wrench{};        // force (N) and torque (N m) on the sensor at S's origin, in S; margin included
  double total_force = 0;                // N: sum over the taxels
  double off_array_load = 0;             // N: sum over the margin
  double over_penetration = 0;           // fraction of the taxels' samples at least as deep as the skin is thick
  double offset = 0;                     // m: by how much the objects were moved along z of S
  bool load_reached = true;
  double gain = 1;  // of a skin that relaxes: pressure by what an instantaneous press would need for its depth
};

// How the pressures (num_rows x num_cols), Pa, change when the overlap does (the same, m), at once: over the nodes with pressure, which
// stay the same, the layer's own equations.
std::vector<double> pressureRates(const Layer& layer, const LayerContact& contact, std::span<const double> overlap_rates);

// The nodes as samples of one patch, in their order; those of the margin have no taxel.
std::vector<Sample> layerSamples(const Sensor& sensor, const LayerNodes& nodes);

// Heights of the lowest surface over every node, (num_rows x num_cols), m along z of P; +infinity where there is none.
std::vector<double> layerHeights(const Sensor& sensor, const LayerNodes& nodes, std::span<const PlacedObject> objects);

// What shears of it: the nodes, each touched where it has pressure, by the lowest of the objects, which are where `contact` left them.
PressedSkin pressedNodes(const Sensor& sensor, std::span<const PlacedObject> objects, const LayerContact& contact);

// Objects where they are. `skin`: of a skin that relaxes, over the nodes; none: of one that was never pressed.
//
// All moduli follow one g(t), so that the pressures p are the convolution of g with pressures P that would move the layer as far at once, A
// P = w. A step that begins with `skin` has p = gain (P - q), q being the strains to which it recovers by itself, so that p / gain solves
// the layer's problem for d - A q.
LayerContact layerContact(const Sensor& sensor, std::span<const PlacedObject> objects, const SkinStep& skin = {});

// Objects moved along z of S until taxels and margin together carry `load` (N); at full depth, where its deepest sample is as deep as the
// skin is thick, when that carries less. The patch must face along z of S.
LayerContact loadedLayerContact(const Sensor& sensor, std::span<const PlacedObject> objects, double load, const SkinStep& skin = {});

}  // namespace taxelsim::reference
