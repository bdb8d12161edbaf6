// Command lists: copies, fills, timestamps and misuse, under the validation layers.
#include <chrono>

#include "gpu/commands.h"
#include "gpu/device_access.h"
#include "support/test.h"
#include "taxelsim/device.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

const Device& device() {
  static const Device opened = Device::open({.validation = true});
  return opened;
}

TEST(CommandsOnEveryDriver, CopyIntoBuffersThatStartAtZero) {
  gpu::Context& context = gpu::contextOf(device());
  std::vector<std::uint32_t> values(1000);
  std::iota(values.begin(), values.end(), 7u);
  const gpu::Buffer source = gpu::makeStaticBuffer(context, "source", std::span<const std::uint32_t>(values));
  const gpu::Buffer target(context, "target", values.size() * 4, gpu::Domain::kReadback);
  for (const std::uint32_t word : target.mappedAs<std::uint32_t>()) ASSERT_EQ(word, 0u);

  gpu::Commands commands(context, "copy", 2);
  commands.timestamp(0);
  commands.copy(source, target, source.size());
  commands.timestamp(1);
  commands.barrier(gpu::Access::kCopy, gpu::Access::kHostRead);
  commands.end();
  for (int run = 0; run < 3; ++run) {  // recorded once, submitted several times
    commands.submit();
    commands.wait();
    const std::span<std::uint32_t> copied = target.mappedAs<std::uint32_t>();
    ASSERT_TRUE(std::equal(values.begin(), values.end(), copied.begin()));
    const double seconds = commands.seconds(0, 1);
    EXPECT_TRUE(std::isnan(seconds) || (seconds >= 0 && seconds < 10)) << seconds;
    std::fill(copied.begin(), copied.end(), 0u);
  }
}

// Two slices of a batch alternate: waiting for the first list and reading its timestamps must not wait for the second.
TEST(CommandsInTurn, WaitForOneListOnly) {
  gpu::Context& context = gpu::contextOf(device());
  const gpu::Buffer buffer(context, "buffer", std::size_t{64} << 20, gpu::Domain::kDevice);
  const auto fills = [&](int num_fills) {
    gpu::Commands commands(context, "fills", 2);
    commands.timestamp(0);
    for (int k = 0; k < num_fills; ++k) {
      commands.fillZero(buffer);
      commands.barrier(gpu::Access::kCopy, gpu::Access::kCopy);
    }
    commands.timestamp(1);
    commands.end();
    return commands;
  };
  constexpr int kShort = 1, kLong = 40;
  gpu::Commands first = fills(kShort), second = fills(kLong);
  first.submit();
  second.submit();
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  first.wait();
  const Clock::time_point between = Clock::now();
  second.wait();
  EXPECT_LT(between - start, (Clock::now() - start) / 2);
  EXPECT_GT(second.seconds(0, 1), first.seconds(0, 1));
}

TEST(CommandsOnEveryDriver, FillBuffersWithZeros) {
  gpu::Context& context = gpu::contextOf(device());
  const gpu::Buffer buffer(context, "buffer", 64, gpu::Domain::kReadback);
  for (std::uint32_t& word : buffer.mappedAs<std::uint32_t>()) word = 1;
  gpu::Commands commands(context, "fill");
  commands.barrier(gpu::Access::kHostWrite, gpu::Access::kCopy);
  commands.fillZero(buffer);
  commands.barrier(gpu::Access::kCopy, gpu::Access::kHostRead);
  commands.end();
  commands.submit();
  commands.wait();
  for (const std::uint32_t word : buffer.mappedAs<std::uint32_t>()) EXPECT_EQ(word, 0u);
}

TEST(CommandsOnEveryDriver, RejectsASecondSubmitBeforeWait) {
  gpu::Commands commands(gpu::contextOf(device()), "empty");
  commands.end();
  commands.submit();
  EXPECT_THROW(commands.submit(), std::logic_error);
  commands.wait();
  commands.wait();  // does nothing without a submit
}

TEST(CommandsOnEveryDriver, ReportsValidationErrors) {
  gpu::Context& context = gpu::contextOf(device());
  const gpu::Buffer small(context, "small", 16, gpu::Domain::kDevice);
  const gpu::Buffer large(context, "large", 64, gpu::Domain::kDevice);
  gpu::Commands commands(context, "a copy past the end");
  commands.copy(large, small, 64);
  commands.end();
  commands.finish();
  EXPECT_THROW(context.throwOnValidationMessage(), Error);
}

TEST(CommandsOnEveryDriver, ReportsSynchronisationErrors) {
  gpu::Context& context = gpu::contextOf(device());
  const gpu::Buffer first(context, "first", 64, gpu::Domain::kDevice);
  const gpu::Buffer second(context, "second", 64, gpu::Domain::kDevice);
  gpu::Commands commands(context, "a copy of what is still being copied");
  commands.copy(first, second, 64);
  commands.copy(second, first, 64);  // no barrier between
  commands.end();
  commands.finish();
  EXPECT_THROW(context.throwOnValidationMessage(), Error);
}

}  // namespace
}  // namespace taxelsim
