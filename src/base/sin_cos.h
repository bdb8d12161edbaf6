// Sine and cosine of additions and multiplications only, so that a device computes the same bits: shaders/servo/sin_cos.glsl has the same
// operations in the same order. Within 1 ulp of the exact values.
#pragma once

#include <cmath>

namespace taxelsim {

struct SinCos {
  double sine, cosine;
};

// Largest angle (rad) that sinCos() reduces by itself: up to it, multiples of the leading parts of pi/2 are exact.
inline constexpr double kLargestReducedAngle = 1e6;

// Reduction and polynomials of fdlibm (__ieee754_rem_pio2, __kernel_sin, __kernel_cos; Sun Microsystems, 1993).
inline SinCos sinCos(double angle) {
  // Written so that NaN takes it.
  if (!(std::abs(angle) <= kLargestReducedAngle)) return {std::sin(angle), std::cos(angle)};
  // Adding and subtracting 1.5 x 2^52 rounds to an integer.
  constexpr double kRound = 6755399441055744.0;
  constexpr double kTwoOverPi = 6.36619772367581382433e-01;
  // pi/2 in three parts, of 33, 33 and 53 bits.
  constexpr double kFirst = 1.57079632673412561417e+00, kSecond = 6.07710050630396597660e-11, kThird = 2.02226624879595063154e-21;
  const double quarters = (angle * kTwoOverPi + kRound) - kRound;
  const double t = angle - quarters * kFirst;
  const double second = quarters * kSecond;
  const double r = t - second;
  const double w = quarters * kThird - ((t - r) - second);
  const double x = r - w;        // angle - quarters pi/2
  const double y = (r - x) - w;  // rounding error of x

  const double z = x * x;
  const double sine_terms = 8.33333333332248946124e-03 +
                            z * (-1.98412698298579493134e-04 +
                                 z * (2.75573137070700676789e-06 + z * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10)));
  const double v = z * x;
  const double sine = x - ((z * (0.5 * y - v * sine_terms) - y) - v * -1.66666666666666324348e-01);
  const double cosine_terms =
      z * (4.16666666666666019037e-02 +
           z * (-1.38888888888741095749e-03 +
                z * (2.48015872894767294178e-05 +
                     z * (-2.75573143513906633035e-07 + z * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11)))));
  const double half_square = 0.5 * z;
  const double rest = 1.0 - half_square;
  const double cosine = rest + (((1.0 - rest) - half_square) + (z * cosine_terms - x * y));

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
