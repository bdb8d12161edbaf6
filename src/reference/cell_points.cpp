#include "reference/cell_points.h"

#include <algorithm>
#include <cmath>

namespace taxelsim::reference {

CellPoints cellPoints(const CellDepth& cell, const std::array<double, 2>& step, double most_deep) {
  const double mean = cell.mean / cell.share;
  const double variance = std::max(cell.square / cell.share - mean * mean, 0.0);
  const double deviation = std::sqrt(variance);
  // The depths that leave mean and variance as they are, where neither is below 0; else 0 and the other one.
  CellPoints points;
  points[0] = {.weight = 1 - most_deep, .depth = mean - deviation * std::sqrt(most_deep / (1 - most_deep))};
  points[1] = {.weight = most_deep, .depth = mean + deviation * std::sqrt((1 - most_deep) / most_deep)};
  if (points[0].depth < 0) {
    const double deep = mean * mean / (mean * mean + variance);
    points[0] = {.weight = 1 - deep, .depth = 0};
    points[1] = {.weight = deep, .depth = mean / deep};
  }

  const double x = cell.moment[0] / cell.mean, y = cell.moment[1] / cell.mean, size = std::hypot(x, y);  // m, from the middle
  const bool is_even = std::hypot(x / step[0], y / step[1]) <= kEvenCell;
  const std::array<double, 2> deeper = is_even ? std::array<double, 2>{1, 0} : std::array<double, 2>{x / size, y / size};
  const std::array<double, 2> left{-deeper[1], deeper[0]};
  const double along = std::hypot(deeper[0] * step[0], deeper[1] * step[1]), across = std::hypot(deeper[1] * step[0], deeper[0] * step[1]);
  const double strip = cell.share * along;
  const double lever = std::sqrt(points[0].weight / points[1].weight);  // of the deeper point, in standard deviations of the strip's places
  const std::array<double, 2> levers{-1 / lever, lever};
  for (std::size_t k = 0; k < 2; ++k) {
    const double forward = (along - strip) / 2 + levers[k] * strip / std::sqrt(12), sideways = levers[k] * across / std::sqrt(12);
    for (std::size_t axis = 0; axis < 2; ++axis) points[k].from_middle[axis] = deeper[axis] * forward + left[axis] * sideways;
  }
  return points;
}

}  // namespace taxelsim::reference
