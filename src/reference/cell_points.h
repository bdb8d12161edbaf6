// Two points that represent the covered part of a cell of area sampling, where its mean depth does not determine the forces: exponents
// other than 1, and friction.
//
// The points have the mean and the variance of the part's depth. The part is modelled as a strip on the deeper side of the cell, and the
// points have its middle and its variances of place, towards the deeper side and across it, which give its polar moment of area. The
// deeper point lies on the left of the direction in which the cell is deeper.
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

// Weight of the deeper point, at most, where pressure is proportional to depth, and with other exponents.
inline constexpr double kMostDeep = 0.6, kHalfDeep = 0.5;

// `cell` with a mean > 0; `step`: size of the cell, m. `most_deep`: weight of the deeper point; less where the other one would be above the
// skin.
CellPoints cellPoints(const CellDepth& cell, const std::array<double, 2>& step, double most_deep);

}  // namespace taxelsim::reference
