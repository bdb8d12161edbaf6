// Tactile Jacobian of the reference: derivatives of the features by the twist of the sensor, computed from a single frame.
//
//   twist of the sensor -> motion of the objects as seen from a patch -> rates of the taxel forces    (pressure_transport.h, layer_rates.h)
//     -> taxel law, PSF -> rates of the moments of the image -> rates of the features                  (feature_jacobian.h)
//
// Tactile servoing uses the inverse of this Jacobian (Q. Li, C. Schuermann, R. Haschke and H. Ritter, "A control framework for tactile
// servoing", RSS 2013).
#pragma once

#include <array>
#include <vector>

#include "reference/feature_jacobian.h"
#include "reference/frame.h"

namespace taxelsim::reference {

struct TactileJacobian {
  std::vector<ByTwist> taxel_force;                              // (num_taxels), N: contact forces, before the taxel law
  std::vector<ByTwist> spread_force;                             // (num_taxels), N
  std::array<ByTwist, 6> contact_wrench{};                       // N, N m: of the pressures
  FeatureJacobian clean, measured;                               // of the whole sensor
  std::vector<FeatureJacobian> clean_patches, measured_patches;  // (num_patches); empty for a list of taxels
};

// Jacobian at a frame of simulateFrame(), for a sensor and objects at rest. Measured features are those of the clean forces after gain,
// trigger and saturation, without noise, lag and quantisation.
TactileJacobian tactileJacobian(const Sensor& sensor, const Frame& frame, const ReadoutDraw& draw = {});

}  // namespace taxelsim::reference
