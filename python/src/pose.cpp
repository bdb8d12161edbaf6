// PoseRows, and rotation matrices to quaternions.
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/vector.h>

#include <cmath>
#include <string>
#include <vector>

#include "structs.h"
#include "taxelsim/error.h"
#include "taxelsim/pose.h"

namespace taxelsim::python {
namespace {

constexpr double kRotationTolerance = 1e-3;  // as for the length of a quaternion in Simulator::setObjects()

// Quaternion (w, x, y, z) of a rotation matrix, by the largest of the four squared components (S. W. Shepperd 1978).
Quaternion quaternionOf(const double (&R)[3][3]) {
  const double squares[4] = {1 + R[0][0] + R[1][1] + R[2][2], 1 + R[0][0] - R[1][1] - R[2][2], 1 - R[0][0] + R[1][1] - R[2][2],
                             1 - R[0][0] - R[1][1] + R[2][2]};  // four times each
  int largest = 0;
  for (int i = 1; i < 4; ++i) {
    if (squares[i] > squares[largest]) largest = i;
  }
  const double products[4][4] = {{squares[0], R[2][1] - R[1][2], R[0][2] - R[2][0], R[1][0] - R[0][1]},
                                 {R[2][1] - R[1][2], squares[1], R[1][0] + R[0][1], R[0][2] + R[2][0]},
                                 {R[0][2] - R[2][0], R[1][0] + R[0][1], squares[2], R[2][1] + R[1][2]},
                                 {R[1][0] - R[0][1], R[0][2] + R[2][0], R[2][1] + R[1][2], squares[3]}};
  Quaternion q{};
  double square_sum = 0;
  for (const double product : products[largest]) square_sum += product * product;
  for (std::size_t i = 0; i < 4; ++i) q[i] = products[largest][i] / std::sqrt(square_sum);
  return q;
}

// Whether the upper 3 x 3 block is a rotation and the last row is (0, 0, 0, 1). False for NaN.
bool isRigid(const double (&X)[4][4]) {
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    const int k = (i + 2) % 3;
    double length = 0;
    double cosine = 0;
    for (int c = 0; c < 3; ++c) {
      length += X[i][c] * X[i][c];
      cosine += X[i][c] * X[j][c];
    }
    // Row k is the cross product of rows i and j, which excludes reflections.
    const double cross = X[i][1] * X[j][2] - X[i][2] * X[j][1];
    if (!(std::abs(length - 1) <= kRotationTolerance && std::abs(cosine) <= kRotationTolerance &&
          std::abs(cross - X[k][0]) <= kRotationTolerance)) {
      return false;
    }
  }
  return X[3][0] == 0 && X[3][1] == 0 && X[3][2] == 0 && X[3][3] == 1;
}

using Matrices = nb::ndarray<const double, nb::shape<-1, 4, 4>, nb::c_contig, nb::device::cpu>;
using PoseRows = nb::ndarray<double, nb::shape<-1, 7>, nb::c_contig, nb::device::cpu>;

void posesFromMatrices(const Matrices& matrices, const PoseRows& poses, int rows_per_instance) {
  for (std::size_t i = 0; i < matrices.shape(0); ++i) {
    const double* const first = matrices.data() + 16 * i;
    double X[4][4];
    for (int k = 0; k < 16; ++k) X[k / 4][k % 4] = first[k];
    if (!isRigid(X)) {
      throw Error(ErrorKind::kInput, "poses of instance " + std::to_string(i / static_cast<std::size_t>(rows_per_instance)) +
                                         ": the matrix is not allowed: rotation and translation (4 x 4), with last row 0 0 0 1");
    }
    const Quaternion q = quaternionOf({{X[0][0], X[0][1], X[0][2]}, {X[1][0], X[1][1], X[1][2]}, {X[2][0], X[2][1], X[2][2]}});
    const double pose[7] = {X[0][3], X[1][3], X[2][3], q[0], q[1], q[2], q[3]};
    std::copy(std::begin(pose), std::end(pose), poses.data() + 7 * i);
  }
}

}  // namespace

void bindPose(nb::module_& module) {
  nb::class_<Pose> pose(module, "Pose", "X_AB: the pose of frame B in frame A. The default is the identity.");
  addFields(pose, field("position", &Pose::position, "m, (3): position of B's origin in A."),
            field("rotation", &Pose::rotation, "(4): rotation of B in A as a quaternion (w, x, y, z)."));
  pose.def(
          "__mul__", [](const Pose& X_AB, const Pose& X_BC) { return X_AB * X_BC; }, nb::is_operator(), "Composition X_AC.")
      .def(
          "inverse", [](const Pose& X_AB) { return inverse(X_AB); }, "X_BA.")
      .def(
          "transform", [](const Pose& X_AB, const Vector3& p_B) { return X_AB * p_B; }, "p_B"_a, "Coordinates in A of a point in B, m.");
  module.def("axis_angle", &axisAngle, "axis"_a, "angle"_a, "Quaternion (w, x, y, z) of a rotation by `angle` (rad) about `axis`.");
  module.def("poses_from_matrices", &posesFromMatrices, "matrices"_a, "poses"_a, "rows_per_instance"_a);
}

}  // namespace taxelsim::python
