// Cells of the nodes of a two-parameter foundation with DepthSampling::kArea: which nodes an object is over, and how much of the links
// between nodes it covers. Model and figures: shaders/common/cut_links.glsl.
//
// The line that stands in for the outline within a cell is found by bisection of its offset, with the covered share by clipping of the
// cell's square; the links are cut with that half-plane.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "reference/layer_cells.h"

namespace taxelsim::reference {

// Covered parts of the halves of a node's links along -x, x, -y and y, in spacings, 0 to 1/2.
using Arms = std::array<double, 4>;

// All of shape (nodes).
struct FoundationCells {
  std::vector<double> height;          // m, that the node meets; +infinity where it is free
  std::vector<double> covered_height;  // m, of what the arms cover
  std::vector<Arms> arms;
};

// From the cells, their sizes along x and y of P (m), and the heights (m) in the middle of the cells, +infinity without a surface.
FoundationCells foundationCells(const LayerCells& cells, std::span<const std::array<double, 2>> sizes, std::span<const double> heights);

// The arms under an object `depth` (m) below its pose: none where it is above the skin.
std::vector<Arms> armsAtDepth(const FoundationCells& cells, double depth);

// Factor of the link between two nodes with overlaps a and b (m) of which the cells cover `arms` of its length, `spacing` (m).
double cutLinkFactor(double a, double b, double arms, double spacing);

}  // namespace taxelsim::reference
