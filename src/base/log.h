// The library's log. Lines go to the sink of taxelsim/log.h. Thread-safe.
#pragma once

#include <string_view>

namespace taxelsim {

void logDebug(std::string_view line);
// A line that was logged before is dropped.
void logWarning(std::string_view line);
void logError(std::string_view line);

}  // namespace taxelsim
