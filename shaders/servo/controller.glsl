// Command of a tactile servo: the operations of src/control/tactile_servo.cpp in the same order, hence the same bits.
// In: servos, servo_loop; skins whose pressure is proportional to depth; nominal Jacobian.

const double kPi = 3.14159265358979311600lf;
const double kApproachFraction = 0.1lf;  // share of the largest velocity

double undefinedValue() { return packDouble2x32(uvec2(0u, 0x7FF80000u)); }  // NaN

// Features of one instance in S; `edge`: unit vector along the edge, 0 if it is not known.
struct Contact {
  double angle, confidence, force, area;
  dvec2 center, tilt;
  double tilt_confidence, start_force;
  dvec2 edge;
};

// State of a loop between control ticks.
struct Pid {
  double integral[kServoFeatures];
  double error[kServoFeatures];
};

struct Twist {
  dvec3 v, w;
};

bool isSelected(uint servo, uint feature) { return (servos[servo].flags.x & (1u << feature)) != 0; }

double referenceOf(uint servo, uint feature, double otherwise) {
  return (servos[servo].flags.y & (1u << feature)) != 0 ? servos[servo].loops[feature].error.x : otherwise;
}

double clipped(double value, double limit) { return value < -limit ? -limit : limit < value ? limit : value; }

// Wraps the difference of two angles in [-pi/2, pi/2], up to rounding, to (-pi/2, pi/2]. A multiple of 0 has the sign of the angle.
double wrapLineAngle(double angle) {
  double size = abs(angle);
  if (size < kPi / 2.0lf) return angle;
  double wrapped = size == kPi ? 0.0lf * angle : angle - (angle < 0.0lf ? -kPi : kPi);
  return wrapped <= -kPi / 2.0lf ? wrapped + kPi : wrapped;
}

dvec2 directionOfEdge(uint servo, double angle) {
  double reference = referenceOf(servo, kServoEdgeAngle, 0.0lf);
  dvec2 edge;
  sinCos(reference + wrapLineAngle(angle - reference), edge.y, edge.x);
  return edge;
}

// Velocity of the sensor's origin in a rotation w about the contact's center c: -w x c.
dvec3 velocityOfRotationAbout(dvec2 center, dvec3 w) { return dvec3(w.z * center.y, -w.z * center.x, w.y * center.x - w.x * center.y); }

// Reference - value of each selected and available feature.
void featureErrors(uint servo, Contact contact, inout double error[kServoFeatures]) {
  double least = servos[servo].confidence.x;
  dvec2 middle = servo_loop.array_center;
  double values[kServoFeatures], otherwise[kServoFeatures];
  for (uint f = 0; f < kServoFeatures; ++f) otherwise[f] = 0.0lf;
  otherwise[kServoCenterX] = middle.x;
  otherwise[kServoCenterY] = middle.y;
  otherwise[kServoTotalForce] = contact.start_force;
  values[kServoCenterX] = contact.center.x;
  values[kServoCenterY] = contact.center.y;
  values[kServoCenterAcross] = (contact.center.y - middle.y) * contact.edge.x - (contact.center.x - middle.x) * contact.edge.y;
  values[kServoTotalForce] = contact.force;
  values[kServoEdgeAngle] = contact.angle;
  values[kServoTiltX] = contact.tilt.x;
  values[kServoTiltY] = contact.tilt.y;
  bool has_tilt = contact.tilt_confidence >= least, has_edge = contact.confidence >= least;
  for (uint f = 0; f < kServoFeatures; ++f) {
    bool is_tilt = f == kServoTiltX || f == kServoTiltY, is_edge = f == kServoCenterAcross || f == kServoEdgeAngle;
    bool known = isSelected(servo, f) && (!is_tilt || has_tilt) && (!is_edge || has_edge);
    error[f] = known ? referenceOf(servo, f, otherwise[f]) - values[f] : undefinedValue();
  }
  if (!isnan(error[kServoEdgeAngle])) error[kServoEdgeAngle] = wrapLineAngle(error[kServoEdgeAngle]);
}

// The inverse of the nominal tactile Jacobian.
Twist nominalTwist(uint servo, Contact contact, double rate[kServoFeatures]) {
  Twist twist;
  twist.w = dvec3(-rate[kServoTiltX], -rate[kServoTiltY], -rate[kServoEdgeAngle]);
  dvec2 translation = dvec2(0.0lf);
  double radius_x = servos[servo].loops[kServoCenterX].integral.y, radius_y = servos[servo].loops[kServoCenterY].integral.y;
  if (radius_x > 0.0lf) {
    twist.w.y += -rate[kServoCenterX] / radius_x;
  } else {
    translation.x = -rate[kServoCenterX];
  }
  if (radius_y > 0.0lf) {
    twist.w.x += rate[kServoCenterY] / radius_y;
  } else {
    translation.y = -rate[kServoCenterY];
  }
  if (contact.confidence >= servos[servo].confidence.x) {
    translation.x += rate[kServoCenterAcross] * contact.edge.y;
    translation.y -= rate[kServoCenterAcross] * contact.edge.x;
  } else if (isSelected(servo, kServoCenterAcross)) {
    double kp = servos[servo].loops[kServoCenterAcross].gains.x;
    translation.x += kp * (contact.center.x - servo_loop.array_center.x);
    translation.y += kp * (contact.center.y - servo_loop.array_center.y);
  }
  double area = contact.area < servo_loop.skin.y ? servo_loop.skin.y : contact.area;
  dvec3 rotation_velocity = velocityOfRotationAbout(contact.center, twist.w);
  twist.v = dvec3(rotation_velocity.xy + translation, rotation_velocity.z + rate[kServoTotalForce] / (servo_loop.skin.x * area));
  return twist;
}

dvec3 explorationVelocity(uint servo, Contact contact, double velocity) {
  if (contact.confidence < servos[servo].confidence.x) return dvec3(0.0lf);
  dvec2 direction = servos[servo].exploration;
  return dvec3(velocity * (direction.x * contact.edge.x - direction.y * contact.edge.y),
               velocity * (direction.y * contact.edge.x + direction.x * contact.edge.y), 0.0lf);
}

// Reduces the rotation about the contact's center, including the velocity that belongs to it, then the translation.
void saturate(uint servo, dvec2 center, double angular_speed, inout Twist twist) {
  dvec2 limits = servos[servo].limits;
  if (angular_speed > limits.y) {
    dvec3 before = velocityOfRotationAbout(center, twist.w);
    twist.w *= limits.y / angular_speed;
    twist.v += velocityOfRotationAbout(center, twist.w) - before;
  }
  double speed = lengthOf(twist.v);
  if (speed > limits.x) twist.v *= limits.x / speed;
}

// Without contact: approaches along z if the force is controlled with a positive reference.
Twist approach(uint servo, double start_force) {
  bool approaches = isSelected(servo, kServoTotalForce) && referenceOf(servo, kServoTotalForce, start_force) > 0.0lf;
  return Twist(dvec3(0.0lf, 0.0lf, approaches ? kApproachFraction * servos[servo].limits.x : 0.0lf), dvec3(0.0lf));
}

Twist command(uint servo, Contact contact, double exploration_velocity, inout Pid pid) {
  if (contact.force <= 0.0lf || contact.area <= 0.0lf) {
    for (uint f = 0; f < kServoFeatures; ++f) pid.error[f] = undefinedValue();
    return approach(servo, contact.start_force);
  }
  double error[kServoFeatures], rate[kServoFeatures], integral[kServoFeatures];
  featureErrors(servo, contact, error);
  double dt = servo_loop.time.y;
  for (uint f = 0; f < kServoFeatures; ++f) {
    rate[f] = 0.0lf;
    integral[f] = pid.integral[f];
    if (isnan(error[f])) continue;
    FeatureLoopRecord feature = servos[servo].loops[f];
    double bounded = clipped(error[f], feature.error.y);
    integral[f] = clipped(integral[f] + bounded * dt, feature.integral.x);
    double derivative = isnan(pid.error[f]) ? 0.0lf : clipped((error[f] - pid.error[f]) / dt, feature.change.y);
    rate[f] = feature.gains.x * bounded + feature.gains.y * integral[f] + feature.change.x * derivative;
  }
  Twist twist = nominalTwist(servo, contact, rate);
  twist.v += explorationVelocity(servo, contact, exploration_velocity);

  // Anti-windup: integrals that would increase a saturated velocity are held.
  double angular_speed = lengthOf(twist.w);
  bool translates_too_fast = lengthOf(twist.v) > servos[servo].limits.x, rotates_too_fast = angular_speed > servos[servo].limits.y;
  for (uint f = 0; f < kServoFeatures; ++f) {
    bool rotates = f <= kServoCenterAcross ? servos[servo].loops[f].integral.y > 0.0lf : f >= kServoEdgeAngle;
    bool saturated = rotates ? rotates_too_fast : translates_too_fast;
    if (!(saturated && rate[f] * error[f] > 0.0lf)) pid.integral[f] = integral[f];
    pid.error[f] = error[f];
  }
  saturate(servo, contact.center, angular_speed, twist);
  return twist;
}
