// Where the library logs, line by line: to the logger "taxelsim" of spdlog, on stderr unless the program has registered one of that name.
#pragma once

#include <string_view>

namespace taxelsim {

void logDebug(std::string_view line);
void logError(std::string_view line);

}  // namespace taxelsim
