// Formatting of numbers and tables.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace taxelsim::figures {

std::string bytesText(std::uint64_t bytes);  // "1.5 GiB"
std::string countText(std::uint64_t count);  // "12,345,678"
std::string durationText(double seconds);    // "1:02:03", "2:03"; "?" if not finite
std::string roundedText(double value);       // four significant digits

// Aligned columns, two spaces apart; the first row is the heading. Cells that start with a digit or sign are right-aligned.
std::string tableText(const std::vector<std::vector<std::string>>& rows);

}  // namespace taxelsim::figures
