// Angles of lines, which are equal modulo pi.
#pragma once

#include <cmath>
#include <numbers>

namespace taxelsim {

// Wraps the angle between two lines to (-pi/2, pi/2], by std::remainder().
inline double wrapLineAngle(double angle) {
  constexpr double kPi = std::numbers::pi;
  constexpr double kBelowThreeHalves = 4.7;  // rad, < 3/2 pi
  const double size = std::abs(angle);
  if (size < kPi / 2) return angle;
  // A difference of numbers within a factor of 2 is exact (Sterbenz), hence the remainder without its cost. That of pi has a sign.
  const bool is_near = size <= kBelowThreeHalves && size != kPi;
  const double wrapped = is_near ? angle - std::copysign(kPi, angle) : std::remainder(angle, kPi);
  return wrapped <= -kPi / 2 ? wrapped + kPi : wrapped;
}

}  // namespace taxelsim
