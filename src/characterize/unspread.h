// Deconvolution: forces from an image blurred by the point spread function.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "taxelsim/sensor.h"

namespace taxelsim {

// Non-negative least squares: minimises ||G F - image||_2 over F >= 0, where G is the point spread matrix, by block principal pivoting
// (L. Portugal, J. Judice and L. Vicente, A comparison of block pivoting and interior-point algorithms for linear least squares problems
// with nonnegative variables, Math. Comp. 63, 1994). Taxels are in the active set (F = 0) or free. Each step solves for the free ones and
// swaps those of wrong sign: all at once while their number falls, else the last one only, which terminates. Exact up to rounding.
class Unspread {
 public:
  // Throws Error(kInput) if G is singular.
  explicit Unspread(const Sensor& sensor);
  ~Unspread();
  Unspread(const Unspread&) = delete;
  Unspread& operator=(const Unspread&) = delete;

  // (num_taxels), N. Starts from the active set of the previous image, because successive images are similar. Throws Error(kInput) after
  // kMaxPivots steps.
  std::vector<double> forceOf(std::span<const double> image);

  static constexpr int kMaxPivots = 10000;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace taxelsim
