// Joints of a robot: the operations of src/control/robots.cpp in the same order, hence the same bits. In: robot, servo_loop. In and out:
// loop_state.

// Steps 1 to 3 of robots.h: `velocities` that respect all limits. Returns flags of RobotStatus.
uint solveVelocities(uint i, Twist twist) {
  double dt = servo_loop.time.x;
  uint free_joints = 0xFFFFFFFFu;
  double limited[NUM_JOINTS];  // velocities of joints that are not free: they reach their limit in this tick
  [[dont_unroll]] for (uint j = 0; j < NUM_JOINTS; ++j) limited[j] = velocities[j] = 0.0lf;
  if (!(isFinite(twist.v) && isFinite(twist.w))) return kLost;
  double target[6] = {twist.v.x, twist.v.y, twist.v.z, twist.w.x, twist.w.y, twist.w.z};
  uint status = 0;
  bool any_limited = true;
  [[dont_unroll]] for (uint pass = 0; any_limited && pass <= NUM_JOINTS; ++pass) {
    double rest[6] = target;
    [[dont_unroll]] for (uint j = 0; j < NUM_JOINTS; ++j) {
      [[dont_unroll]] for (uint k = 0; k < 6; ++k) rest[k] -= readJoint(i, j, kJointJacobian + k) * limited[j];
    }
    if (leastSquares(i, rest, free_joints)) status |= kSingular;

    double factor = 1.0lf;
    bool is_finite = true;
    [[dont_unroll]] for (uint j = 0; j < NUM_JOINTS; ++j) {
      velocities[j] += limited[j];
      is_finite = is_finite && isFinite(velocities[j]);
      double limit = robot.joints[j].velocity.x;
      if (abs(velocities[j]) > limit && limit / abs(velocities[j]) < factor) factor = limit / abs(velocities[j]);
    }
    if (!is_finite) {
      [[dont_unroll]] for (uint j = 0; j < NUM_JOINTS; ++j) velocities[j] = 0.0lf;
      return kLost;
    }
    if (factor < 1.0lf) {
      status |= kVelocityLimit;
      [[dont_unroll]] for (uint k = 0; k < 6; ++k) target[k] *= factor;
      [[dont_unroll]] for (uint j = 0; j < NUM_JOINTS; ++j) {
        velocities[j] *= factor;
        limited[j] *= factor;
      }
    }

    any_limited = false;
    [[dont_unroll]] for (uint j = 0; j < NUM_JOINTS; ++j) {
      double command = readJoint(i, j, kJointCommand), next = command + velocities[j] * dt;
      dvec2 limits = robot.joints[j].limits;
      if ((free_joints & (1u << j)) == 0 || (next >= limits.x && next <= limits.y)) continue;
      limited[j] = ((next < limits.x ? limits.x : limits.y) - command) / dt;
      free_joints &= ~(1u << j);
      any_limited = true;
    }
    if (any_limited) status |= kJointLimit;
  }
  return status;
}

double clampedTo(double value, dvec2 range) { return value < range.x ? range.x : range.y < value ? range.y : value; }

// To the nearest integer, half away from zero, with the sign of the value: std::round() by additions.
double roundedAway(double value) {
  const double kTwo52 = 4503599627370496.0lf;
  double size = abs(value);
  if (!(size < kTwo52) || size == 0.0lf) return value;
  double nearest = (size + kTwo52) - kTwo52;  // half to even
  if (size - nearest == 0.5lf) nearest += 1.0lf;
  return value < 0.0lf ? -nearest : nearest;
}

// Step 4 of robots.h for one joint: command and drive. Returns flags of RobotStatus.
uint driveJoint(uint i, uint frame, uint j, double velocity) {
  double dt = servo_loop.time.x, drive_step = robot.drive.x;
  double command = clampedTo(readJoint(i, j, kJointCommand) + velocity * dt, robot.joints[j].limits);
  writeJoint(i, j, kJointCommand, command);
  double target = drive_step == 0.0lf ? command : clampedTo(roundedAway(command / drive_step), robot.joints[j].steps) * drive_step;
  if (DELAY > 0) {
    uint at = kNumLoopState + kNumJointState * NUM_JOINTS + frame % max(DELAY, 1) * NUM_JOINTS + j;
    double delayed = frame < DELAY ? robot.joints[j].start.x : readState(i, at);
    writeState(i, at, target);
    target = delayed;
  }
  double before = readJoint(i, j, kJointPosition), max_change = robot.joints[j].velocity.x * dt;
  bool lags = !(abs(target - before) <= max_change);
  double position = !lags ? target : before + (target - before < 0.0lf ? -max_change : max_change);
  writeJoint(i, j, kJointPosition, position);
  writeJoint(i, j, kJointVelocity, (position - before) / dt);
  return lags ? kVelocityLimit : 0;
}

void startRobot(uint i) {
  [[dont_unroll]] for (uint j = 0; j < NUM_JOINTS; ++j) {
    writeJoint(i, j, kJointPosition, robot.joints[j].start.x);
    writeJoint(i, j, kJointVelocity, 0.0lf);
    writeJoint(i, j, kJointCommand, robot.joints[j].start.y);
    [[dont_unroll]] for (uint k = 0; k < 6; ++k) writeJoint(i, j, kJointJacobian + k, robot.joints[j].jacobian[k >> 1][k & 1]);
  }
  writeSensorPose(i, poseOf(robot.X_WS));
}

// X_WS after a step at the twist.
Pose moveRobot(uint i, uint frame, Twist twist) {
  uint status = solveVelocities(i, twist);
  [[dont_unroll]] for (uint j = 0; j < NUM_JOINTS; ++j) status |= driveJoint(i, frame, j, velocities[j]);
  writeState(i, kStateStatus, double(status));
  Pose X_WS = compose(poseOf(robot.X_WB), updateKinematics(i));
  writeSensorPose(i, X_WS);
  return X_WS;
}
