// Where an indenter touches a plane skin, and how much of its force falls on which taxel.
#pragma once

#include <array>
#include <vector>

#include "taxelsim/measurement.h"

namespace taxelsim {

using Polygon = std::vector<std::array<double, 2>>;  // m, convex, counter-clockwise

// The indenter's section `height` (m) over its lowest point, about its axis: a rectangle, or in place of a circle the regular polygon of 64
// corners with its area. A lying cylinder lies along x.
Polygon sectionOf(const Indenter& indenter, double height);

Polygon moved(Polygon polygon, const std::array<double, 2>& to, double yaw = 0);

// Area (m^2) of the polygon inside the rectangle.
double overlap(const Polygon& polygon, const std::array<double, 2>& low, const std::array<double, 2>& high);

// What a foundation of pressure = stiffness d^exponent presses with, section by section: a section of height h that is pressed depth - h
// deep carries stiffness A(h) exponent (depth - h)^(exponent - 1) dh.
struct PressedSection {
  double height = 0;  // m
  double volume = 0;  // force per stiffness, m^(2 + exponent)
};
std::vector<PressedSection> pressedSections(const Indenter& indenter, double exponent, double depth);

// Their sum: force per stiffness of an indenter pressed `depth` (m) deep; 0 for none.
double volumeUnder(const Indenter& indenter, double exponent, double depth);

// Depth (m) at which volumeUnder() is `volume`, > 0.
double depthOfVolume(const Indenter& indenter, double exponent, double volume);

}  // namespace taxelsim
