// Tables of fields (base/field.h) of the motions of objects. checkMotion() uses them.
#pragma once

#include <array>
#include <string_view>

#include "base/field.h"
#include "taxelsim/trajectory.h"

namespace taxelsim {

inline constexpr std::array kConstantTwistFields{
    Field<Twist>{"linear_velocity[_mm]", &Twist::v, Allowed::any("m/s"), kOptional, "Linear velocity in the axes of M"},
    Field<Twist>{"angular_velocity[_deg]", &Twist::w, Allowed::any("rad/s"), kOptional, "Angular velocity in the axes of M"},
};
inline constexpr std::array kSinusoidFields{
    Field<Sinusoid>{"axis", &Sinusoid::axis, Allowed::any(""), kRequired, "Axis, of any length but 0"},
    Field<Sinusoid>{"amplitude[_mm]", &Sinusoid::amplitude, Allowed::any("m"), kOptional, "Amplitude along the axis"},
    Field<Sinusoid>{"angle[_deg]", &Sinusoid::angle, Allowed::any("rad"), kOptional, "Amplitude of the rotation about the axis"},
    Field<Sinusoid>{"frequency", &Sinusoid::frequency, Allowed::above(0, "Hz"), kRequired, "Frequency"},
    Field<Sinusoid>{"phase[_deg]", &Sinusoid::phase, Allowed::any("rad"), kOptional, "Phase"},
};
inline constexpr std::array<std::string_view, 2> kInterpolationNames{"linear", "cubic"};  // in the order of Waypoints::Interpolation
inline constexpr std::array kHandHeldFields{
    Field<HandHeld>{"drift[_mm]", &HandHeld::drift, Allowed::atLeast(0, "m"), kOptional,
                    "Root mean square of the slow motion along each axis; an assumption"},
    Field<HandHeld>{"drift_angle[_deg]", &HandHeld::drift_angle, Allowed::atLeast(0, "rad"), kOptional,
                    "Root mean square of the slow rotation about each axis; an assumption"},
    Field<HandHeld>{"tremor[_mm]", &HandHeld::tremor, Allowed::atLeast(0, "m"), kOptional,
                    "Root mean square of the tremor along each axis; an assumption"},
    Field<HandHeld>{"tremor_angle[_deg]", &HandHeld::tremor_angle, Allowed::atLeast(0, "rad"), kOptional,
                    "Root mean square of the tremor about each axis; an assumption"},
    Field<HandHeld>{"drift_band", &HandHeld::drift_band, Allowed::above(0, "Hz"), kOptional,
                    "Frequencies of the slow motion, [min, max]; an assumption"},
    Field<HandHeld>{"tremor_band", &HandHeld::tremor_band, Allowed::above(0, "Hz"), kOptional,
                    "Frequencies of the tremor, [min, max], of physiological tremor (Elble 2003; Novak and Newell 2017)"},
};

}  // namespace taxelsim
