// State of one loop between frames, and its features. In: instances, loop_starts, servo_loop, servos, features, servo_features, loop_state.

const uint kJointLimit = 1, kVelocityLimit = 2, kSingular = 4, kLost = 8;  // RobotStatus, src/control/robots.h

uint stateAt(uint i, uint number) { return number * step_record.batch.x + i; }
double readState(uint i, uint number) { return loop_state[stateAt(i, number)]; }
void writeState(uint i, uint number, double value) { loop_state[stateAt(i, number)] = value; }

double readJoint(uint i, uint joint, uint number) { return readState(i, kNumLoopState + kNumJointState * joint + number); }
void writeJoint(uint i, uint joint, uint number, double value) { writeState(i, kNumLoopState + kNumJointState * joint + number, value); }

float firstFeature(uint i, uint offset) { return features[offset * step_record.batch.x + i]; }

void writeSensorPose(uint i, Pose X_WS) {
  for (uint k = 0; k < 3; ++k) writeState(i, kStateSensor + k, X_WS.position[k]);
  for (uint k = 0; k < 4; ++k) writeState(i, kStateSensor + 3 + k, X_WS.rotation[k]);
}

Pose readSensorPose(uint i) {
  Pose X_WS;
  for (uint k = 0; k < 3; ++k) X_WS.position[k] = readState(i, kStateSensor + k);
  for (uint k = 0; k < 4; ++k) X_WS.rotation[k] = readState(i, kStateSensor + 3 + k);
  return X_WS;
}

Twist readTwist(uint i) {
  Twist twist;
  for (uint k = 0; k < 3; ++k) {
    twist.v[k] = readState(i, kStateTwist + k);
    twist.w[k] = readState(i, kStateTwist + 3 + k);
  }
  return twist;
}

// A load search has moved the object along z.
void startLoop(uint i) {
  for (uint f = 0; f < kServoFeatures; ++f) {
    writeState(i, kStateIntegral + f, 0.0lf);
    writeState(i, kStateError + f, undefinedValue());
  }
  bool is_load_driven = (instanceRecord(i).keys.w & kFlagLoadDriven) != 0;
  writeState(i, kStateLoadOffset, is_load_driven ? double(firstFeature(i, kFeatureLoadOffset)) : 0.0lf);
  writeState(i, kStateStartForce, double(STARTS_AT_LOAD ? loop_starts[i].start_force.x : firstFeature(i, kFeatureTotalForce)));
  writeState(i, kStateStatus, 0.0lf);
}

Pose objectInWorld(uint i) {
  dvec2 xy = loop_starts[i].X_WO[0], zw = loop_starts[i].X_WO[1], rotation_xy = loop_starts[i].X_WO[2];
  return Pose(dvec3(xy, zw.x) + dvec3(0.0lf, 0.0lf, readState(i, kStateLoadOffset)), dvec4(zw.y, rotation_xy, loop_starts[i].X_WO[3].x));
}

// Component of a feature of the part that the servo regulates.
double feature(uint servo, uint i, uint offset, uint width, uint component) {
  uint row = i * FEATURE_ROWS + ((servos[servo].flags.z & kServoFlagRegion) != 0 ? REGION_ROW : 0);
  return double(servo_features[offset * step_record.batch.x * FEATURE_ROWS + row * width + component]);
}

Contact contactState(uint servo, uint i) {
  uint flags = servos[servo].flags.z;
  uint angle = (flags & kServoFlagWindow) != 0  ? kContactWindowedEdgeAngle
               : (flags & kServoFlagRidge) != 0 ? kContactRidgeEdgeAngle
                                                : kFeatureEdgeAngle;
  Contact contact;
  contact.angle = feature(servo, i, angle, 1, 0);
  contact.confidence = feature(servo, i, angle + 1, 1, 0);
  contact.force = feature(servo, i, kFeatureTotalForce, 1, 0);
  contact.area = feature(servo, i, kFeatureContactArea, 1, 0);
  contact.center = dvec2(feature(servo, i, kFeatureCenterOfPressure, 3, 0), feature(servo, i, kFeatureCenterOfPressure, 3, 1));
  contact.tilt = dvec2(0.0lf);
  contact.tilt_confidence = 0.0lf;
  if (isSelected(servo, kServoTiltX) || isSelected(servo, kServoTiltY)) {
    contact.tilt = dvec2(feature(servo, i, kContactTilt, 2, 0), feature(servo, i, kContactTilt, 2, 1));
    contact.tilt_confidence = feature(servo, i, kContactTiltConfidence, 1, 0);
  }
  contact.start_force = readState(i, kStateStartForce);
  contact.edge = contact.confidence >= servos[servo].confidence.x ? directionOfEdge(servo, contact.angle) : dvec2(0.0lf);
  return contact;
}

// A control tick. Features that are not finite stop the sensor.
void actOnFeatures(uint i) {
  uint servo = loop_starts[i].keys.y;
  Contact contact = contactState(servo, i);
  double sum = contact.angle + contact.confidence + contact.force + contact.area + contact.center.x + contact.center.y + contact.tilt.x +
               contact.tilt.y + contact.tilt_confidence + contact.start_force;
  Twist twist = Twist(dvec3(0.0lf), dvec3(0.0lf));
  if (isFinite(sum)) {
    Pid pid;
    for (uint f = 0; f < kServoFeatures; ++f) {
      pid.integral[f] = readState(i, kStateIntegral + f);
      pid.error[f] = readState(i, kStateError + f);
    }
    twist = command(servo, contact, loop_starts[i].X_WO[3].y, pid);
    for (uint f = 0; f < kServoFeatures; ++f) {
      writeState(i, kStateIntegral + f, pid.integral[f]);
      writeState(i, kStateError + f, pid.error[f]);
    }
  }
  for (uint k = 0; k < 3; ++k) {
    writeState(i, kStateTwist + k, twist.v[k]);
    writeState(i, kStateTwist + 3 + k, twist.w[k]);
  }
}

void startFreeFlying(uint i) { writeSensorPose(i, Pose(dvec3(0.0lf), dvec4(1.0lf, 0.0lf, 0.0lf, 0.0lf))); }

// X_WS after a step at the twist, where both are finite.
Pose moveFreeFlying(uint i, Pose X_WS, Twist twist) {
  bool moves = isFinite(twist.v) && isFinite(twist.w);
  Pose moved = X_WS;
  if (moves) {
    moved = compose(X_WS, exponential(twist.v, twist.w, servo_loop.time.x));
    moves = isFinite(moved);
  }
  writeState(i, kStateStatus, moves ? 0.0lf : double(kLost));
  if (!moves) return X_WS;
  writeSensorPose(i, moved);
  return moved;
}
