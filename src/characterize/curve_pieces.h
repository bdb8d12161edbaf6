// Readout curves of straight pieces: where their knots lie, which of them the readings tell, and the fit.
//
// Pieces are alike in force up to where the output is what it comes to near the largest forces, or 0.95 of the end of the range; that knot
// is pinned. But as long as half of the range makes more than 0.8 of its output, the upper half becomes one piece of its own. Pieces with
// too few readings are joined to one another, at both ends to the next.
#pragma once

#include <cstddef>
#include <vector>

#include "characterize/readout_model.h"

namespace taxelsim {

struct PiecesFit {
  GroupedFit fit;
  std::size_t num_gross = 0;        // rows that were left out as outliers beforehand
  std::vector<double> joined;       // z (counts) of knots that the readings do not tell, and that are no more
  std::vector<std::size_t> sparse;  // pieces with fewer than kLeastReadings rows of their own
};

// Puts at most `num_pieces` >= 1 and the noise into `model`; for fits to come the slopes and first forces that were found into `lines`, and
// to the taxels the rows that tell by these.
PiecesFit fitPieces(std::vector<PressedTaxel>& taxels, std::size_t num_pieces, std::vector<FitResult>& lines, ReadoutModel& model);

// The shared parameters that are rises of pieces: they begin with the medians of the outputs around the knots, by the taxels' lines.
std::vector<FitParameter> risesOfPieces(const ReadoutModel& model, const std::vector<PressedTaxel>& taxels,
                                        const std::vector<FitResult>& lines);

// The output at a knot, and how it changes with the shared values.
struct KnotOutput {
  double counts = 0;
  double slope = 0;          // counts per count of z: mean of both sides, at the last knot that before it
  Eigen::VectorXd gradient;  // (shared)
};
KnotOutput outputAt(std::size_t knot, const ReadoutModel& model, const std::vector<double>& shared);

}  // namespace taxelsim
