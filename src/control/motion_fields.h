// Tables of fields (base/field.h) of the motions of objects. checkMotion() uses them.
#pragma once

#include <array>

#include "base/field.h"
#include "taxelsim/trajectory.h"

namespace taxelsim {

inline constexpr std::array kConstantTwistFields{
    Field<Twist>{"linear_velocity[_mm]", &Twist::v, Allowed::any("m/s")},
    Field<Twist>{"angular_velocity[_deg]", &Twist::w, Allowed::any("rad/s")},
};
inline constexpr std::array kSinusoidFields{
    Field<Sinusoid>{"axis", &Sinusoid::axis, Allowed::any(""), kRequired},
    Field<Sinusoid>{"amplitude[_mm]", &Sinusoid::amplitude, Allowed::any("m")},
    Field<Sinusoid>{"angle[_deg]", &Sinusoid::angle, Allowed::any("rad")},
    Field<Sinusoid>{"frequency", &Sinusoid::frequency, Allowed::above(0, "Hz"), kRequired},
    Field<Sinusoid>{"phase[_deg]", &Sinusoid::phase, Allowed::any("rad")},
};
inline constexpr std::array kHandHeldFields{
    Field<HandHeld>{"drift[_mm]", &HandHeld::drift, Allowed::atLeast(0, "m")},
    Field<HandHeld>{"drift_angle[_deg]", &HandHeld::drift_angle, Allowed::atLeast(0, "rad")},
    Field<HandHeld>{"tremor[_mm]", &HandHeld::tremor, Allowed::atLeast(0, "m")},
    Field<HandHeld>{"tremor_angle[_deg]", &HandHeld::tremor_angle, Allowed::atLeast(0, "rad")},
    Field<HandHeld>{"drift_band", &HandHeld::drift_band, Allowed::above(0, "Hz")},
    Field<HandHeld>{"tremor_band", &HandHeld::tremor_band, Allowed::above(0, "Hz")},
};

}  // namespace taxelsim
