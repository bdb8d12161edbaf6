#include "control/singularity.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cassert>

#include "control/chain.h"

namespace taxelsim {

double smallestSingularValue(const Manipulator& robot, std::span<const double> q) {
  const int num_joints = static_cast<int>(robot.joints.size());
  assert(static_cast<int>(q.size()) == num_joints);
  std::array<double, kMaxJoints * 6> jacobian;
  Chain(robot.sensors.front(), num_joints).poseAt(q.data(), jacobian.data());
  const auto num_rows = std::count(robot.selection.begin(), robot.selection.end(), true);
  Eigen::MatrixXd selected(num_rows, num_joints);
  for (int j = 0; j < num_joints; ++j) {
    for (int k = 0, row = 0; k < 6; ++k) {
      if (robot.selection[k]) selected(row++, j) = jacobian[6 * j + k];
    }
  }
  if (selected.size() == 0) return 0;
  return selected.jacobiSvd().singularValues().minCoeff();
}

}  // namespace taxelsim
