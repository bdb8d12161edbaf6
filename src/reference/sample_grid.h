// All samples of a patch as one grid, with the cell of each: row u = i s + a along x, column v = j s + b along y, for sample (a, b) of
// taxel (i, j).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "taxelsim/sensor.h"

namespace taxelsim::reference {

// A rectangle in the plane z = 0 of P, m.
struct Rectangle {
  std::array<double, 2> min{0, 0}, max{0, 0};

  bool isEmpty() const { return min[0] >= max[0] || min[1] >= max[1]; }
  double area() const { return (max[0] - min[0]) * (max[1] - min[1]); }
};

struct SampleGrid {
  int rows, cols, samples_per_taxel, num_cols;
  double step_x, step_y;        // m
  std::array<double, 2> shift;  // m, added to every position

  SampleGrid(const GridPatch& patch, int s, const std::array<double, 2>& shift_P = {0, 0})
      : rows(patch.num_rows * s),
        cols(patch.num_cols * s),
        samples_per_taxel(s),
        num_cols(patch.num_cols),
        step_x(patch.pitch[0] / s),
        step_y(patch.pitch[1] / s),
        shift(shift_P) {}

  std::size_t size() const { return static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols); }
  double x(int u) const { return (u - (rows - 1) / 2.0) * step_x + shift[0]; }
  double y(int v) const { return (v - (cols - 1) / 2.0) * step_y + shift[1]; }
  // Index in the order of samplesOf(), from the first sample of the patch.
  std::size_t index(int u, int v) const {
    const int s = samples_per_taxel;
    return ((static_cast<std::size_t>(u / s) * num_cols + v / s) * s + u % s) * s + v % s;
  }
  // Neighbouring cells share their borders to the bit.
  Rectangle cell(int u, int v) const {
    const auto border = [](int n, int count, double step, double offset) { return (n - count / 2.0) * step + offset; };
    return {{border(u, rows, step_x, shift[0]), border(v, cols, step_y, shift[1])},
            {border(u + 1, rows, step_x, shift[0]), border(v + 1, cols, step_y, shift[1])}};
  }
  Rectangle all() const { return {cell(0, 0).min, cell(rows - 1, cols - 1).max}; }
  // First and last sample that can lie in [min, max], widened by one on either side against rounding. Contains all samples whose cells
  // overlap [min, max].
  static std::pair<int, int> range(double min, double max, double step, double shift, int count) {
    const double middle = (count - 1) / 2.0;
    const double first = std::floor((min - shift) / step + middle) - 1, last = std::ceil((max - shift) / step + middle) + 1;
    return {static_cast<int>(std::clamp(first, 0.0, static_cast<double>(count))),
            static_cast<int>(std::clamp(last, -1.0, static_cast<double>(count - 1)))};
  }
};

}  // namespace taxelsim::reference
