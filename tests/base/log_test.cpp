#include "base/log.h"

#include "support/test.h"
#include "taxelsim/log.h"

namespace taxelsim {
namespace {

TEST(Log, SinkGetsEachWarningOnce) {
  std::vector<std::pair<LogLevel, std::string>> found;
  setLogSink([&](LogLevel level, std::string_view line) { found.emplace_back(level, line); });
  for (int i = 0; i < 2; ++i) {
    logDebug("a step");
    logWarning("a small object");
    logWarning("a large object");
    logError("a broken device");
  }
  setLogSink({});
  const std::vector<std::pair<LogLevel, std::string>> expected{
      {LogLevel::kDebug, "a step"},          {LogLevel::kWarning, "a small object"}, {LogLevel::kWarning, "a large object"},
      {LogLevel::kError, "a broken device"}, {LogLevel::kDebug, "a step"},           {LogLevel::kError, "a broken device"}};
  EXPECT_EQ(found, expected);
}

}  // namespace
}  // namespace taxelsim
