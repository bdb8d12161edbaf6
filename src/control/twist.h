// Kinematics of twists in SE(3): exponential map, change of frame, integration. A twist is (v, w) of a frame in its own axes.
#pragma once

#include <cmath>

#include "base/pose_inline.h"
#include "base/sin_cos.h"
#include "base/vector3.h"
#include "taxelsim/pose.h"

namespace taxelsim {

// Twist of frame A from the twist of frame B on the same rigid body: the adjoint of X_AB.
Twist changeFrame(const Pose& X_AB, const Twist& twist_B);

// Below this squared angle Taylor series replace the closed forms, which suffer from cancellation. The first omitted term is below 1e-16
// of the largest.
inline constexpr double kSmallAngleSquared = 1e-4;

// Exponential map exp(twist dt) in closed form: the pose of a frame after dt seconds at a constant twist, relative to its pose before
// (a screw motion).
inline Pose exponential(const Twist& twist, double dt) {
  const Vector3 rotation = scale(dt, twist.w);  // rotation vector, rad
  const Vector3 translation = scale(dt, twist.v);
  const double angle_squared = dot(rotation, rotation);

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
    const SinCos half = sinCos(angle / 2);
    const double sine = half.sine;
    cosine = half.cosine;
    half_sinc = sine / angle;
    b = 2 * half_sinc * half_sinc;
    c = (angle - 2 * sine * cosine) / (angle_squared * angle);
  }
  const Vector3 once = cross(rotation, translation);
  const Vector3 twice = cross(rotation, once);
  return {{translation[0] + b * once[0] + c * twice[0], translation[1] + b * once[1] + c * twice[1],
           translation[2] + b * once[2] + c * twice[2]},
          {cosine, half_sinc * rotation[0], half_sinc * rotation[1], half_sinc * rotation[2]}};
}

// Pose of frame B after dt seconds at twist_B: X_WB exp(twist_B dt).
inline Pose integrate(const Pose& X_WB, const Twist& twist_B, double dt) {
  return inlined::compose(X_WB, exponential(twist_B, dt));
}

}  // namespace taxelsim
