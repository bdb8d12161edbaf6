// The library's log. Lines go to the spdlog logger named "taxelsim". Where the program has registered none of that name, one that writes to
// stderr is created at the first line. Thread-safe.
#pragma once

#include <string_view>

namespace taxelsim {

void logDebug(std::string_view line);
void logWarning(std::string_view line);
void logError(std::string_view line);

}  // namespace taxelsim
