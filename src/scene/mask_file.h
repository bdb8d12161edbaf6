// A footprint as a picture of numbers.
#pragma once

#include <filesystem>

#include "taxelsim/measurement.h"

namespace taxelsim {

// Numbers without a heading, >= 0: one line for each row of pixels along x, its values along y. Throws Error(kInput) with file, line and
// column: no such file, a line of another length, a value that is not allowed, more than kMaxMaskPixels, no pixel above 0.
FootprintMask readMask(const std::filesystem::path& file, double pixel);

inline constexpr std::size_t kMaxMaskPixels = std::size_t{1} << 22;

}  // namespace taxelsim
