// Mesa's version in what a driver says of itself.
#pragma once

#include <charconv>
#include <string_view>

namespace taxelsim {

// Major version after "Mesa "; 0 where there is none.
inline int majorOfMesa(std::string_view driver) {
  constexpr std::string_view kMesa = "Mesa ";
  const std::size_t at = driver.find(kMesa);
  if (at == std::string_view::npos) return 0;
  const std::string_view version = driver.substr(at + kMesa.size());
  int major = 0;
  std::from_chars(version.data(), version.data() + version.size(), major);
  return major;
}

}  // namespace taxelsim
