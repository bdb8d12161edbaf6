#include "reference/layer_cell_rates.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace taxelsim::reference {
namespace {

// A covered interval of a side, from the middle of the side, in its length.
struct CellInterval {
  double length = 0;  // 0 to 1
  double middle = 0;  // -0.5 to 0.5
};

// What the cell of a node says of its sides at x = -0.5, x = 0.5, y = -0.5 and y = 0.5.
enum class Cover { kEmpty, kCut, kWhole };
struct CellSides {
  Cover cover = Cover::kEmpty;
  std::array<CellInterval, 4> side{};
};

std::array<double, 2> sidePoint(std::size_t side, double along) {
  const double across = side % 2 == 0 ? -0.5 : 0.5;
  return side < 2 ? std::array<double, 2>{across, along} : std::array<double, 2>{along, across};
}

// Share of the cell that is behind the line with this normal and offset: that of the quadrants behind it, by inclusion and exclusion.
double coveredShare(const std::array<double, 2>& normal, double offset) {
  constexpr double kLeast = 1e-6;
  const double a = std::max(std::abs(normal[0]), kLeast), b = std::max(std::abs(normal[1]), kLeast);
  const auto behind = [&](double t) { return t > 0 ? t * t / (2 * a * b) : 0; };
  return behind(offset + (a + b) / 2) - behind(offset + (a - b) / 2) - behind(offset + (b - a) / 2) + behind(offset - (a + b) / 2);
}

double offsetOfShare(const std::array<double, 2>& normal, double share) {
  double low = -1, high = 1;
  for (int halving = 0; halving < 60; ++halving) {
    const double middle = (low + high) / 2;
    (coveredShare(normal, middle) < share ? low : high) = middle;
  }
  return (low + high) / 2;
}

// The part of a side that is behind the line with this normal and offset.
CellInterval behindLine(std::size_t side, const std::array<double, 2>& normal, double offset) {
  const auto behind = [&](double along) {
    const std::array<double, 2> p = sidePoint(side, along);
    return offset - p[0] * normal[0] - p[1] * normal[1];
  };
  const double first = behind(-0.5), last = behind(0.5);
  if (first >= 0 && last >= 0) return {1, 0};
  if (first < 0 && last < 0) return {0, 0};
  const double crossing = first / (first - last) - 0.5;
  return first >= 0 ? CellInterval{crossing + 0.5, (crossing - 0.5) / 2} : CellInterval{0.5 - crossing, (crossing + 0.5) / 2};
}

CellSides sidesOf(const LayerCells& cells, const LayerNodes& nodes, std::size_t n) {
  const double covered = cells.covered[n], edge = cells.edge[n];
  if (covered == 0) return {};
  const std::array<double, 2> center{cells.place[n][0] / nodes.spacing[0], cells.place[n][1] / nodes.spacing[1]};
  const double size = std::abs(center[0]) + std::abs(center[1]);
  if (edge == 0 || size == 0) return {Cover::kWhole, {CellInterval{1, 0}, {1, 0}, {1, 0}, {1, 0}}};
  const std::array<double, 2> normal{-center[0] / size, -center[1] / size};
  const double offset = offsetOfShare(normal, covered);
  CellSides sides{Cover::kCut, {}};
  for (std::size_t side = 0; side < 4; ++side) sides.side[side] = behindLine(side, normal, offset);
  return sides;
}

CellInterval sharedSide(const CellSides& own, const CellSides& other, std::size_t side) {
  const CellInterval &a = own.side[side], &b = other.side[side ^ 1];
  if (own.cover != Cover::kCut) return a;
  if (other.cover != Cover::kCut) return b;
  const double length = (a.length + b.length) / 2;
  return {length, length > 0 ? (a.length * a.middle + b.length * b.middle) / (2 * length) : 0};
}

}  // namespace

CellRates cellRates(const LayerNodes& nodes, const LayerCells& cells, const std::vector<double>& overlap, const Motion& m) {
  const std::size_t size = cells.covered.size();
  CellRates rates{std::vector<double>(size, 0), std::vector<std::array<double, 2>>(size)};
  std::vector<CellSides> sides;
  for (std::size_t n = 0; n < size; ++n) sides.push_back(sidesOf(cells, nodes, n));
  for (int u = 0; u < nodes.num_rows; ++u) {
    for (int v = 0; v < nodes.num_cols; ++v) {
      const auto n = static_cast<std::size_t>(u * nodes.num_cols + v);
      if (sides[n].cover != Cover::kCut) continue;
      const std::array<double, 2> node{(u - (nodes.num_rows - 1) / 2.0) * nodes.spacing[0],
                                       (v - (nodes.num_cols - 1) / 2.0) * nodes.spacing[1]};
      // In the plane of the skin, in cells per unit.
      const auto velocity = [&](const std::array<double, 2>& p) {
        const double x = node[0] + p[0] * nodes.spacing[0], y = node[1] + p[1] * nodes.spacing[1];
        return std::array<double, 2>{(m.v[0] - m.w[1] * overlap[n] - m.w[2] * y) / nodes.spacing[0],
                                     (m.v[1] + m.w[2] * x + m.w[0] * overlap[n]) / nodes.spacing[1]};
      };
      const double s = cells.covered[n], edge = cells.edge[n];
      const std::array<double, 2> c{cells.place[n][0] / edge / nodes.spacing[0], cells.place[n][1] / edge / nodes.spacing[1]};
      const std::array<double, 2> inside = velocity(c);
      double area = 0;
      std::array<double, 2> moment{s * inside[0], s * inside[1]};
      for (std::size_t side = 0; side < 4; ++side) {
        const int du = side < 2 ? (side == 0 ? -1 : 1) : 0, dv = side < 2 ? 0 : (side == 2 ? -1 : 1);
        const bool is_inside = u + du >= 0 && v + dv >= 0 && u + du < nodes.num_rows && v + dv < nodes.num_cols;
        const auto next = static_cast<std::size_t>((u + du) * nodes.num_cols + v + dv);
        const CellInterval part = is_inside ? sharedSide(sides[n], sides[next], side) : sides[n].side[side];
        const std::array<double, 2> at = sidePoint(side, part.middle);
        const double flow = (side % 2 == 0 ? -1 : 1) * velocity(at)[side / 2] * part.length;
        area -= flow;
        for (std::size_t axis = 0; axis < 2; ++axis) moment[axis] -= flow * at[axis];
      }
      rates.covered[n] = area;
      for (std::size_t axis = 0; axis < 2; ++axis) rates.place[n][axis] = (moment[axis] - area * c[axis]) / s * nodes.spacing[axis];
    }
  }
  return rates;
}

std::vector<double> complianceRates(const LayerNodes& nodes, const NodeCompliance& compliance, const LayerCells& cells,
                                    const CellRates& rates) {
  // Of the motion that moves a part by a cell, or covers one, at the most.
  constexpr double kStep = 1e-4;
  double fastest = 0;
  for (std::size_t n = 0; n < cells.covered.size(); ++n) {
    if (cells.covered[n] == 0) continue;
    fastest = std::max({fastest, std::abs(rates.covered[n]) / cells.covered[n], std::abs(rates.place[n][0]) / nodes.spacing[0],
                        std::abs(rates.place[n][1]) / nodes.spacing[1]});
  }
  std::vector<double> change(cells.covered.size(), 0);
  if (fastest == 0) return change;
  const double step = kStep / fastest;
  for (const double side : {-1, 1}) {
    LayerCells moved = cells;
    for (std::size_t n = 0; n < change.size(); ++n) {
      const double edge = cells.edge[n];
      moved.covered[n] += side * step * rates.covered[n];
      moved.share[n] += side * step * edge * rates.covered[n];
      for (std::size_t axis = 0; axis < 2; ++axis) moved.place[n][axis] += side * step * edge * rates.place[n][axis];
    }
    const std::vector<double> there = cellCompliances(moved, nodes, compliance);
    for (std::size_t n = 0; n < change.size(); ++n) change[n] += side / (2 * step) * there[n];
  }
  return change;
}

}  // namespace taxelsim::reference
