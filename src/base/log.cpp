#include "base/log.h"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <mutex>
#include <string>
#include <unordered_set>
#include <utility>

#include "taxelsim/log.h"

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

std::mutex mutex;
LogSink sink;

void log(LogLevel level, std::string_view line) {
  LogSink chosen;
  {
    const std::lock_guard lock(mutex);
    chosen = sink;
  }
  if (chosen) return chosen(level, line);
  switch (level) {
    case LogLevel::kDebug:
      return logger().debug(line);
    case LogLevel::kInfo:
      return logger().info(line);
    case LogLevel::kWarning:
      return logger().warn(line);
    case LogLevel::kError:
      return logger().error(line);
  }
}

bool isFirst(std::string_view line) {
  static std::unordered_set<std::string> lines;
  const std::lock_guard lock(mutex);
  return lines.emplace(line).second;
}

}  // namespace

void setLogSink(LogSink new_sink) {
  const std::lock_guard lock(mutex);
  sink = std::move(new_sink);
}

void logDebug(std::string_view line) {
  log(LogLevel::kDebug, line);
}

void logInfo(std::string_view line) {
  if (isFirst(line)) log(LogLevel::kInfo, line);
}

void logWarning(std::string_view line) {
  if (isFirst(line)) log(LogLevel::kWarning, line);
}

void logError(std::string_view line) {
  log(LogLevel::kError, line);
}

}  // namespace taxelsim
