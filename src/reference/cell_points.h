// Two points that stand for the covered part of a cell of area sampling, where its mean depth is not enough: exponents other than 1, and
// friction.
//
// The points have the part's mean depth and the variance of its depth. They lie on a line in the direction in which the cell is deeper,
// about the middle of the part, as far from it as gives them the part's polar moment of area. The part is taken for a strip of the cell's
// width on its deeper side.
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

// A part whose pressure acts closer to the cell's middle than this part of a cell is deeper in no direction: the points lie along x.
inline constexpr double kEvenCell = 0.01;

// `cell` with a mean > 0; `step`: size of the cell, m.
CellPoints cellPoints(const CellDepth& cell, const std::array<double, 2>& step);

}  // namespace taxelsim::reference
