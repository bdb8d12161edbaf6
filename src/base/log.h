// The library's log. Lines go to the sink of taxelsim/log.h. Thread-safe.
#pragma once

#include <string_view>

namespace taxelsim {

void logDebug(std::string_view line);
// A line of these two that was logged before is dropped.
void logInfo(std::string_view line);
void logWarning(std::string_view line);
void logError(std::string_view line);

}  // namespace taxelsim
