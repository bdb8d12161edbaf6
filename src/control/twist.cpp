#include "control/twist.h"

#include <cmath>

namespace taxelsim {
namespace {

// Below this square of the angle the series stand in for the closed forms, which lose digits there. The first term left out is
// under 1e-16 of the largest kept.
constexpr double kSmallAngleSquared = 1e-4;

Vector3 cross(const Vector3& a, const Vector3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

}  // namespace

Twist changeFrame(const Pose& X_AB, const Twist& twist_B) {
  const Vector3 w_A = rotate(X_AB.rotation, twist_B.w);
  const Vector3 v_B_A = rotate(X_AB.rotation, twist_B.v);
  const Vector3 lever = cross(X_AB.position, w_A);  // w x (A's origin - B's origin), in A
  return {{v_B_A[0] + lever[0], v_B_A[1] + lever[1], v_B_A[2] + lever[2]}, w_A};
}

Pose exponential(const Twist& twist, double dt) {
  const Vector3 turn{twist.w[0] * dt, twist.w[1] * dt, twist.w[2] * dt};
  const Vector3 shift{twist.v[0] * dt, twist.v[1] * dt, twist.v[2] * dt};
  const double angle_squared = turn[0] * turn[0] + turn[1] * turn[1] + turn[2] * turn[2];

  double half_sinc;  // sin(theta / 2) / theta
  double cosine;     // cos(theta / 2)
  double b;          // (1 - cos theta) / theta^2
  double c;          // (theta - sin theta) / theta^3
  if (angle_squared < kSmallAngleSquared) {
    const double t = angle_squared;
    half_sinc = 0.5 - t / 48 + t * t / 3840;
    cosine = 1 - t / 8 + t * t / 384;
    b = 0.5 - t / 24 + t * t / 720;
    c = 1.0 / 6 - t / 120 + t * t / 5040;
  } else {
    const double angle = std::sqrt(angle_squared);
    const double sine = std::sin(angle / 2);
    cosine = std::cos(angle / 2);
    half_sinc = sine / angle;
    b = 2 * half_sinc * half_sinc;
    c = (angle - 2 * sine * cosine) / (angle_squared * angle);
  }
  const Vector3 once = cross(turn, shift);
  const Vector3 twice = cross(turn, once);
  return {{shift[0] + b * once[0] + c * twice[0], shift[1] + b * once[1] + c * twice[1], shift[2] + b * once[2] + c * twice[2]},
          {cosine, half_sinc * turn[0], half_sinc * turn[1], half_sinc * turn[2]}};
}

Pose integrate(const Pose& X_WB, const Twist& twist_B, double dt) {
  return X_WB * exponential(twist_B, dt);
}

}  // namespace taxelsim
