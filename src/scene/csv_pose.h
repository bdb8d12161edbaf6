// Poses in CSV files: x_m, y_m, z_m, qw, qx, qy, qz.
#pragma once

#include <array>
#include <span>

#include "scene/csv_reader.h"
#include "taxelsim/pose.h"

namespace taxelsim {

inline constexpr double kLargestCsvPosition = 1e6;  // m
inline constexpr double kCsvUnitTolerance = 1e-3;   // a quaternion of unit length written with four digits
inline constexpr double kLargestCsvPart = 1 + kCsvUnitTolerance;
inline constexpr std::array<CsvColumn, 7> kPoseColumns = {{{"x_m", -kLargestCsvPosition, kLargestCsvPosition, "m"},
                                                           {"y_m", -kLargestCsvPosition, kLargestCsvPosition, "m"},
                                                           {"z_m", -kLargestCsvPosition, kLargestCsvPosition, "m"},
                                                           {"qw", -kLargestCsvPart, kLargestCsvPart},
                                                           {"qx", -kLargestCsvPart, kLargestCsvPart},
                                                           {"qy", -kLargestCsvPart, kLargestCsvPart},
                                                           {"qz", -kLargestCsvPart, kLargestCsvPart}}};

// The pose in the fields `first` to first + 6 of a line with these numbers. Throws as CsvReader::fail() does unless the quaternion has unit
// length.
Pose csvPose(std::span<const double> numbers, std::size_t first, const CsvReader& at);

}  // namespace taxelsim
