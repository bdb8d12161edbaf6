#include "control/damped_least_squares.h"

#include <Eigen/Dense>

#include "random_robots.h"
#include "support/test.h"

namespace taxelsim {
namespace {

struct Case {
  Manipulator robot;
  std::vector<double> jacobian;  // (num_joints x 6)
  std::array<double, 6> twist;
  std::array<bool, kMaxJoints> is_free{};

  Eigen::MatrixXd selected() const {
    Eigen::MatrixXd A(0, 0);
    std::vector<int> rows, columns;
    for (int i = 0; i < 6; ++i) {
      if (robot.selection[i]) rows.push_back(i);
    }
    for (int j = 0; j < static_cast<int>(robot.joints.size()); ++j) {
      if (is_free[j]) columns.push_back(j);
    }
    A.resize(static_cast<int>(rows.size()), static_cast<int>(columns.size()));
    for (int i = 0; i < A.rows(); ++i) {
      for (int j = 0; j < A.cols(); ++j) A(i, j) = jacobian[6 * columns[j] + rows[i]];
    }
    return A;
  }
  Eigen::VectorXd selectedTwist() const {
    Eigen::VectorXd v(6);
    int count = 0;
    for (int i = 0; i < 6; ++i) {
      if (robot.selection[i]) v[count++] = twist[i];
    }
    return v.head(count);
  }
};

// `factor` scales the first column of the Jacobian, to approach a singularity.
Case drawCase(double factor) {
  Case drawn;
  const int num_joints = *rc::gen::inRange(1, 10);
  drawn.robot.joints.resize(num_joints);
  bool any = false;
  for (bool& row : drawn.robot.selection) row = *rc::gen::arbitrary<bool>(), any = any || row;
  if (!any) drawn.robot.selection[5] = true;
  drawn.robot.singular_threshold = drawBetween(0.01, 1);
  drawn.robot.max_damping = drawBetween(0.01, 0.5);
  drawn.jacobian.resize(6 * static_cast<std::size_t>(num_joints));
  for (double& entry : drawn.jacobian) entry = drawBetween(-1, 1);
  for (int i = 0; i < 6; ++i) drawn.jacobian[i] *= factor;
  for (int j = 0; j < num_joints; ++j) drawn.is_free[j] = *rc::gen::inRange(0, 4) > 0;
  for (double& component : drawn.twist) component = drawBetween(-1, 1);
  return drawn;
}

// Compares with the closed form by singular value decomposition: q' = V diag(s / (s^2 + lambda^2)) U^T t.
void expectSvdSolution(const Case& drawn) {
  const Eigen::MatrixXd A = drawn.selected();
  std::vector<double> velocities(drawn.robot.joints.size(), 7);
  const bool is_singular =
      DampedLeastSquares(drawn.robot).solve(drawn.jacobian.data(), drawn.twist, drawn.is_free.data(), velocities.data());
  if (A.cols() == 0) {
    for (const double velocity : velocities) RC_ASSERT(velocity == 0);
    return;
  }
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(A, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const Eigen::VectorXd s = svd.singularValues();
  const double ratio = s.minCoeff() / drawn.robot.singular_threshold;
  // The Gram matrix squares singular values: at the threshold the two may disagree whether to damp, with damping close to 0.
  if (std::abs(ratio - 1) > 1e-9) RC_ASSERT(is_singular == (ratio < 1));
  const double damping = ratio < 1 ? drawn.robot.max_damping * drawn.robot.max_damping * (1 - ratio * ratio) : 0;
  const Eigen::VectorXd q = svd.matrixV() * (s.array() / (s.array().square() + damping)).matrix().asDiagonal() * svd.matrixU().transpose() *
                            drawn.selectedTwist();
  // Condition number of the Gram matrix (at most 60 / 0.01^2 = 6e5, by threshold or damping) x tens of rounding errors x norm of the
  // solution (|twist| / 0.01 = 245). Near the threshold the error of the damping is that of the smallest eigenvalue, 1e-14.
  constexpr double kTolerance = 60e4 * 1e-14 * 245;
  int column = 0;
  for (std::size_t j = 0; j < velocities.size(); ++j) {
    const double expected = drawn.is_free[j] ? q[column++] : 0;
    RC_ASSERT(std::abs(velocities[j] - expected) <= (drawn.is_free[j] ? kTolerance : 0));
  }
}

RC_GTEST_PROP(DampedLeastSquares, MatchesTheSvdSolution, ()) {
  expectSvdSolution(drawCase(1));
}

RC_GTEST_PROP(DampedLeastSquares, MatchesTheSvdSolutionNearSingularities, ()) {
  expectSvdSolution(drawCase(*rc::gen::element(0.0, 1e-8, 1e-3, 0.1)));
}

// s / (s^2 + lambda^2) <= 1 / (2 lambda) bounds the joint velocities.
RC_GTEST_PROP(DampedLeastSquares, BoundsVelocitiesAtASingularity, ()) {
  Case drawn = drawCase(0);
  drawn.is_free.fill(true);
  drawn.robot.selection = {true, false, false, false, false, false};
  for (std::size_t j = 0; j < drawn.robot.joints.size(); ++j) drawn.jacobian[6 * j] *= 1e-9;
  std::vector<double> velocities(drawn.robot.joints.size());
  RC_ASSERT(DampedLeastSquares(drawn.robot).solve(drawn.jacobian.data(), drawn.twist, drawn.is_free.data(), velocities.data()));
  double square = 0;
  for (const double velocity : velocities) square += velocity * velocity;
  RC_ASSERT(std::sqrt(square) <= std::abs(drawn.twist[0]) / (2 * drawn.robot.max_damping) * (1 + 1e-9));
}

}  // namespace
}  // namespace taxelsim
