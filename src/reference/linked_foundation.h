// Contact law `pasternak` of the reference on several patches: a two-parameter foundation in double precision, solved to rounding.
//
// The equations are those of pasternak.h, with the links between nodes of different patches that sensor/foundation_links.h describes. Both
// are found in another way than on the device: planes are laid out by rotation of vectors in space, the sides of cells are divided by
// places on them, and the contact is that of a primal-dual active set (M. Hintermueller, K. Ito and K. Kunisch, "The primal-dual active set
// strategy as a semismooth Newton method", SIAM J. Optim. 13 (2002) 865), in which every set takes a linear system that conjugate
// gradients solve. With DepthSampling::kArea the cells of foundation_cells.h cut the links; over a seam the arm of either cell counts as
// half of the link.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "reference/elastic_layer.h"
#include "reference/foundation_cells.h"

namespace taxelsim::reference {

// Nodes in the order of samplesOf() the sensor with its nodes as samples.
struct LinkedFoundation {
  struct Link {
    std::size_t first = 0, second = 0;
    double stiffness = 0;                         // N/m
    double length = 0;                            // m
    std::size_t first_side = 0, second_side = 0;  // of the two cells, through which the line between the nodes leaves: -x, x, -y, y
  };

  std::vector<double> spring;  // (nodes), N/m
  std::vector<double> area;    // (nodes), m^2
  std::vector<Link> links;
};

// The sensor's law must be Pasternak.
LinkedFoundation linkedFoundation(const Sensor& sensor);

// Pressures (Pa) and displacements (m) for the signed overlap d, (nodes), m; -infinity where there is no surface. `arms` of the nodes, or
// empty: outlines cut links half-way. Throws std::runtime_error without convergence.
struct LinkedSolution {
  std::vector<double> displacement, pressure;  // (nodes)
};
LinkedSolution solveLinked(const LinkedFoundation& foundation, std::span<const double> overlap, std::span<const Arms> arms = {});

// One frame of contact; `strain` is empty.
LayerContact linkedContact(const Sensor& sensor, std::span<const PlacedObject> objects);

// The objects translated along z of S so that the force along -z of S is `load` (N). Out of reach where the skin carries less with a node
// at its full thickness: then at that depth.
LayerContact loadedLinkedContact(const Sensor& sensor, std::span<const PlacedObject> objects, double load);

}  // namespace taxelsim::reference
