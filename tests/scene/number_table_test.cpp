// Tables of numbers: the values read, and the message of each error.
#include "scene/number_table.h"

#include "scene_text.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

Sensor grid(int num_rows, int num_cols, std::string name = "pad") {
  Sensor sensor;
  sensor.patches = {{.name = std::move(name), .num_rows = num_rows, .num_cols = num_cols, .pitch = {1, 1}, .X_SP = {}}};
  return sensor;
}

TEST(NumberTable, FindsColumnsByNameInSiUnits) {
  const testing::TemporaryDirectory directory;
  const NumberTable table(directory.write("t.csv", "# a bench\r\nforce_mN , counts,depth_um\r\n\r\n500,7,250 # a row\n-1,8,0\n"));
  EXPECT_EQ(table.numRows(), 2u);
  EXPECT_THAT(table.require(kForce), ElementsAre(0.5, -0.001));
  EXPECT_THAT(table.require(kDepth), ElementsAre(::testing::DoubleEq(250e-6), 0));
  EXPECT_THAT(table.require(kCounts), ElementsAre(7, 8));
  EXPECT_TRUE(table.find(kRecordedTime).empty());
}

TEST(NumberTable, FindsTaxelsByPattern) {
  const testing::TemporaryDirectory directory;
  const NumberTable table(directory.write("t.csv", "t,m_r01_c0,m_r00_c0,m_r00_c1,m_r01_c1\n0,1,2,3,4\n"));
  EXPECT_THAT(table.taxelColumns(grid(2, 2), "m_r{row}_c{col}"), ElementsAre(2, 3, 1, 4));
  EXPECT_THAT(table.taxelColumns(grid(2, 2), "m_r{col}_c{row}"), ElementsAre(2, 1, 3, 4));
  Sensor list = grid(1, 1, "m_r01_c0");
  list.patches.push_back(grid(1, 1, "t").patches[0]);
  EXPECT_THAT(list.patches.size(), 2u);
  EXPECT_THAT(table.taxelColumns(list, "{patch}"), ElementsAre(1, 0));
}

TEST(NumberTable, MessageNamesLineAndColumn) {
  const testing::TemporaryDirectory directory;
  const std::filesystem::path file = directory.write("t.csv", "# one\n\nforce_N,counts\n1,4\n# two\n2,5\n\n\n3,6\n");
  const NumberTable table(file);
  EXPECT_EQ(refusal(file, [&] { table.failAtValue(0, 0, "x"); }), ":4:1: force_N: x");
  EXPECT_EQ(refusal(file, [&] { table.failAtValue(1, 0, "x"); }), ":6:1: force_N: x");
  EXPECT_EQ(refusal(file, [&] { table.failAtValue(2, 1, "x"); }), ":9:3: counts: x");
}

TEST(NumberTable, RejectsBadFiles) {
  const testing::TemporaryDirectory directory;
  const std::vector<std::pair<std::string, std::string>> table = {
      {"", ":1:1: no row found"},
      {"force_N\n", ":2:1: no row found: the table needs a heading"},
      {"1,2\n3,4\n", ":1:1: \"1\" is not allowed: the first line must name the columns"},
      {"force_N,\n", ":1:9: \"\" is not allowed: the first line must name the columns"},
      {"force_N,counts,force_N\n1,2,3\n", ":1:16: \"force_N\" is given twice"},
      {"force_N,counts\n1\n", ":2:1: 1 values are not allowed: the heading has 2 names"},
      {"force_N,counts\n1,2,3\n", ":2:5: one value too many: the heading has 2 names"},
      {"force_N,counts\n1,nan\n", ":2:3: counts: \"nan\" is not allowed: a number from -1e+15 to 1e+15"},
      {"force_N,counts\n1,\n", ":2:3: counts: \"\" is not allowed"},
      {"force_N,counts\n1,1e16\n", ":2:3: counts: \"1e16\" is not allowed"},
      {std::string(std::size_t{5} << 20, '1'), ":1:1: a line longer than 4194304 bytes"},
      {"force_N;counts\n1;2\n", ":2:1: force_N;counts: \"1;2\" is not allowed"},
  };
  for (const auto& [text, message] : table) {
    const std::filesystem::path file = directory.write("t.csv", text);
    EXPECT_THAT(refusal(file, [&] { NumberTable{file}; }), ::testing::StartsWith(message)) << text;
  }
  EXPECT_THAT(refusal(directory.path(), [&] { NumberTable{directory.path()}; }), ::testing::StartsWith(": a directory, not a file"));
}

TEST(NumberTable, RejectsMissingAndAmbiguousColumns) {
  const testing::TemporaryDirectory directory;
  const std::filesystem::path file = directory.write("t.csv", "# bench\nforce_N,force_mN,r0_c0,r00_c0\n1,2,3,4\n");
  const NumberTable table(file);
  EXPECT_EQ(refusal(file, [&] { table.require(kDepth); }), ":2:1: missing column of the depth: depth_m or depth_mm or depth_um");
  EXPECT_EQ(refusal(file, [&] { table.require(kForce); }), ":2:1: force_N and force_mN are both given: only one is allowed");
  EXPECT_EQ(refusal(file, [&] { table.taxelColumns(grid(1, 1), "r{row}_c{col}"); }),
            ":2:1: \"r0_c0\" and \"r00_c0\" both match taxel 0 by the pattern \"r{row}_c{col}\"");
  EXPECT_EQ(refusal(file, [&] { table.taxelColumns(grid(1, 2), "r{row}_c{taxel}"); }),
            ":2:1: \"r0_c0\" and \"r00_c0\" both match taxel 0 by the pattern \"r{row}_c{taxel}\"");
  EXPECT_THAT(refusal(file, [&] { table.taxelColumns(grid(1, 1), "x{row}"); }),
              HasSubstr("missing column of taxel 0 (row 0, col 0 of patch \"pad\") by the pattern \"x{row}\""));
}

}  // namespace
}  // namespace taxelsim
