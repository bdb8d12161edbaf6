// From a twist to joint velocities, for one instance: damped least squares over the joints that are free to move. Not the limits; robots.h
// has those. No allocation.
#pragma once

#include <array>

#include "taxelsim/robot.h"

namespace taxelsim {

class DampedLeastSquares {
 public:
  explicit DampedLeastSquares(const Manipulator& robot);

  // Velocities (num_joints) that minimise |J q' - twist|^2 + lambda^2 |q'|^2 over the selected coordinates, 0 for joints that are not
  // `free` (num_joints); without damping and with more joints than coordinates, the smallest of all that follow the twist. `jacobian`
  // (num_joints x 6) and `twist` (6) as Chain has them. Returns whether the Jacobian was so near a singularity that it was damped.
  bool solve(const double* jacobian, const std::array<double, 6>& twist, const bool* free, double* velocities) const;

 private:
  int num_joints_;
  int num_rows_ = 0;
  std::array<int, 6> rows_{};  // selected
  double max_damping_;
  double threshold_;
};

}  // namespace taxelsim
