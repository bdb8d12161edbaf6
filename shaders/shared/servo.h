// Tactile servos whose loop a device closes: constants of the servos and of the loop, and what the host sends when an episode starts.
#ifndef TAXELSIM_SHADERS_SHARED_SERVO_H
#define TAXELSIM_SHADERS_SHARED_SERVO_H

#include "shared/batch.h"
#include "shared/types.h"

TAXELSIM_LAYOUT_BEGIN

// Features in the order of taxelsim::ServoFeature.
TAXELSIM_CONSTANT kServoCenterX = 0u;
TAXELSIM_CONSTANT kServoCenterY = 1u;
TAXELSIM_CONSTANT kServoCenterAcross = 2u;
TAXELSIM_CONSTANT kServoTotalForce = 3u;
TAXELSIM_CONSTANT kServoEdgeAngle = 4u;
TAXELSIM_CONSTANT kServoTiltX = 5u;
TAXELSIM_CONSTANT kServoTiltY = 6u;
TAXELSIM_CONSTANT kServoFeatures = 7u;

// PID loop of one feature, include/taxelsim/control.h. SI units of the feature.
struct FeatureLoopRecord {
  dvec2 gains;     // kp, 1/s; ki, 1/s^2
  dvec2 error;     // reference; limit
  dvec2 integral;  // limit; rolling radius, m
  dvec2 change;    // kd; limit of the derivative
};

struct ServoRecord {
  FeatureLoopRecord loops[kServoFeatures];
  dvec2 exploration;  // cosine and sine of the exploration's direction
  dvec2 limits;       // linear velocity, m/s; angular velocity, rad/s
  dvec2 confidence;   // least one; 0
  uvec4 flags;        // bit per feature: selected; bit per feature: has a reference; kServoFlag...; 0
};

TAXELSIM_CONSTANT kServoFlagWindow = 1u;  // the edge angle is the windowed one
TAXELSIM_CONSTANT kServoFlagRidge = 2u;   // the edge angle is that of the ridge
TAXELSIM_CONSTANT kServoFlagRegion = 4u;  // the features are those of the largest region

// Constants that all loops of a batch share.
struct LoopRecord {
  dvec2 time;          // step of the simulation, control period, s
  dvec2 skin;          // stiffness, Pa/m; smallest pitch area of a taxel, m^2
  dvec2 array_center;  // m, in S
  SkinBase base;
};

// Episode of an instance.
struct LoopStartRecord {
  dvec2 X_WO[4];     // position x, y, m; z, rotation w; x, y; z of the rotation, exploration velocity, m/s
  vec4 start_force;  // N, with STARTS_AT_LOAD; 0, 0, 0
  uvec4 keys;        // 1 if the instance runs an episode; servo; object; 0
};

TAXELSIM_CONSTANT kLoopJoints = 32u;  // as kMaxJoints and kMaxChainJoints, include/taxelsim/robot.h
TAXELSIM_CONSTANT kLoopChainJoints = 64u;

// Degree of freedom of a robot, rad or m.
struct JointRecord {
  dvec2 limits;       // lower, upper position
  dvec2 steps;        // lowest and highest multiple of the drive's step within them
  dvec2 velocity;     // limit; 0
  dvec2 start;        // position; command
  dvec2 jacobian[3];  // at the start: v x, y; z, w x; y, z; as Chain::poseAt()
};

// Joint between base and sensor.
struct ChainJointRecord {
  dvec2 X_PJ[4];   // position x, y, m; z, rotation w; x, y; z, 0
  dvec2 position;  // multiplier; offset
  uvec4 keys;      // degree of freedom; 1 if prismatic; 0, 0
};

// A manipulator. Its base stands such that the sensor starts at the origin of W.
struct RobotRecord {
  JointRecord joints[kLoopJoints];
  ChainJointRecord chain[kLoopChainJoints];
  dvec2 X_JS[4];  // as X_PJ
  dvec2 X_WB[4];
  dvec2 X_WS[4];   // at the start
  dvec2 singular;  // squares of the threshold and of the largest damping
  dvec2 drive;     // step, rad or m; 0
  uvec4 rows[2];   // selected components of a twist (v, w), ascending
};

TAXELSIM_LAYOUT_END

#endif
