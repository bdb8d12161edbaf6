#include "control/values.h"

#include <spdlog/fmt/fmt.h>

#include "taxelsim/error.h"

namespace taxelsim {

void requireValue(bool holds, const char* what, const char* field, double value, const char* allowed) {
  if (!holds) throw Error(ErrorKind::kInput, fmt::format("{}: {}: {} is not allowed: {}", what, field, value, allowed));
}

}  // namespace taxelsim
