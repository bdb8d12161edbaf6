#include "reference/foundation_cells.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace taxelsim::reference {
namespace {

constexpr double kBetweenNodes = 0.5;
constexpr double kNearlyWholeCell = 20;
constexpr double kLeastFree = 1.0 / 500, kLeastBetweenFree = 1.0 / 8;

using Point = std::array<double, 2>;

// How far a point is behind the line with this normal and offset from the origin.
double behind(const Point& p, const Point& normal, double offset) {
  return offset - p[0] * normal[0] - p[1] * normal[1];
}

// Area of the unit square around the origin behind a line, by clipping (I. E. Sutherland and G. W. Hodgman, 1974).
double shareBehind(const Point& normal, double offset) {
  constexpr std::array<Point, 4> kSquare{{{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}};
  std::vector<Point> part;
  for (std::size_t n = 0; n < 4; ++n) {
    const Point &p = kSquare[n], &q = kSquare[(n + 1) % 4];
    const double at_p = behind(p, normal, offset), at_q = behind(q, normal, offset);
    if (at_p >= 0) part.push_back(p);
    if ((at_p >= 0) == (at_q >= 0)) continue;
    const double t = at_p / (at_p - at_q);
    part.push_back({p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])});
  }
  double twice = 0;
  for (std::size_t n = 0; n < part.size(); ++n) {
    const Point &p = part[n], &q = part[(n + 1) % part.size()];
    twice += p[0] * q[1] - q[0] * p[1];
  }
  return twice / 2;
}

double offsetWithShare(const Point& normal, double share) {
  double low = -1, high = 1;  // of a square whose corners are 0.71 from its middle
  for (int halving = 0; halving < 60; ++halving) {
    const double middle = (low + high) / 2;
    (shareBehind(normal, middle) < share ? low : high) = middle;
  }
  return (low + high) / 2;
}

// Length of the half link from the middle of a cell to its side in a direction that is behind the line.
double lengthBehind(const Point& direction, const Point& normal, double offset) {
  const double at_middle = offset, at_side = behind({direction[0] / 2, direction[1] / 2}, normal, offset);
  if (at_middle >= 0 && at_side >= 0) return 0.5;
  if (at_middle < 0 && at_side < 0) return 0;
  const double crossing = 0.5 * at_middle / (at_middle - at_side);
  return at_middle >= 0 ? crossing : 0.5 - crossing;
}

}  // namespace

FoundationCells foundationCells(const LayerCells& cells, std::span<const std::array<double, 2>> sizes, std::span<const double> heights) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  FoundationCells result;
  for (std::size_t n = 0; n < heights.size(); ++n) {
    const bool is_over = std::isfinite(heights[n]);
    const double edge = cells.edge[n], covered = cells.covered[n], mean = cells.height[n], middle = is_over ? 1 : 0;
    const double share = middle + edge * (covered - middle);
    const Point center{cells.place[n][0] / sizes[n][0], cells.place[n][1] / sizes[n][1]};
    const double size = std::hypot(center[0], center[1]);
    const Point normal = edge > 0 && size > 0 ? Point{-center[0] / size, -center[1] / size} : Point{1, 0};
    const double offset = share >= 1 ? 1 : share <= 0 ? -1 : offsetWithShare(normal, share);
    double height = heights[n];
    if (is_over && covered > 0) {
      const double whole = std::clamp(1 - kNearlyWholeCell * (1 - covered), 0.0, 1.0);
      height -= kBetweenNodes * whole * std::max(mean - height, 0.0);
      height += edge * (mean - height);
    } else if (edge > 0) {
      height = mean;
    }
    result.covered_height.push_back(height);
    result.height.push_back(offset > 0 ? height : kNone);
    result.arms.push_back({lengthBehind({-1, 0}, normal, offset), lengthBehind({1, 0}, normal, offset),
                           lengthBehind({0, -1}, normal, offset), lengthBehind({0, 1}, normal, offset)});
  }
  return result;
}

std::vector<Arms> armsAtDepth(const FoundationCells& cells, double depth) {
  std::vector<Arms> arms = cells.arms;
  for (std::size_t n = 0; n < arms.size(); ++n) {
    if (!(depth - cells.covered_height[n] > 0)) arms[n] = {};
  }
  return arms;
}

double cutLinkFactor(double a, double b, double arms, double spacing) {
  const bool any = std::max(a, b) > 0, both = std::min(a, b) > 0;
  const double free = std::max(both ? 0.5 : 1 - arms, any ? kLeastFree : kLeastBetweenFree);
  const double steep = any ? std::clamp(std::abs(a - b) / spacing - 1, 0.0, 1.0) : 1;
  return std::min(1 + steep * (1 - free) / free, 1 / kLeastFree);
}

}  // namespace taxelsim::reference
