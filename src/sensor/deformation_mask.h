// The mask of DeformationMask on a list of taxels.
#pragma once

#include <vector>

#include "taxelsim/sensor.h"

namespace taxelsim {

struct MaskSource {
  int taxel = 0;
  double weight = 0;  // share of its force
};

// For every taxel of a list the taxels whose force deforms the skin there, itself included, ascending. The mask function of RobWorkSim, of
// the distance along the skin over the mean size of both taxels (square root of the area), is integrated over the rectangle of each taxel.
// The shares of a source sum to 1. Taxels that face away from each other do not share. On a flat square grid these are the weights of the
// grid.
std::vector<std::vector<MaskSource>> maskSources(const Sensor& sensor);

}  // namespace taxelsim
