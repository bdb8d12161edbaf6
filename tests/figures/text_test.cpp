// Formatting of numbers and tables.
#include "figures/text.h"
#include "support/test.h"

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

}  // namespace
}  // namespace taxelsim::figures
