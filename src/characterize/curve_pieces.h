// Piecewise linear readout curves: placement of the knots, removal of knots that the readings do not determine, and the fit.
//
// Pieces have equal widths up to the output at the largest forces, or 0.95 of the end of the range; the knot there is pinned. While half of
// the force range gives more than 0.8 of the output (a curve that saturates), the upper half becomes one piece. Pieces with too few
// readings are merged with their neighbours.
#pragma once

#include <cstddef>
#include <vector>

#include "characterize/readout_model.h"

namespace taxelsim {

struct PiecesFit {
  GroupedFit fit;
  std::size_t num_gross = 0;        // rows removed as gross outliers before the fit
  std::vector<double> joined;       // z (counts) of removed knots
  std::vector<std::size_t> sparse;  // pieces with fewer than kLeastReadings rows of their own
};

// Fits at most `num_pieces` >= 1. Updates `model` (knots, noise), `lines` (start values for later fits) and the taxels' informative rows.
PiecesFit fitPieces(std::vector<PressedTaxel>& taxels, std::size_t num_pieces, std::vector<FitResult>& lines, ReadoutModel& model);

// The rises as shared parameters; start values are median outputs near the knots, by the taxels' lines.
std::vector<FitParameter> risesOfPieces(const ReadoutModel& model, const std::vector<PressedTaxel>& taxels,
                                        const std::vector<FitResult>& lines);

// The output at a knot and its derivatives.
struct KnotOutput {
  double counts = 0;
  double slope = 0;          // counts per count of z: mean of both sides; at the last knot, of the piece before it
  Eigen::VectorXd gradient;  // (shared)
};
KnotOutput outputAt(std::size_t knot, const ReadoutModel& model, const std::vector<double>& shared);

}  // namespace taxelsim
