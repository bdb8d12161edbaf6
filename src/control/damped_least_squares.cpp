#include "control/damped_least_squares.h"

#include <algorithm>
#include <cmath>

namespace taxelsim {
namespace {

using Vector = std::array<double, 6>;
using Matrix = DampedLeastSquares::Matrix;

// Factor L of a symmetric matrix L L^T, in place: the lower triangle, with the inverses of the diagonal on it. Returns whether the matrix
// is positive definite; entries of the factor are not finite if it is not.
bool factorize(Matrix& a, int size) {
  bool is_positive = true;
  for (int j = 0; j < size; ++j) {
    double pivot = a[j][j];
    for (int k = 0; k < j; ++k) pivot -= a[j][k] * a[j][k];
    is_positive = is_positive && pivot > 0;
    a[j][j] = 1 / std::sqrt(pivot);
    for (int i = j + 1; i < size; ++i) {
      double sum = a[i][j];
      for (int k = 0; k < j; ++k) sum -= a[i][k] * a[j][k];
      a[i][j] = sum * a[j][j];
    }
  }
  return is_positive;
}

// Solves L L^T x = b in place.
void solveFactorized(const Matrix& factor, int size, Vector& x) {
  for (int i = 0; i < size; ++i) {
    for (int k = 0; k < i; ++k) x[i] -= factor[i][k] * x[k];
    x[i] *= factor[i][i];
  }
  for (int i = size - 1; i >= 0; --i) {
    for (int k = i + 1; k < size; ++k) x[i] -= factor[k][i] * x[k];
    x[i] *= factor[i][i];
  }
}

// Smallest eigenvalue of a symmetric matrix by cyclic Jacobi rotations (G. H. Golub, C. F. Van Loan, Matrix Computations, section 8.5).
// They converge quadratically, after 4 to 7 sweeps.
double smallestEigenvalue(Matrix a, int size) {
  constexpr int kMaxSweeps = 20;
  constexpr double kNegligible = 1e-17;  // of the trace
  double trace = 0;
  for (int j = 0; j < size; ++j) trace += a[j][j];
  bool rotates = true;
  for (int sweep = 0; rotates && sweep < kMaxSweeps; ++sweep) {
    rotates = false;
    for (int q = 1; q < size; ++q) {
      for (int p = 0; p < q; ++p) {
        const double entry = a[p][q];
        if (!(std::abs(entry) > kNegligible * trace)) continue;
        rotates = true;
        const double ratio = (a[q][q] - a[p][p]) / (2 * entry);
        const double size_of_tangent = 1 / (std::abs(ratio) + std::sqrt(ratio * ratio + 1));
        const double tangent = ratio < 0 ? -size_of_tangent : size_of_tangent;
        const double cosine = 1 / std::sqrt(tangent * tangent + 1), sine = tangent * cosine;
        a[p][p] -= tangent * entry;
        a[q][q] += tangent * entry;
        a[p][q] = a[q][p] = 0;
        for (int r = 0; r < size; ++r) {
          if (r == p || r == q) continue;
          const double rp = a[r][p], rq = a[r][q];
          a[r][p] = a[p][r] = cosine * rp - sine * rq;
          a[r][q] = a[q][r] = sine * rp + cosine * rq;
        }
      }
    }
  }
  double smallest = a[0][0];
  for (int j = 1; j < size; ++j) smallest = a[j][j] < smallest ? a[j][j] : smallest;
  return smallest;
}

}  // namespace

DampedLeastSquares::DampedLeastSquares(const Manipulator& robot)
    : num_joints_(static_cast<int>(robot.joints.size())),
      max_damping_squared_(robot.max_damping * robot.max_damping),
      threshold_squared_(robot.singular_threshold * robot.singular_threshold) {
  for (int i = 0; i < 6; ++i) {
    if (robot.selection[i]) rows_[num_rows_++] = i;
  }
  size_ = std::min(num_rows_, num_joints_);
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
  const int used = is_wide ? num_rows_ : num_columns;
  const int inner = is_wide ? num_columns : num_rows_;
  const auto at = [&](int row, int column) { return jacobian[6 * columns[column] + rows_[row]]; };
  const auto entry = [&](int i, int k) { return is_wide ? at(i, k) : at(k, i); };

  Matrix gram{};
  Vector solution{};
  for (int i = 0; i < size_; ++i) {
    if (i >= used) {
      gram[i][i] = 1;
      continue;
    }
    for (int j = 0; j <= i; ++j) {
      double sum = 0;
      for (int k = 0; k < inner; ++k) sum += entry(i, k) * entry(j, k);
      gram[i][j] = gram[j][i] = sum;
    }
    if (is_wide) {
      solution[i] = twist[rows_[i]];
    } else {
      for (int k = 0; k < inner; ++k) solution[i] += entry(i, k) * twist[rows_[k]];
    }
  }

  const bool is_singular = damp(gram);
  factorize(gram, size_);
  solveFactorized(gram, size_, solution);
  for (int j = 0; j < num_columns; ++j) {
    if (is_wide) {
      for (int i = 0; i < used; ++i) velocities[columns[j]] += at(i, j) * solution[i];
    } else {
      velocities[columns[j]] = solution[j];
    }
  }
  return is_singular;
}

// Adds lambda^2 to the diagonal. All eigenvalues are above the threshold if the matrix minus the threshold is positive definite.
bool DampedLeastSquares::damp(Matrix& gram) const {
  Matrix shifted = gram;
  for (int j = 0; j < size_; ++j) shifted[j][j] -= threshold_squared_;
  if (factorize(shifted, size_)) return false;
  const double eigenvalue = smallestEigenvalue(gram, size_);
  const double smallest = eigenvalue > 0 ? eigenvalue : 0;
  if (!(smallest < threshold_squared_)) return false;
  const double damping = max_damping_squared_ * (1 - smallest / threshold_squared_);
  for (int j = 0; j < size_; ++j) gram[j][j] += damping;
  return true;
}

}  // namespace taxelsim
