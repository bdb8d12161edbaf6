// Where the library logs: the logger "taxelsim", to stderr unless the program has registered one of that name.
#pragma once

#include <spdlog/logger.h>

namespace taxelsim {

spdlog::logger& log();

}  // namespace taxelsim
