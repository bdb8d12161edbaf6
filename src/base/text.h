// Text for messages and logs, independent of the locale.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace taxelsim {

// Shortest decimal text that parses to the same double; "nan", "inf" or "-inf" for a value that is not finite.
std::string numberText(double value);

// Replaces every control character with a space, so that the text stays on one line and cannot control a terminal.
std::string oneLine(std::string_view text);

// Levenshtein distance: the least number of inserted, removed and replaced bytes that make `a` into `b`.
std::size_t editDistance(std::string_view a, std::string_view b);

// Parses `text`, all of it, as one finite decimal number ("0.005", "5e-3"). Returns false, with `value` unspecified, for any other text.
bool parseNumber(std::string_view text, double& value);

}  // namespace taxelsim
