// Numbers and tables as text for people.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace taxelsim::cli {

std::string bytesText(std::uint64_t bytes);  // "1.5 GiB"
std::string countText(std::uint64_t count);  // "12,345,678"
std::string durationText(double seconds);    // "1:02:03", "2:03"; "?" for a value that is not finite
std::string numberText(double value);        // four significant digits

// Columns lined up, two spaces between them; the first row is the heading. Cells that start with a digit or sign are aligned right.
std::string tableText(const std::vector<std::vector<std::string>>& rows);

}  // namespace taxelsim::cli
