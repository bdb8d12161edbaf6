// Footprint of an indenter on a plane skin, and its overlap with taxels.
#pragma once

#include <array>
#include <vector>

#include "taxelsim/measurement.h"

namespace taxelsim {

using Polygon = std::vector<std::array<double, 2>>;  // m, convex, counter-clockwise

// Cross section of the indenter `height` (m) above its lowest point, centred on its axis: a rectangle, or for a circle a regular polygon of
// 64 corners with the same area. The axis of a cylinder is along x.
Polygon sectionOf(const Indenter& indenter, double height);

Polygon moved(Polygon polygon, const std::array<double, 2>& to, double yaw = 0);

// Area (m^2) of the polygon inside the rectangle.
double overlap(const Polygon& polygon, const std::array<double, 2>& low, const std::array<double, 2>& high);

// Quadrature of the force of a foundation with pressure = stiffness d^exponent: a section at height h, pressed depth - h deep, carries
// stiffness A(h) exponent (depth - h)^(exponent - 1) dh.
struct PressedSection {
  double height = 0;  // m
  double volume = 0;  // force per stiffness, m^(2 + exponent)
};
std::vector<PressedSection> pressedSections(const Indenter& indenter, double exponent, double depth);

// Force per stiffness of an indenter pressed `depth` (m) deep; 0 for depth <= 0.
double volumeUnder(const Indenter& indenter, double exponent, double depth);

// Depth (m) at which volumeUnder() is `volume`, > 0.
double depthOfVolume(const Indenter& indenter, double exponent, double volume);

}  // namespace taxelsim
