// Two points that represent the covered part of a cell of area sampling, where its mean depth does not determine the forces: exponents
// other than 1, and friction.
//
// The points have the mean and the variance of the part's depth. They lie on a line through the middle of the part, in the direction in
// which the cell is deeper. Their distance gives them the part's polar moment of area. The part is modelled as a strip on the deeper side
// of the cell.
#pragma once

#include <array>

#include "reference/mean_depth.h"

namespace taxelsim::reference {

struct CellPoint {
  double weight = 0;                        // of the covered part
  double depth = 0;                         // m
  std::array<double, 2> from_middle{0, 0};  // m, in P, from the middle of the cell
};
using CellPoints = std::array<CellPoint, 2>;  // the shallower first

// Where the pressure acts closer to the middle of the cell than this part of a cell, no direction is deeper: the points lie along x.
inline constexpr double kEvenCell = 0.01;

// `cell` with a mean > 0; `step`: size of the cell, m.
CellPoints cellPoints(const CellDepth& cell, const std::array<double, 2>& step);

}  // namespace taxelsim::reference
