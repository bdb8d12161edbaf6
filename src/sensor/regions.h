// For contact features: neighbours of taxels, and the blur of the point spread function.
#pragma once

#include <array>
#include <vector>

#include "taxelsim/sensor.h"

namespace taxelsim {

// Neighbours of every taxel of a list with lower numbers, ascending: taxels within 1.5 times the mean size of the two along the skin. The
// size of a taxel is the square root of its area. On a square grid these are the eight around it.
std::vector<std::vector<int>> listNeighbours(const Sensor& sensor);

// The point spread on a grid of this pitch, far from its borders.
struct SpreadShape {
  double sum = 1;                          // of the weights
  std::array<double, 3> moments{0, 0, 0};  // second moments of the weights: xx, xy, yy, m^2
  int radius = 0;                          // taxels; weights beyond are negligible
};

SpreadShape spreadShape(const Psf& psf, const std::array<double, 2>& pitch);

// Pitch for a plane with taxels of several patches or of a list: side of a square of their mean area, m.
double meanPitch(const Sensor& sensor);

// Number of patches with features of their own; 0 for a list of taxels.
int numFeaturePatches(const Sensor& sensor);

}  // namespace taxelsim
