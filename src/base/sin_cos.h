// Sine and cosine of additions, multiplications and divisions of constants only, so that a device computes the same bits:
// shaders/servo/poses.glsl has the same operations in the same order. Within 1 ulp of the exact values.
#pragma once

#include <cmath>

namespace taxelsim {

struct SinCos {
  double sine, cosine;
};

// Largest angle (rad) that sinCos() reduces by itself: up to it, multiples of the leading parts of pi/2 are exact.
inline constexpr double kLargestReducedAngle = 1e6;

// Reduction by Cody and Waite (Software Manual for the Elementary Functions, 1980), then Taylor series, whose first omitted terms are below
// 1e-18 at pi/4.
inline SinCos sinCos(double angle) {
  // Written so that NaN takes it.
  if (!(std::abs(angle) <= kLargestReducedAngle)) return {std::sin(angle), std::cos(angle)};
  // Adding and subtracting 1.5 x 2^52 rounds to an integer.
  constexpr double kRound = 6755399441055744.0;
  constexpr double kTwoOverPi = 0.6366197723675814;
  // pi/2 in three parts, of 32, 32 and 53 bits.
  constexpr double kFirst = 1.5707963267341256, kSecond = 6.077100506303966e-11, kThird = 2.0222662487959506e-21;
  const double quarters = (angle * kTwoOverPi + kRound) - kRound;
  const double near = angle - quarters * kFirst;
  const double nearer = near - quarters * kSecond;
  const double left_over = (near - nearer) - quarters * kSecond;  // rounding error of `nearer`
  const double last = quarters * kThird - left_over;
  const double x = nearer - last;          // angle - quarters pi/2
  const double low = (nearer - x) - last;  // rounding error of x
  const double z = x * x;
  // Coefficients of x^3 to x^17 and of x^4 to x^16.
  const double sine_sum =
      -1.0 / 6.0 +
      z * (1.0 / 120.0 +
           z * (-1.0 / 5040.0 +
                z * (1.0 / 362880.0 +
                     z * (-1.0 / 39916800.0 + z * (1.0 / 6227020800.0 + z * (-1.0 / 1307674368000.0 + z * (1.0 / 355687428096000.0)))))));
  const double cosine_sum =
      1.0 / 24.0 +
      z * (-1.0 / 720.0 + z * (1.0 / 40320.0 + z * (-1.0 / 3628800.0 +
                                                    z * (1.0 / 479001600.0 + z * (-1.0 / 87178291200.0 + z * (1.0 / 20922789888000.0))))));
  const double half_z = 0.5 * z;
  const double most = 1.0 - half_z;
  const double sine = x + (x * z * sine_sum + low * most);
  const double cosine = most + (((1.0 - most) - half_z) + (z * z * cosine_sum - x * low));

  switch (static_cast<int>(quarters) & 3) {
    case 0:
      return {sine, cosine};
    case 1:
      return {cosine, -sine};
    case 2:
      return {-sine, -cosine};
    default:
      return {-cosine, sine};
  }
}

}  // namespace taxelsim
