// How the covered parts of cells change under a rigid motion of the objects: rates of LayerCells.
//
//           +-------+      The part's area changes by what flows through the sides of the cell, and its first moment by the flow of that
//           and
//      u -->|##|    |      by the motion of what is inside (divergence theorem, of a motion without sources):
//      u -->|###|   |
//           +-------+        A ds/dt = -sum over the sides of int u n dl,    A d(s c)/dt = s A u - sum over the sides of int r u n dl
//            covered
// with the intervals of the sides that are covered. In a cell that an edge cuts they are those behind the straight line with the covered
// share on one side, across the direction to the centroid; two cells share a side and give it the mean of their intervals, unless one of
// them is whole or empty. So what flows out of one cell flows into the next, and an object within one cell moves its centroid only.
#pragma once

#include <vector>

#include "reference/layer_cells.h"
#include "reference/pressure_transport.h"

namespace taxelsim::reference {

// All of shape (nodes), per unit of the motion.
struct CellRates {
  std::vector<double> covered;               // 1
  std::vector<std::array<double, 2>> place;  // m, of the centroid
};

// `overlap`: (nodes), m. The rates are 0 where no edge cuts a cell. How far an edge bounds the part is held fixed.
CellRates cellRates(const LayerNodes& nodes, const LayerCells& cells, const std::vector<double>& overlap, const Motion& motion);

// Rates of LayerCells::compliance, (nodes), m/Pa: central differences.
std::vector<double> complianceRates(const LayerNodes& nodes, const NodeCompliance& compliance, const LayerCells& cells,
                                    const CellRates& rates);

}  // namespace taxelsim::reference
