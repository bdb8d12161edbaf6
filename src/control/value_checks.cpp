#include "control/value_checks.h"

#include <spdlog/fmt/fmt.h>

#include "taxelsim/error.h"

namespace taxelsim {

void requireValue(bool is_valid, const char* object, const char* field, double value, const char* allowed) {
  if (!is_valid) throw Error(ErrorKind::kInput, fmt::format("{}: {}: {} is not allowed: {}", object, field, value, allowed));
}

}  // namespace taxelsim
