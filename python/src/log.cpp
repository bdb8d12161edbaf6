// The library's log messages as records of Python's logger "taxelsim".
#include "taxelsim/log.h"

#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "without_gil.h"

namespace taxelsim::python {
namespace {

struct Message {
  LogLevel level;
  std::string line;
};

std::mutex mutex;
std::vector<Message> messages;

// Levels of Python's module logging.
int pythonLevel(LogLevel level) {
  switch (level) {
    case LogLevel::kDebug:
      return 10;
    case LogLevel::kInfo:
      return 20;
    case LogLevel::kWarning:
      return 30;
    case LogLevel::kError:
      return 40;
  }
  return 0;
}

int deliverInMainThread(void*) {
  deliverMessages();
  return 0;
}

void enqueue(LogLevel level, std::string_view line) {
  const std::lock_guard lock(mutex);
  messages.push_back({level, std::string(line)});
  if (messages.size() == 1) Py_AddPendingCall(&deliverInMainThread, nullptr);
}

}  // namespace

void deliverMessages() noexcept {
  std::vector<Message> taken;
  {
    const std::lock_guard lock(mutex);
    taken.swap(messages);
  }
  if (taken.empty()) return;
  const nb::error_scope kept_error;
  try {
    const nb::object log = nb::module_::import_("taxelsim._log").attr("logger").attr("log");
    for (const Message& message : taken) log(pythonLevel(message.level), message.line.c_str());
  } catch (nb::python_error& error) {
    error.discard_as_unraisable("logger of taxelsim");
  }
}

void bindLog(nb::module_&) {
  setLogSink(&enqueue);
  // The interpreter that ends runs no logger.
  nb::module_::import_("atexit").attr("register")(nb::cpp_function([] {
    deliverMessages();
    setLogSink({});
  }));
}

}  // namespace taxelsim::python
