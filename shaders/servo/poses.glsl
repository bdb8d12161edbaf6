// Poses and twists in double precision: the operations of src/base/pose_inline.h and src/control/twist.h in the same order, hence the same
// bits.

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
