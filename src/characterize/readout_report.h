// Writes a fitted readout into the sensor, estimates, remarks and figures of a Characterization.
#pragma once

#include "characterize/curve_pieces.h"
#include "characterize/pressed_taxels.h"
#include "taxelsim/characterize.h"

namespace taxelsim {

struct ReadoutFit {
  std::vector<PressedTaxel> taxels;
  Plateau plateau;
  ReadoutModel model;
  PiecesFit pieces;  // if the curve has straight pieces
  GroupedFit fit;
};

void reportReadout(const ReadoutFit& found, Characterization& result);

// Mean slope S of the taxels, counts/N.
double meanSlope(const ReadoutFit& found);

}  // namespace taxelsim
