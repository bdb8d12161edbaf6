// The two-parameter foundation of the tests of the law `pasternak`.
#pragma once

namespace taxelsim {

inline constexpr double kStiffness = 5e8;  // N/m^3
inline constexpr double kDecay = 0.66e-3;  // m
// Sweeps after which the free surface is at rest to float32 rounding: a sweep reduces errors to 0.63.
inline constexpr int kManySweeps = 60;

}  // namespace taxelsim
