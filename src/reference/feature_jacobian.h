// Derivatives of the features of a force image by the twist of the sensor, given those of the taxel forces.
//
// With S = sum F, c = sum F r / S and mu = sum F (r - c)(r - c)^T / S, the product rule gives
//   dc = sum dF (r - c) / S,   dmu = (sum dF (r - c)(r - c)^T - mu dS) / S,
//   d(edge angle) = (D dmu_xy - mu_xy dD) / (D^2 + 4 mu_xy^2),   D = mu_xx - mu_yy.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "reference/features.h"
#include "reference/frame.h"

namespace taxelsim::reference {

// Derivatives by the six coordinates of the sensor's twist (v, w) in S with the objects fixed: by the position of the origin of S (per m),
// then by the rotation about it (per rad).
using ByTwist = std::array<double, 6>;

// Jacobian of one row: the whole sensor, or one patch. Zero where the feature is undefined.
struct FeatureJacobian {
  Features features;  // of the row's image; without peak_force and contact_area
  double trace = 0;   // m^2: trace of the second moments
  std::array<ByTwist, 3> center_of_pressure{};
  ByTwist total_force_by_twist{};
  ByTwist edge_angle{};
};

// Force image and its derivative by the spread force, both (num_taxels).
struct JacobianImage {
  std::vector<double> force;   // N
  std::vector<double> weight;  // d(force) / d(spread force)
};

JacobianImage cleanJacobianImage(const Frame& frame);

// After gain, trigger and saturation of the readout.
JacobianImage measuredJacobianImage(const Sensor& sensor, const Frame& frame, const ReadoutDraw& draw);

// Taxels of a row and their positions in its plane.
struct JacobianRow {
  Pose X_SC;  // C: the plane of the row, that of its patch, or S
  std::vector<std::size_t> taxels;
  std::vector<Vector3> positions;  // (taxels.size()), m, in C
};

// by_twist: (num_taxels), derivatives of the spread forces, N.
FeatureJacobian featureJacobian(const JacobianRow& row, const JacobianImage& image, std::span<const ByTwist> by_twist);

}  // namespace taxelsim::reference
