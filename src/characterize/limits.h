// Limits that several fits share.
#pragma once

namespace taxelsim {

inline constexpr double kStill = 2;            // counts: an output that changes by no more has no contact
inline constexpr double kSteady = 5;           // s after contact: the time that the image of a stamp stands for
inline constexpr double kMostOfLimit = 0.999;  // upper bound of (end of the range) / (limit of the divider)
inline constexpr double kMostPerKelvin = 0.1;  // bound of the growth of the gain
inline constexpr double kOutlier = 4.5;        // standard deviations: probability 1 in 150,000 for a Gaussian

}  // namespace taxelsim
