#include "reference/cell_points.h"

#include <algorithm>
#include <cmath>

namespace taxelsim::reference {

CellPoints cellPoints(const CellDepth& cell, const std::array<double, 2>& step) {
  const double mean = cell.mean / cell.share;
  const double variance = std::max(cell.square / cell.share - mean * mean, 0.0);
  // Depths mean - deviation and mean + deviation, of half the part each; none is below 0.
  const double deviation = std::sqrt(variance);
  const bool is_wide = deviation > mean;
  const double deep = is_wide ? mean * mean / (mean * mean + variance) : 0.5;
  CellPoints points;
  points[0] = {.weight = 1 - deep, .depth = is_wide ? 0 : mean - deviation};
  points[1] = {.weight = deep, .depth = is_wide ? mean + variance / mean : mean + deviation};

  const double x = cell.moment[0] / cell.mean, y = cell.moment[1] / cell.mean, size = std::hypot(x, y);  // m, from the middle
  const bool is_even = std::hypot(x / step[0], y / step[1]) <= kEvenCell;
  const std::array<double, 2> deeper = is_even ? std::array<double, 2>{1, 0} : std::array<double, 2>{x / size, y / size};
  const double along = std::hypot(deeper[0] * step[0], deeper[1] * step[1]), across = std::hypot(deeper[1] * step[0], deeper[0] * step[1]);
  const double strip = cell.share * along, middle = (along - strip) / 2, reach = std::sqrt((strip * strip + across * across) / 12);
  for (std::size_t axis = 0; axis < 2; ++axis) {
    points[0].from_middle[axis] = deeper[axis] * (middle - reach * std::sqrt(deep / (1 - deep)));
    points[1].from_middle[axis] = deeper[axis] * (middle + reach * std::sqrt((1 - deep) / deep));
  }
  return points;
}

}  // namespace taxelsim::reference
