// Tables of fields (base/field.h) of the settings of a robot. checkRobot() uses them.
#pragma once

#include <array>

#include "base/field.h"
#include "taxelsim/robot.h"

namespace taxelsim {

inline constexpr std::array kManipulatorFields{
    Field<Manipulator>{"max_damping", &Manipulator::max_damping, Allowed::above(0, "")},
    Field<Manipulator>{"singular_threshold", &Manipulator::singular_threshold, Allowed::aboveUpTo(0, 1, "")},
};
inline constexpr std::array kDriveFields{
    Field<JointDrive>{"position_step[_deg]", &JointDrive::position_step, Allowed::atLeast(0, "rad")},
    Field<JointDrive>{"delay", &JointDrive::delay, Allowed::within(0, kMaxDelayTicks, "control periods")},
};
inline constexpr std::array kJointFields{
    Field<Joint>{"max_velocity", &Joint::max_velocity, Allowed::above(0, "rad/s or m/s"), kUnlimited},
};
inline constexpr std::array kChainJointFields{
    Field<ChainJoint>{"multiplier", &ChainJoint::multiplier, Allowed::any("")},
    Field<ChainJoint>{"offset", &ChainJoint::offset, Allowed::any("rad or m")},
};
inline constexpr std::array kPanTiltFields{
    Field<PanTilt>{"tilt_height[_mm]", &PanTilt::tilt_height, Allowed::any("m")},
    Field<PanTilt>{"position_limits[_deg]", &PanTilt::position_limits, Allowed::any("rad")},
    Field<PanTilt>{"max_velocity[_deg]", &PanTilt::max_velocity, Allowed::above(0, "rad/s")},
};
inline constexpr std::array kUrdfFields{
    Field<UrdfOptions>{"velocity_limit_scale", &UrdfOptions::velocity_limit_scale, Allowed::aboveUpTo(0, 1, "")},
};

}  // namespace taxelsim
