// Tables of fields (base/field.h) of the settings of a tactile servo, and their check.
#pragma once

#include <array>
#include <numbers>
#include <span>
#include <string_view>

#include "base/field.h"
#include "taxelsim/control.h"

namespace taxelsim {

// Names of the features in files, in the order of ServoFeature.
inline constexpr std::array<std::string_view, kNumServoFeatures> kServoFeatureNames{
    "center_x", "center_y", "center_across", "total_force", "edge_angle", "tilt_x", "tilt_y"};

inline constexpr Allowed kForceReference = Allowed::within(0, 1e6, "N");
inline constexpr Allowed kEdgeAngleReference = Allowed::aboveUpTo(-std::numbers::pi / 2, std::numbers::pi / 2, "rad");

inline constexpr std::array kServoFields{
    Field<TactileServo>{"exploration_velocity[_mm]", &TactileServo::exploration_velocity, Allowed::any("m/s")},
    Field<TactileServo>{"exploration_direction[_deg]", &TactileServo::exploration_direction,
                        Allowed::within(-std::numbers::pi, std::numbers::pi, "rad")},
    Field<TactileServo>{"max_angular_velocity[_deg]", &TactileServo::max_angular_velocity, Allowed::above(0, "rad/s")},
    Field<TactileServo>{"max_linear_velocity[_mm]", &TactileServo::max_linear_velocity, Allowed::above(0, "m/s")},
    Field<TactileServo>{"min_confidence", &TactileServo::min_confidence, Allowed::within(0, 1, "")},
};

// Fields of the loop of one feature, in its units.
std::span<const Field<FeatureLoop>> loopFields(ServoFeature feature);

// Throws Error with a field for a gain, reference or limit out of range, for conflicting features, and if no feature is selected.
void checkServo(const TactileServo& servo);

}  // namespace taxelsim
