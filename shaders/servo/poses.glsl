// Sine and cosine, poses and twists, and the record of an object's pose for the next frame, in double precision: the operations of
// src/base/sin_cos.h, src/base/pose_inline.h, src/control/twist.h and src/simulation/near_slots.cpp in the same order, hence the same bits.
// In: objects, servo_loop.

// `angle`: rad, up to kLargestReducedAngle.
void sinCos(double angle, out double sine_out, out double cosine_out) {
  const double kRound = 6755399441055744.0lf;
  const double kTwoOverPi = 0.6366197723675814lf;
  const double kFirst = 1.5707963267341256lf, kSecond = 6.077100506303966e-11lf, kThird = 2.0222662487959506e-21lf;
  double quarters = (angle * kTwoOverPi + kRound) - kRound;
  double near = angle - quarters * kFirst;
  double nearer = near - quarters * kSecond;
  double left_over = (near - nearer) - quarters * kSecond;
  double last = quarters * kThird - left_over;
  double x = nearer - last;
  double low = (nearer - x) - last;
  double z = x * x;
  double sine_sum =
      -1.0lf / 6.0lf +
      z * (1.0lf / 120.0lf + z * (-1.0lf / 5040.0lf +
                                  z * (1.0lf / 362880.0lf + z * (-1.0lf / 39916800.0lf +
                                                                 z * (1.0lf / 6227020800.0lf + z * (-1.0lf / 1307674368000.0lf +
                                                                                                    z * (1.0lf / 355687428096000.0lf)))))));
  double cosine_sum =
      1.0lf / 24.0lf +
      z * (-1.0lf / 720.0lf +
           z * (1.0lf / 40320.0lf + z * (-1.0lf / 3628800.0lf +
                                         z * (1.0lf / 479001600.0lf + z * (-1.0lf / 87178291200.0lf + z * (1.0lf / 20922789888000.0lf))))));
  double half_z = 0.5lf * z;
  double most = 1.0lf - half_z;
  double sine = x + (x * z * sine_sum + low * most);
  double cosine = most + (((1.0lf - most) - half_z) + (z * z * cosine_sum - x * low));

  int quadrant = int(quarters) & 3;
  bool swaps = (quadrant & 1) != 0;
  double s = swaps ? cosine : sine, c = swaps ? sine : cosine;
  sine_out = quadrant >= 2 ? -s : s;
  cosine_out = quadrant == 1 || quadrant == 2 ? -c : c;
}

struct Pose {
  dvec3 position;
  dvec4 rotation;  // quaternion w, x, y, z
};

// Number k of (position, rotation).
double numberOf(Pose X, uint k) { return k < 3 ? X.position[k] : X.rotation[k - 3]; }

double dotOf(dvec3 a, dvec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
double lengthOf(dvec3 a) { return sqrt(dotOf(a, a)); }
dvec3 crossOf(dvec3 a, dvec3 b) { return dvec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x); }

bool isFinite(double x) { return !(isnan(x) || isinf(x)); }
bool isFinite(dvec3 v) { return isFinite(v.x) && isFinite(v.y) && isFinite(v.z); }
bool isFinite(Pose X) { return isFinite(X.position) && isFinite(X.rotation.x) && isFinite(X.rotation.yzw); }

dvec4 normalized(dvec4 q) { return q / sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w); }
dvec4 conjugate(dvec4 q) { return dvec4(q.x, -q.y, -q.z, -q.w); }

// Hamilton product.
dvec4 product(dvec4 a, dvec4 b) {
  return dvec4(a.x * b.x - a.y * b.y - a.z * b.z - a.w * b.w, a.x * b.y + a.y * b.x + a.z * b.w - a.w * b.z,
               a.x * b.z - a.y * b.w + a.z * b.x + a.w * b.y, a.x * b.w + a.y * b.z - a.z * b.y + a.w * b.x);
}

struct Rows {
  dvec3 row0, row1, row2;
};

Rows rotationMatrix(dvec4 q) {
  double w = q.x, x = q.y, y = q.z, z = q.w;
  return Rows(dvec3(1.0lf - 2.0lf * (y * y + z * z), 2.0lf * (x * y - w * z), 2.0lf * (x * z + w * y)),
              dvec3(2.0lf * (x * y + w * z), 1.0lf - 2.0lf * (x * x + z * z), 2.0lf * (y * z - w * x)),
              dvec3(2.0lf * (x * z - w * y), 2.0lf * (y * z + w * x), 1.0lf - 2.0lf * (x * x + y * y)));
}

dvec3 transform(Rows m, dvec3 v) { return dvec3(dotOf(m.row0, v), dotOf(m.row1, v), dotOf(m.row2, v)); }

// X_AB X_BC.
Pose compose(Pose X_AB, Pose X_BC) {
  return Pose(X_AB.position + transform(rotationMatrix(X_AB.rotation), X_BC.position), normalized(product(X_AB.rotation, X_BC.rotation)));
}

// X_AB^-1 X_AC.
Pose relative(Pose X_AB, Pose X_AC) {
  dvec4 R_BA = conjugate(X_AB.rotation);
  Rows m = rotationMatrix(R_BA);
  dvec3 p = transform(m, X_AB.position);
  return Pose(-p + transform(m, X_AC.position), normalized(product(R_BA, X_AC.rotation)));
}

// The pose of a frame after dt seconds at the constant twist (v, w), relative to its pose before.
Pose exponential(dvec3 v, dvec3 w, double dt) {
  const double kSmallAngleSquared = 1e-4lf;
  dvec3 rotation = dt * w;
  dvec3 translation = dt * v;
  double angle_squared = dotOf(rotation, rotation);
  double half_sinc, cosine, b, c;
  if (angle_squared < kSmallAngleSquared) {
    double t = angle_squared;
    half_sinc = 0.5lf - t / 48.0lf + t * t / 3840.0lf;
    cosine = 1.0lf - t / 8.0lf + t * t / 384.0lf;
    b = 0.5lf - t / 24.0lf + t * t / 720.0lf;
    c = 1.0lf / 6.0lf - t / 120.0lf + t * t / 5040.0lf;
  } else {
    double angle = sqrt(angle_squared);
    double sine;
    sinCos(angle / 2.0lf, sine, cosine);
    half_sinc = sine / angle;
    b = 2.0lf * half_sinc * half_sinc;
    c = (angle - 2.0lf * sine * cosine) / (angle_squared * angle);
  }
  dvec3 once = crossOf(rotation, translation);
  dvec3 twice = crossOf(rotation, once);
  return Pose(translation + b * once + c * twice, dvec4(cosine, half_sinc * rotation.x, half_sinc * rotation.y, half_sinc * rotation.z));
}

// Whether all of the object is behind the skin, where it presses on nothing.
bool isBehind(ObjectRecord object, PoseRecord X_SO) {
  vec3 normal = servo_loop.behind.xyz;
  vec3 n_O = X_SO.row0.xyz * normal.x + X_SO.row1.xyz * normal.y + X_SO.row2.xyz * normal.z;
  vec3 p_SO = vec3(X_SO.row0.w, X_SO.row1.w, X_SO.row2.w), c = object.center.xyz, half_size = object.half_size.xyz;
  float center =
      servo_loop.origin.x + (normal.x * p_SO.x + normal.y * p_SO.y + normal.z * p_SO.z) + (n_O.x * c.x + n_O.y * c.y + n_O.z * c.z);
  return center + (abs(n_O.x) * half_size.x + abs(n_O.y) * half_size.y + abs(n_O.z) * half_size.z) < servo_loop.behind.w;
}

PoseRecord poseRecord(uint object, Pose X_SO) {
  Rows rotation = rotationMatrix(normalized(X_SO.rotation));
  PoseRecord record;
  record.row0 = vec4(vec3(rotation.row0), float(X_SO.position.x));
  record.row1 = vec4(vec3(rotation.row1), float(X_SO.position.y));
  record.row2 = vec4(vec3(rotation.row2), float(X_SO.position.z));
  record.object = vec4(float(object), 0.0, 0.0, 0.0);
  if (isBehind(objects[object], record)) record = PoseRecord(vec4(0), vec4(0), vec4(0), vec4(-1, 0, 0, 0));
  return record;
}
