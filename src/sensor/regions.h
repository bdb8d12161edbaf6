// What features of a contact need to know of the skin: which taxels are neighbours, and how the spread blurs what touches.
#pragma once

#include <array>
#include <vector>

#include "taxelsim/sensor.h"

namespace taxelsim {

// Of every taxel of a list its neighbours of lower number, by number: those no farther along the skin than 1.5 times the mean size of the
// two, a taxel's size being the square root of its area. On a square grid these are the eight around it.
std::vector<std::vector<int>> listNeighbours(const Sensor& sensor);

// The spread over the taxels of a grid of this pitch, far from its borders.
struct SpreadShape {
  double sum = 1;                          // what arrives of 1 N
  std::array<double, 3> moments{0, 0, 0};  // m^2: xx, xy, yy of where it arrives
  int radius = 0;                          // taxels: beyond it hardly anything arrives
};

SpreadShape spreadShape(const Psf& psf, const std::array<double, 2>& pitch);

// What is taken for a taxel where a plane holds taxels of several patches or of a list: a square of their mean area, m.
double meanPitch(const Sensor& sensor);

// How many patches have features of their own: those of a list of taxels have none.
int numFeaturePatches(const Sensor& sensor);

}  // namespace taxelsim
