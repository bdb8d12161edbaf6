#include "characterize/footprint.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace taxelsim {
namespace {

constexpr std::size_t kCorners = 64;

// Nodes and weights of Gauss and Legendre on [0, 1]; M. Abramowitz and I. Stegun, Handbook of Mathematical Functions, table 25.4 (n = 8).
constexpr std::array<double, 8> kNodes{0.019855071751231884, 0.101666761293186630, 0.237233795041835507, 0.408282678752175098,
                                       0.591717321247824902, 0.762766204958164493, 0.898333238706813370, 0.980144928248768116};
constexpr std::array<double, 8> kWeights{0.050614268145188130, 0.111190517226687235, 0.156853322938943644, 0.181341891689180991,
                                         0.181341891689180991, 0.156853322938943644, 0.111190517226687235, 0.050614268145188130};

Polygon discOf(double area) {
  const double radius = std::sqrt(2 * area / (kCorners * std::sin(2 * std::numbers::pi / kCorners)));
  Polygon polygon;
  for (std::size_t k = 0; k < kCorners; ++k) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(k) / kCorners;
    polygon.push_back({radius * std::cos(angle), radius * std::sin(angle)});
  }
  return polygon;
}

Polygon rectangleOf(double length_x, double length_y) {
  const double x = length_x / 2, y = length_y / 2;
  return {{-x, -y}, {x, -y}, {x, y}, {-x, y}};
}

// Keeps the half plane side * (coordinate - bound) <= 0; I. Sutherland and G. Hodgman, Reentrant polygon clipping, 1974.
void clip(Polygon& polygon, std::size_t axis, double bound, double side, Polygon& scratch) {
  scratch.clear();
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const std::array<double, 2>&a = polygon[k], &b = polygon[(k + 1) % polygon.size()];
    const double from = side * (a[axis] - bound), to = side * (b[axis] - bound);
    if (from <= 0) scratch.push_back(a);
    if ((from < 0 && to > 0) || (from > 0 && to < 0)) {
      const double share = from / (from - to);
      scratch.push_back({a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])});
    }
  }
  polygon.swap(scratch);
}

}  // namespace

Polygon sectionOf(const Indenter& indenter, double height) {
  switch (indenter.shape) {
    case Indenter::Shape::kStamp:
      return rectangleOf(indenter.size[0], indenter.size[1]);
    case Indenter::Shape::kCylinder:
      return rectangleOf(indenter.length, indenter.sectionAt(height) / indenter.length);
    default:
      return discOf(indenter.sectionAt(height));
  }
}

Polygon moved(Polygon polygon, const std::array<double, 2>& to, double yaw) {
  const double c = std::cos(yaw), s = std::sin(yaw);
  for (std::array<double, 2>& p : polygon) p = {to[0] + c * p[0] - s * p[1], to[1] + s * p[0] + c * p[1]};
  return polygon;
}

double overlap(const Polygon& polygon, const std::array<double, 2>& low, const std::array<double, 2>& high) {
  // Early exit for a rectangle inside the polygon: every corner is left of every edge.
  const auto isLeft = [&](double x, double y) {
    for (std::size_t k = 0; k < polygon.size(); ++k) {
      const std::array<double, 2>&a = polygon[k], &b = polygon[(k + 1) % polygon.size()];
      if ((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]) < 0) return false;
    }
    return true;
  };
  if (isLeft(low[0], low[1]) && isLeft(high[0], low[1]) && isLeft(high[0], high[1]) && isLeft(low[0], high[1])) {
    return (high[0] - low[0]) * (high[1] - low[1]);
  }
  thread_local Polygon inside, scratch;  // avoids allocations in the inner loop
  inside = polygon;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    clip(inside, axis, low[axis], -1, scratch);
    clip(inside, axis, high[axis], 1, scratch);
  }
  double twice = 0;
  for (std::size_t k = 0; k < inside.size(); ++k) {
    const std::array<double, 2>&a = inside[k], &b = inside[(k + 1) % inside.size()];
    twice += (a[0] - low[0]) * (b[1] - low[1]) - (b[0] - low[0]) * (a[1] - low[1]);
  }
  return std::max(0.0, twice / 2);
}

// Gauss-Legendre quadrature in u with h = depth u^2, because the section of a cylinder grows as sqrt(h).
std::vector<PressedSection> pressedSections(const Indenter& indenter, double exponent, double depth) {
  std::vector<PressedSection> sections;
  if (depth <= 0) return sections;
  for (std::size_t k = 0; k < kNodes.size(); ++k) {
    const double u = kNodes[k], h = depth * u * u;
    sections.push_back({h, kWeights[k] * indenter.sectionAt(h) * exponent * std::pow(depth - h, exponent - 1) * 2 * depth * u});
  }
  return sections;
}

double volumeUnder(const Indenter& indenter, double exponent, double depth) {
  double sum = 0;
  for (const PressedSection& section : pressedSections(indenter, exponent, depth)) sum += section.volume;
  return sum;
}

double depthOfVolume(const Indenter& indenter, double exponent, double volume) {
  double low = 0, high = 1e-6;
  while (volumeUnder(indenter, exponent, high) < volume && high < 1) high *= 2;
  for (int round = 0; round < 60; ++round) {
    const double middle = (low + high) / 2;
    (volumeUnder(indenter, exponent, middle) < volume ? low : high) = middle;
  }
  return high;
}

}  // namespace taxelsim
