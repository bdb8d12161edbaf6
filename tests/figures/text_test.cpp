// Formatting of numbers, tables and progress.
#include "figures/text.h"

#include <gtest/gtest.h>

#include <limits>

#include "cli/progress.h"

namespace taxelsim::figures {
namespace {

TEST(Text, Numbers) {
  EXPECT_EQ(bytesText(0), "0 B");
  EXPECT_EQ(bytesText(1536), "1.50 KiB");
  EXPECT_EQ(bytesText(std::uint64_t{139} << 30), "139 GiB");
  EXPECT_EQ(bytesText(std::numeric_limits<std::uint64_t>::max()), "16.0 EiB");
  EXPECT_EQ(countText(0), "0");
  EXPECT_EQ(countText(999), "999");
  EXPECT_EQ(countText(1234567), "1,234,567");
  EXPECT_EQ(durationText(59.4), "0:59");
  EXPECT_EQ(durationText(3661), "1:01:01");
  EXPECT_EQ(durationText(std::numeric_limits<double>::quiet_NaN()), "?");
  EXPECT_EQ(durationText(std::numeric_limits<double>::infinity()), "?");
}

TEST(Text, TableIsAligned) {
  EXPECT_EQ(tableText({{"name", "value"}, {"é", "7"}, {"long", "12.5"}}), "name  value\né         7\nlong   12.5\n");
}

TEST(Text, Progress) {
  Progress progress;
  progress.num_episodes = 1000;
  EXPECT_EQ(cli::progressLine(progress), "  0 %  0 of 1,000 episodes  0 frames/s  ? left");
  progress.episodes_done = 400;
  progress.episodes_resumed = 100;
  progress.frames_done = 30000;
  progress.seconds = 10;
  EXPECT_EQ(cli::progressLine(progress), " 40 %  400 of 1,000 episodes  3,000 frames/s  0:20 left")
      << "300 episodes took 10 s, 600 are left";
  EXPECT_EQ(cli::progressBar(progress, 200).find("[############..................]"), 0u);
  for (int width = 0; width < 120; ++width) EXPECT_LE(cli::progressBar(progress, width).size(), static_cast<std::size_t>(width));
}

}  // namespace
}  // namespace taxelsim::figures
