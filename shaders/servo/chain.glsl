// Forward kinematics and geometric Jacobian of a robot: the operations of src/control/chain.cpp in the same order, hence the same bits.
// In: robot. In and out: loop_state.

Pose poseOf(dvec2 values[4]) { return Pose(dvec3(values[0], values[1].x), dvec4(values[1].y, values[2], values[3].x)); }

// q times a rotation about z, given by sine and cosine of half its angle; not normalised.
dvec4 rotateAboutZ(dvec4 q, double sine, double cosine) {
  return dvec4(q.x * cosine - q.w * sine, q.y * cosine + q.z * sine, q.z * cosine - q.y * sine, q.w * cosine + q.x * sine);
}

dvec3 zAxisOf(dvec4 q) {
  return dvec3(2.0lf * (q.y * q.w + q.x * q.z), 2.0lf * (q.z * q.w - q.x * q.y), 1.0lf - 2.0lf * (q.y * q.y + q.z * q.z));
}

dvec3 rotateVector(dvec4 q, dvec3 v) {
  dvec3 t = 2.0lf * crossOf(q.yzw, v);
  return v + (q.x * t + crossOf(q.yzw, t));
}

dvec3 inSensorFrame(Rows rotation, dvec3 v) { return rotation.row0 * v.x + rotation.row1 * v.y + rotation.row2 * v.z; }

// X_BS at the joint positions. Writes the transposed Jacobian.
Pose updateKinematics(uint i) {
  dvec3 directions[NUM_CHAIN_JOINTS], points[NUM_CHAIN_JOINTS];  // directions and points of the joints' axes, in B
  Pose X = Pose(dvec3(0.0lf), dvec4(1.0lf, 0.0lf, 0.0lf, 0.0lf));
  [[dont_unroll]] for (uint k = 0; k < NUM_CHAIN_JOINTS; ++k) {
    Pose X_PJ = poseOf(robot.chain[k].X_PJ);
    X.position += rotateVector(X.rotation, X_PJ.position);
    X.rotation = product(X.rotation, X_PJ.rotation);
    directions[k] = zAxisOf(X.rotation);
    points[k] = X.position;
    double position = robot.chain[k].position.x * readJoint(i, robot.chain[k].keys.x, kJointPosition) + robot.chain[k].position.y;
    if (robot.chain[k].keys.y == 0) {
      double sine, cosine;
      sinCos(position / 2.0lf, sine, cosine);
      X.rotation = rotateAboutZ(X.rotation, sine, cosine);
    } else {
      X.position += position * directions[k];
    }
  }
  Pose X_JS = poseOf(robot.X_JS);
  X.position += rotateVector(X.rotation, X_JS.position);
  X.rotation = normalized(product(X.rotation, X_JS.rotation));

  dvec3 linear[NUM_JOINTS], angular[NUM_JOINTS];
  [[dont_unroll]] for (uint j = 0; j < NUM_JOINTS; ++j) linear[j] = angular[j] = dvec3(0.0lf);
  Rows rotation = rotationMatrix(X.rotation);
  [[dont_unroll]] for (uint k = 0; k < NUM_CHAIN_JOINTS; ++k) {
    uint j = robot.chain[k].keys.x;
    double multiplier = robot.chain[k].position.x;
    dvec3 along = multiplier * inSensorFrame(rotation, directions[k]);
    if (robot.chain[k].keys.y == 0) {
      linear[j] += multiplier * inSensorFrame(rotation, crossOf(directions[k], X.position - points[k]));
      angular[j] += along;
    } else {
      linear[j] += along;
    }
  }
  [[dont_unroll]] for (uint j = 0; j < NUM_JOINTS; ++j) {
    [[dont_unroll]] for (uint c = 0; c < 3; ++c) {
      writeJoint(i, j, kJointJacobian + c, linear[j][c]);
      writeJoint(i, j, kJointJacobian + 3 + c, angular[j][c]);
    }
  }
  return X;
}
