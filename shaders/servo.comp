#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
// Closed loop of tactile servos: features of this frame -> twist -> joints of the robot -> pose of the sensor -> pose of the object for the
// next frame.
//
// An invocation owns an instance.
// In:  loop_starts (num_instances), servos, the features of the frame: features, and servo_features, which is the same array or contact
//      features.
// Out: poses (num_instances) of the next frame; object_poses and sensor_poses of this frame (num_instances x 7: position, rotation w, x, y,
//      z), actions (num_instances x 6: v, w) after it, robot_status of the motion before it; with MANIPULATOR joint_positions and
//      joint_velocities (num_instances x NUM_JOINTS) of this frame. Rows of instances without an episode stay as they are.
// State: loop_state (kNumLoopState x num_instances, and kNumJointState + DELAY of each joint). The first frame of an episode needs none.
// Shared memory: none.
// All arithmetic up to the pose record is in double precision, with the bits of the host's: twin src/episodes/servo_controller.cpp,
// src/control/robots.cpp, chain.cpp and damped_least_squares.cpp, src/episodes/episode_batch.cpp, src/simulation/near_slots.cpp.

#include "shared/features.h"
#include "shared/servo.h"
#include "passes/declare.glsl"
#include "passes/servo.h"

#include "common/instances.glsl"
#include "servo/poses.glsl"
#include "servo/controller.glsl"
#include "servo/instance.glsl"
#include "servo/chain.glsl"
#include "servo/damped_least_squares.glsl"
#include "servo/robot.glsl"

void startEpisode(uint i) {
  startLoop(i);
  if (MANIPULATOR) {
    startRobot(i);
  } else {
    startFreeFlying(i);
  }
}

void outputJoints(uint i) {
  for (uint j = 0; j < NUM_JOINTS; ++j) {
    joint_positions[i * NUM_JOINTS + j] = readJoint(i, j, kJointPosition);
    joint_velocities[i * NUM_JOINTS + j] = readJoint(i, j, kJointVelocity);
  }
}

void main() {
  uint i = workgroupNumber() * WORKGROUP + gl_LocalInvocationIndex;
  if (!isProcessed(i) || loop_starts[i].keys.x == 0) return;
  uint frame = instanceRecord(i).clock.x;
  if (frame == 0) startEpisode(i);
  Pose X_WS = readSensorPose(i), X_WO = objectInWorld(i);
  if (OBJECT_POSES) {
    Pose X_SO = frame == 0 ? X_WO : relative(X_WS, X_WO);
    for (uint k = 0; k < 7; ++k) object_poses[7 * i + k] = numberOf(X_SO, k);
  }
  if (SENSOR_POSES) {
    for (uint k = 0; k < 7; ++k) sensor_poses[7 * i + k] = numberOf(X_WS, k);
  }
  if (ROBOT_STATUS) robot_status[i] = uint(readState(i, kStateStatus));
  if (JOINTS) outputJoints(i);
  if (frame % CONTROL_PERIOD == 0) actOnFeatures(i);
  Twist twist = readTwist(i);
  if (ACTIONS) {
    for (uint k = 0; k < 3; ++k) {
      actions[6 * i + k] = twist.v[k];
      actions[6 * i + 3 + k] = twist.w[k];
    }
  }
  if (MANIPULATOR) {
    X_WS = moveRobot(i, frame, twist);
  } else {
    X_WS = moveFreeFlying(i, X_WS, twist);
  }
  uint object = loop_starts[i].keys.z;
  PoseRecord record = poseRecord(object, 0, relative(X_WS, X_WO));
  poses[i] = record;
  if (isBehind(objects[object], record, servo_loop.base)) poses[i] = kNoPose;
}
