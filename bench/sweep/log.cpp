// Replaces src/base/log.cpp: errors to stderr, other levels dropped, so that the program needs no logging library.
#include "base/log.h"

#include <cstdio>

namespace taxelsim {

void logDebug(std::string_view /*line*/) {}
void logWarning(std::string_view /*line*/) {}

void logError(std::string_view line) {
  std::fprintf(stderr, "%.*s\n", static_cast<int>(line.size()), line.data());
}

}  // namespace taxelsim
