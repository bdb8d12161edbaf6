// Tables of fields (base/field.h) of the settings of a robot. checkRobot() uses them.
#pragma once

#include <array>

#include "base/field.h"
#include "taxelsim/robot.h"

namespace taxelsim {

inline constexpr std::array kManipulatorFields{
    Field<Manipulator>{"max_damping", &Manipulator::max_damping, Allowed::above(0, ""), kOptional,
                       "Largest damping lambda of the joint velocities at a singular pose"},
    Field<Manipulator>{"singular_threshold", &Manipulator::singular_threshold, Allowed::aboveUpTo(0, 1, ""), kOptional,
                       "Smallest singular value of the Jacobian below which the joint velocities are damped"},
};
inline constexpr std::array kDriveFields{
    Field<JointDrive>{"position_step[_deg]", &JointDrive::position_step, Allowed::atLeast(0, "rad"), kOptional,
                      "Joints stop at multiples of this angle (m of a prismatic joint); 0 for none"},
    Field<JointDrive>{"delay", &JointDrive::delay, Allowed::within(0, kMaxDelayTicks, "steps"), kOptional,
                      "Simulation steps from a command to the joint"},
};
inline constexpr std::array kJointFields{
    Field<Joint>{"max_velocity", &Joint::max_velocity, Allowed::above(0, "rad/s or m/s"), kUnlimited, "Largest velocity"},
};
inline constexpr std::array kChainJointFields{
    Field<ChainJoint>{"multiplier", &ChainJoint::multiplier, Allowed::any(""), kOptional, "Position per position of the mimicked joint"},
    Field<ChainJoint>{"offset", &ChainJoint::offset, Allowed::any("rad or m"), kOptional, "Position at 0 of the mimicked joint"},
};
inline constexpr std::array kPanTiltFields{
    Field<PanTilt>{"tilt_height[_mm]", &PanTilt::tilt_height, Allowed::any("m"), kOptional,
                   "Height of the tilt axis over the base; an assumption"},
    Field<PanTilt>{"position_limits[_deg]", &PanTilt::position_limits, Allowed::any("rad"), kOptional, "[min, max] of both joints"},
    Field<PanTilt>{"max_velocity[_deg]", &PanTilt::max_velocity, Allowed::above(0, "rad/s"), kOptional,
                   "Largest velocity of both joints; that of an AX-12 without load at 12 V"},
};
inline constexpr std::array kUrdfFields{
    Field<UrdfOptions>{"velocity_limit_scale", &UrdfOptions::velocity_limit_scale, Allowed::aboveUpTo(0, 1, ""), kOptional,
                       "Factor on the velocity limits of the file"},
};

}  // namespace taxelsim
