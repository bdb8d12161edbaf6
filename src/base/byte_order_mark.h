// The byte order mark of UTF-8, which some editors put before text.
#pragma once

#include <string_view>

namespace taxelsim {

inline std::string_view withoutByteOrderMark(std::string_view text) {
  constexpr std::string_view kMark = "\xEF\xBB\xBF";
  return text.substr(text.starts_with(kMark) ? kMark.size() : 0);
}

}  // namespace taxelsim
