// Sine and cosine, poses and twists in double precision: the operations of src/base/sin_cos.h, src/base/pose_inline.h and
// src/control/twist.h in the same order, hence the same bits.
#include "common/pose_record.glsl"

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

// Number k of (position, rotation).
double numberOf(Pose X, uint k) { return k < 3 ? X.position[k] : X.rotation[k - 3]; }

double dotOf(dvec3 a, dvec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
double lengthOf(dvec3 a) { return sqrt(dotOf(a, a)); }
dvec3 crossOf(dvec3 a, dvec3 b) { return dvec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x); }

dvec4 conjugate(dvec4 q) { return dvec4(q.x, -q.y, -q.z, -q.w); }

// Hamilton product.
dvec4 product(dvec4 a, dvec4 b) {
  return dvec4(a.x * b.x - a.y * b.y - a.z * b.z - a.w * b.w, a.x * b.y + a.y * b.x + a.z * b.w - a.w * b.z,
               a.x * b.z - a.y * b.w + a.z * b.x + a.w * b.y, a.x * b.w + a.y * b.z - a.z * b.y + a.w * b.x);
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
