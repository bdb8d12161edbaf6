// The point spread function undone.
#pragma once

#include <Eigen/Sparse>
#include <cstddef>
#include <span>
#include <vector>

#include "taxelsim/sensor.h"

namespace taxelsim {

// F >= 0 that makes ||G F - image||_2 least, G being the spread: by block principal pivoting (L. Portugal, J. Judice and L. Vicente, A
// comparison of block pivoting and interior-point algorithms for linear least squares problems with nonnegative variables, Math. Comp. 63,
// 1994). Taxels are either held at 0 or free; the free ones are solved for exactly, those of a wrong sign change sides, all at once while
// their number falls, else the last one alone, which ends in finitely many steps. Exact but for rounding.
class Unspread {
 public:
  // Throws Error(kInput) when two different loads spread to one image.
  explicit Unspread(const Sensor& sensor);

  // (num_taxels), N. Begins with the free taxels of the image before, which of images in turn are nearly the same. Throws Error(kInput)
  // after kMaxPivots changes of sides.
  std::vector<double> forceOf(std::span<const double> image);

  static constexpr int kMaxPivots = 10000;

 private:
  // Least squares with the free taxels alone; 0 for the others.
  Eigen::VectorXd solveFree(const Eigen::VectorXd& right) const;

  Eigen::SparseMatrix<double> spread_;  // G, (taxels x sources)
  Eigen::SparseMatrix<double> normal_;  // G^T G
  std::vector<bool> free_;
};

}  // namespace taxelsim
