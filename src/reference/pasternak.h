// Contact law `pasternak` of the reference: a two-parameter foundation in double precision, solved to convergence.
//
// Displacements w of the nodes (sensor/pasternak.h) with the signed overlap d of object and undeformed skin satisfy
//
//     f = k A w + sum over links of c g (w - w'),   f >= 0,   w >= d,   f (w - d) = 0,   g = shear_stiffness times width / length of a link
//
// with f the force of the object on a node. Links have c = 1, and c = 2 where an outline crosses: the object is over one node and nothing
// is over the other. The outline lies between them, on average half-way, and the displacement at the outline is that of the object. As
// finite volumes: the cell of a node under the object is wholly covered, and the surface leaves the object at the cell's side. c grows
// from 1 to 2 while the object's surface falls by one to two spacings, so that it is continuous in the pose.
//
// With DepthSampling::kArea the outline cuts links where the cells say, foundation_cells.h: c = 1 / (1 - s), s the covered share of a link.
//
// The surface beyond the array decays like exp(-x / l). Solved by projected successive over-relaxation (C. W. Cryer, "The solution of a
// quadratic programming problem using systematic overrelaxation", SIAM J. Control 9 (1971) 385).
#pragma once

#include <span>
#include <vector>

#include "reference/elastic_layer.h"
#include "reference/foundation_cells.h"

namespace taxelsim::reference {

// A rectangle of nodes of a foundation.
struct Foundation {
  Pasternak law;
  LayerNodes nodes;
};

Foundation makeFoundation(const Sensor& sensor);

struct FoundationSolution {
  std::vector<double> displacement;  // (num_rows x num_cols), m
  std::vector<double> pressure;      // (num_rows x num_cols), Pa: f / A
};

// Solves for the signed overlap d, (num_rows x num_cols), m; -infinity where there is no surface. `arms` of the nodes, (num_rows x
// num_cols), or empty: outlines cut links half-way. Throws std::runtime_error without convergence.
FoundationSolution solveFoundation(const Foundation& foundation, std::span<const double> overlap, std::span<const Arms> arms = {});

// One frame of contact; `strain` is empty. Sensors of several patches: linked_foundation.h.
LayerContact foundationContact(const Sensor& sensor, std::span<const PlacedObject> objects);

// As loadedLayerContact(). With DepthSampling::kArea by bisection over frames, each with the cells of its depth.
LayerContact loadedFoundationContact(const Sensor& sensor, std::span<const PlacedObject> objects, double load);

}  // namespace taxelsim::reference
