/// @file
/// Deviation of one instance's skin and readout from those of its sensor, as factors. Gains and noise are in ReadoutVariation.
#pragma once

#include <string>

#include "taxelsim/sensor.h"

namespace taxelsim {

inline constexpr double kMinStiffnessFactor = 0.05;  ///< SkinVariation::stiffness.
inline constexpr double kMaxSkinFactor = 20;         ///< Of every factor of SkinVariation.

/// Factors on settings of a sensor; the defaults leave it as it is.
struct SkinVariation {
  /// On all moduli of the skin alike: springs, dampers and tangential springs. kMinStiffnessFactor to kMaxSkinFactor. Only with Winkler,
  /// MassSpringDamper and LuGre.
  float stiffness = 1;
  /// On `friction_coefficient`, or on the whole shear of LuGre; 0 to kMaxSkinFactor. Only with Winkler and LuGre; the coefficient stays
  /// within kMaxFrictionCoefficient.
  float friction = 1;
  float trigger = 1;     ///< On the trigger of every taxel, 0 to kMaxSkinFactor.
  float hysteresis = 1;  ///< On every hysteresis_strength, 0 to kMaxSkinFactor; the sum of strengths stays below 1.
  float delay = 1;       ///< On Readout::delay, 0 to kMaxSkinFactor; the product is at most kMaxDelaySteps steps.
  /// On the root mean square width of the point spread function, 0 to kMaxSkinFactor. A share w^2 of each force is spread by the sensor's
  /// function and 1 - w^2 stays on its taxel, which keeps the sum of forces. Above 1 the weight of a kernel's middle stays positive; at
  /// most 1 for a function given by `sigma`.
  float psf_width = 1;
  /// Standard deviation of the logarithm of a further factor on the trigger of each taxel, drawn once per episode; 0 to kMaxGainSpread.
  float trigger_spread = 0;

  bool operator==(const SkinVariation&) const = default;  ///< Exact comparison.
};

/// Throws Error(kInput) with the field, its value and what this sensor allows.
void checkVariation(const Sensor& sensor, const SkinVariation& variation);

/// The sensor whose own settings include the variation, apart from `psf_width` and `trigger_spread`.
Sensor variedSensor(const Sensor& sensor, const SkinVariation& variation);

}  // namespace taxelsim
