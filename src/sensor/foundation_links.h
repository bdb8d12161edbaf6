// A two-parameter foundation on several patches, law Pasternak: its nodes, and the links between them along the skin. The solver is in
// src/reference/linked_foundation.h in double precision, shaders/linked_foundation.comp on the device.
//
// Nodes lie in the plane of their patch, as samples do. Within a patch they are linked as a grid: stiffness G times width / length. At the
// rim of a patch each side of a node's cell is divided among the nearest nodes of other patches beyond it; a part of it has the stiffness G
// times its length / the distance of the two nodes across the side. Where patches continue each other (a cylinder, a plane) this is the
// grid. A part is at the end of the skin if no such node is within a decay length, or if the nearest lies rather along the side: farther
// than it is across, and than a cell is wide.
//
// Places in two patches are compared as if the skin between the middles of their taxels were laid out flat: along the geodesic of
// skinDistance(), turned by turnAlongSkin(). Both are exact on planes, cylinders and spheres.
#pragma once

#include <array>
#include <vector>

#include "taxelsim/sensor.h"

namespace taxelsim {

// Half of what joins two nodes: every link is in the lists of both, with the same numbers. The straight line between the two nodes leaves
// the cell of either through a side; sides 0 to 3 look along -x, x, -y and y of the node's patch.
struct FoundationLink {
  int node = 0;          // the other one
  double stiffness = 0;  // N/m
  double length = 0;     // m
  int side = 0;          // of the node's cell
  int other_side = 0;    // of the other node's cell
};

// The side of a cell of the size `spacing` (m) through which the line from its middle to `place` (m) leaves; through a corner, that along
// x.
int sideTowards(const std::array<double, 2>& place, const std::array<double, 2>& spacing);

// Nodes in the order of the samples of a sensor that has per_side x per_side samples per taxel: [taxel][a][b].
struct LinkedNodes {
  int per_side = 1;                                // along each side of a taxel
  std::vector<std::vector<FoundationLink>> links;  // (num_nodes)
  std::vector<double> spring;                      // (num_nodes), N/m: of a node, with what the surface beyond the end of the skin adds
};

inline constexpr int kMaxFoundationLinks = 255;  // of a node
inline constexpr int kMaxLinkedTaxels = 1024;    // of a foundation on several patches

// The sensor's law must be Pasternak.
LinkedNodes linkedNodes(const Sensor& sensor);

// Taxels cut into num_parts x num_parts blocks of nodes each, a divisor of LinkedNodes::per_side; blocks are numbered by taxel, part along
// x, part along y. For every block: the blocks, ascending and including itself, of which some node is within `reach` (m) of it along the
// skin.
std::vector<std::vector<int>> blocksWithin(const Sensor& sensor, int num_parts, double reach);

// What a link to skin at rest pulls with, N/m: the displacement falls by the factor exp(-length / decay) on the way to it.
double stiffnessAtRest(const FoundationLink& link, double decay);

}  // namespace taxelsim
