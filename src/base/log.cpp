#include "base/log.h"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

namespace taxelsim {
namespace {

spdlog::logger& logger() {
  constexpr const char* kName = "taxelsim";
  static const std::shared_ptr<spdlog::logger> logger = [] {
    std::shared_ptr<spdlog::logger> registered = spdlog::get(kName);
    return registered ? registered : spdlog::stderr_color_mt(kName);
  }();
  return *logger;
}

}  // namespace

void logDebug(std::string_view line) {
  logger().debug(line);
}

void logWarning(std::string_view line) {
  logger().warn(line);
}

void logError(std::string_view line) {
  logger().error(line);
}

}  // namespace taxelsim
