/// @file
/// Where the log messages of the library go.
#pragma once

#include <functional>
#include <string_view>

namespace taxelsim {

/// Severity of a log message.
enum class LogLevel {
  kDebug,    ///< For developers.
  kInfo,     ///< Settings that are allowed but seldom meant. Each text is logged once per process.
  kWarning,  ///< Settings that are allowed but look wrong. Each text is logged once per process.
  kError,    ///< Messages of Vulkan's validation layers.
};

/// Receives a message, one line without its end. Called by any thread, by several at once; must not throw.
using LogSink = std::function<void(LogLevel level, std::string_view line)>;

/// Sends all messages to `sink`. Empty (default): to the spdlog logger named "taxelsim", or to stderr if the program has registered none.
/// Any thread may call it.
void setLogSink(LogSink sink);

}  // namespace taxelsim
