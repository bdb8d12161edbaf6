// Inverse velocity kinematics by damped least squares (Levenberg-Marquardt damping): joint velocities q' that follow a twist t,
//
//   minimise |A q' - t|^2 + lambda^2 |q'|^2,    q' = A^T (A A^T + lambda^2 I)^-1 t
//
// where A has the selected rows and the free columns of the Jacobian. lambda is 0 unless the smallest singular value of A is below
// the robot's threshold (see Manipulator in taxelsim/robot.h for the formula and sources). Joint limits are handled by robots.h.
// Does not allocate.
//
// Every sum has a fixed order, so that a device computes the same bits: twin shaders/servo/damped_least_squares.glsl.
#pragma once

#include <array>

#include "taxelsim/robot.h"

namespace taxelsim {

class DampedLeastSquares {
 public:
  using Matrix = std::array<std::array<double, 6>, 6>;

  explicit DampedLeastSquares(const Manipulator& robot);

  // Writes `velocities` (num_joints); 0 for joints that are not free (`is_free`, num_joints). In a redundant robot the solution without
  // damping is that of minimum norm. `jacobian` (num_joints x 6) and `twist` (v, w) as in chain.h. Returns true if damping was applied.
  bool solve(const double* jacobian, const std::array<double, 6>& twist, const bool* is_free, double* velocities) const;

 private:
  bool damp(Matrix& gram) const;

  int num_joints_;
  int num_rows_ = 0;
  int size_;                   // of the Gram matrix
  std::array<int, 6> rows_{};  // indices of the selected coordinates of the twist
  double max_damping_squared_;
  double threshold_squared_;
};

}  // namespace taxelsim
