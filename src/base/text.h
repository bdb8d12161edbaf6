// Text for messages and logs, independent of the locale.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace taxelsim {

// Shortest decimal text that parses to the same double; "nan", "inf" or "-inf" for a value that is not finite.
std::string numberText(double value);

// Bytes of the UTF-8 sequence that begins at `i`, or 0 if it is invalid (overlong forms and surrogates are invalid).
std::size_t utf8Length(std::string_view text, std::size_t i);

// Text that cannot control a terminal, in valid UTF-8: control characters (C0 but newlines, DEL, C1), bytes that are not UTF-8 and marks
// that change the direction of text become "\x1b".
std::string printable(std::string_view text);

// The same on one line: newlines, carriage returns and tabs become spaces.
std::string oneLine(std::string_view text);

inline constexpr std::size_t kMaxMessageBytes = 400;
inline constexpr std::size_t kMaxShown = 40;  // bytes of a value from a file that a message repeats

// oneLine() of at most kMaxMessageBytes bytes. Keeps the start, which has the place, and the end, which has what is allowed.
std::string messageLine(std::string_view text);

// Levenshtein distance: the least number of inserted, removed and replaced bytes that make `a` into `b`.
std::size_t editDistance(std::string_view a, std::string_view b);

// Parses `text`, all of it, as one finite decimal number ("0.005", "5e-3"). Returns false, with `value` unspecified, for any other text.
bool parseNumber(std::string_view text, double& value);

}  // namespace taxelsim
