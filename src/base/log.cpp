#include "base/log.h"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

namespace taxelsim {

spdlog::logger& log() {
  constexpr const char* kName = "taxelsim";
  static const std::shared_ptr<spdlog::logger> logger = [] {
    std::shared_ptr<spdlog::logger> registered = spdlog::get(kName);
    return registered ? registered : spdlog::stderr_color_mt(kName);
  }();
  return *logger;
}

}  // namespace taxelsim
