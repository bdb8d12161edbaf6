// Values as they appear in error lines: short, exact, the same in every locale. Not for file formats.
#pragma once

#include <string>
#include <string_view>

namespace taxelsim {

// Shortest decimal text that reads back as the same double; "nan", "inf", "-inf" otherwise.
std::string numberText(double value);

// The text with every control character replaced by a blank, so that it fits into one line.
std::string oneLine(std::string_view text);

// Reads all of `text` as one finite decimal number ("0.005", "5e-3"). False when it is anything else.
bool parseNumber(std::string_view text, double& value);

}  // namespace taxelsim
