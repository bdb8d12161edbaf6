#include "control/damped_least_squares.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace taxelsim {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

// Returns the smallest eigenvalue of a Gram matrix if it is below `threshold`, else any value that is not below. The trace of the inverse
// is at least 1 / smallest eigenvalue; this cheap bound avoids the eigenvalue decomposition of most matrices that are far from singular.
double smallestEigenvalueBelow(const Matrix6& gram, const Eigen::LLT<Matrix6>& factor, double threshold) {
  if (factor.info() == Eigen::Success) {
    const Matrix6 inverse = factor.matrixL().solve(Matrix6::Identity());
    const double bound = 1 / inverse.squaredNorm();
    if (bound >= threshold) return bound;
  }
  return std::max(0.0, Eigen::SelfAdjointEigenSolver<Matrix6>(gram, Eigen::EigenvaluesOnly).eigenvalues()[0]);
}

}  // namespace

DampedLeastSquares::DampedLeastSquares(const Manipulator& robot)
    : num_joints_(static_cast<int>(robot.joints.size())), max_damping_(robot.max_damping), threshold_(robot.singular_threshold) {
  for (int i = 0; i < 6; ++i) {
    if (robot.selection[i]) rows_[num_rows_++] = i;
  }
}

// Uses A^T (A A^T + lambda^2 I)^-1 t, or the equal (A^T A + lambda^2 I)^-1 A^T t if A has more rows than columns, so that the Gram matrix
// is at most 6 x 6. A smaller one is padded with the identity; its eigenvalues of 1 have no effect, since the threshold is at most 1.
bool DampedLeastSquares::solve(const double* jacobian, const std::array<double, 6>& twist, const bool* is_free, double* velocities) const {
  std::fill_n(velocities, num_joints_, 0.0);
  std::array<int, kMaxJoints> columns;
  int num_columns = 0;
  for (int j = 0; j < num_joints_; ++j) {
    if (is_free[j]) columns[num_columns++] = j;
  }
  if (num_columns == 0) return false;
  const bool is_wide = num_columns >= num_rows_;
  const int size = is_wide ? num_rows_ : num_columns;
  const int inner = is_wide ? num_columns : num_rows_;
  const auto at = [&](int row, int column) { return jacobian[6 * columns[column] + rows_[row]]; };
  const auto entry = [&](int i, int k) { return is_wide ? at(i, k) : at(k, i); };

  Matrix6 gram = Matrix6::Identity();
  Vector6 rhs = Vector6::Zero();
  for (int i = 0; i < size; ++i) {
    for (int j = 0; j <= i; ++j) {
      double sum = 0;
      for (int k = 0; k < inner; ++k) sum += entry(i, k) * entry(j, k);
      gram(i, j) = gram(j, i) = sum;
    }
    if (is_wide) {
      rhs[i] = twist[rows_[i]];
    } else {
      for (int k = 0; k < inner; ++k) rhs[i] += entry(i, k) * twist[rows_[k]];
    }
  }

  const double threshold = threshold_ * threshold_;
  Eigen::LLT<Matrix6> factor(gram);
  const double smallest = smallestEigenvalueBelow(gram, factor, threshold);
  const bool is_singular = smallest < threshold;
  if (is_singular) {
    gram.diagonal().array() += max_damping_ * max_damping_ * (1 - smallest / threshold);
    factor.compute(gram);
  }
  const Vector6 solution = factor.solve(rhs);
  for (int j = 0; j < num_columns; ++j) {
    if (is_wide) {
      for (int i = 0; i < size; ++i) velocities[columns[j]] += at(i, j) * solution[i];
    } else {
      velocities[columns[j]] = solution[j];
    }
  }
  return is_singular;
}

}  // namespace taxelsim
