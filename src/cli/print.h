// Standard output. What files and arguments contain is escaped, so that it cannot control a terminal.
#pragma once

#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/text.h"

namespace taxelsim::cli {

// As fmt::print().
template <typename... Args>
void printOut(fmt::format_string<Args...> format, Args&&... args) {
  fmt::print("{}", printable(fmt::format(format, std::forward<Args>(args)...)));
}

// JSON in ASCII and a newline; bytes that are not UTF-8 are replaced. `indent`: spaces a level; -1 for one line.
inline void printJsonText(const nlohmann::ordered_json& json, int indent = 2) {
  fmt::print("{}\n", json.dump(indent, ' ', true, nlohmann::ordered_json::error_handler_t::replace));
}

// null for values that are not finite, which JSON cannot represent.
inline nlohmann::ordered_json numberOrNull(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

}  // namespace taxelsim::cli
