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

// Words for the choices of a servo, in the order of their enumerations.
inline constexpr std::array<std::string_view, 4> kEdgeAngleSourceNames{"principal_axis", "window", "ridge", "exact"};
inline constexpr std::array<std::string_view, 2> kServoContactNames{"whole", "largest_region"};
inline constexpr std::array<std::string_view, 2> kJacobianSourceNames{"nominal", "measured"};

inline constexpr Allowed kForceReference = Allowed::within(0, 1e6, "N");
inline constexpr Allowed kEdgeAngleReference = Allowed::aboveUpTo(-std::numbers::pi / 2, std::numbers::pi / 2, "rad");

inline constexpr std::array kServoFields{
    Field<TactileServo>{"exploration_velocity[_mm]", &TactileServo::exploration_velocity, Allowed::any("m/s"), kOptional,
                        "Velocity along exploration_direction; needs an edge angle"},
    Field<TactileServo>{"exploration_direction[_deg]", &TactileServo::exploration_direction,
                        Allowed::within(-std::numbers::pi, std::numbers::pi, "rad"), kOptional,
                        "Direction from that of the edge: 0 along it, 90 deg across it"},
    Field<TactileServo>{"max_angular_velocity[_deg]", &TactileServo::max_angular_velocity, Allowed::above(0, "rad/s"), kOptional,
                        "Largest angular velocity of the sensor"},
    Field<TactileServo>{"max_linear_velocity[_mm]", &TactileServo::max_linear_velocity, Allowed::above(0, "m/s"), kOptional,
                        "Largest linear velocity of the sensor"},
    Field<TactileServo>{"min_confidence", &TactileServo::min_confidence, Allowed::within(0, 1, ""), kOptional,
                        "Confidence below which edge angle and tilt are not controlled"},
};

// Fields of the loop of one feature, in its units.
std::span<const Field<FeatureLoop>> loopFields(ServoFeature feature);

// Throws Error with a field for a gain, reference or limit out of range, for conflicting features, and if no feature is selected.
void checkServo(const TactileServo& servo);

}  // namespace taxelsim
