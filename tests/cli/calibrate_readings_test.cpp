// `calibrate-readings`: converts a table of counts to newtons, atomically.
#include "cli/command_line.h"
#include "cli/small_pad.h"
#include "support/test.h"

namespace taxelsim::testing {
namespace {

class CalibrateReadings : public ::testing::Test {
 protected:
  CalibrateReadings() { write("pad.yaml", kSmallPad); }

  std::string at(const std::string& name) const { return root_ / name; }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(at(name)) << text;
    return at(name);
  }
  // The small pad with additional keys of its readout.
  std::string padWith(const std::string& readout) const { return write("with.yaml", kSmallPad + readout); }

  Outcome run(const std::string& table, const std::string& sensor, std::vector<std::string> more = {}) const {
    more.insert(more.begin(), {"calibrate-readings", table, "--sensor", sensor, "-o", at("forces.csv")});
    return runTaxelsim(more);
  }

  // Lines of forces.csv after its heading.
  std::vector<std::vector<double>> forces() const {
    std::ifstream stream(at("forces.csv"));
    std::string line;
    std::getline(stream, line);
    std::vector<std::vector<double>> rows;
    while (std::getline(stream, line)) {
      std::istringstream cells(line);
      rows.emplace_back();
      for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(std::stod(cell));
    }
    return rows;
  }

 private:
  TemporaryDirectory root_;
};

constexpr double kWritten = 1e-8;  // N: nine digits of forces below 10 N

TEST_F(CalibrateReadings, ByHand) {
  const std::string table = write("raw.csv", "note,time_ms," + kSmallPadColumns + "9,500,100,200,0,0,0,1000\n9,750,0,0,0,0,0,0\n");
  const Outcome outcome = run(table, padWith("  taxel_gain: [1, 2, 1, 1, 0, 1]\n  taxel_trigger: [0, 0.05, 0, 0, 0, 0]\n"));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_TRUE(contentOf(at("forces.csv")).starts_with("time_s,r0_c0_N,r0_c1_N,r0_c2_N,r1_c0_N,r1_c1_N,r1_c2_N,total_force_N\n"));
  const std::vector<double> expected{0.5, 0.1, (0.2 + 0.05) / 2, 0, 0, 0, 1, 1.225};
  ASSERT_EQ(forces().size(), 2u);
  for (std::size_t k = 0; k < expected.size(); ++k) EXPECT_NEAR(forces()[0][k], expected[k], kWritten) << k;
  EXPECT_EQ(forces()[1], (std::vector<double>{0.75, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_NE(outcome.err.find("taxel_gain of taxels 4 is 0"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("1 readings are saturated"), std::string::npos) << outcome.err;
}

TEST_F(CalibrateReadings, PatternOfColumns) {
  const std::string table = write("raw.csv", "t05,t04,t03,t02,t01,t00\n1,2,3,4,5,600\n");
  ASSERT_EQ(run(table, at("pad.yaml"), {"--taxel-columns", "t{taxel}"}).status, 0);
  EXPECT_TRUE(contentOf(at("forces.csv")).starts_with("t00_N,t01_N,t02_N,"));
  EXPECT_NEAR(forces()[0][0], 0.6, kWritten);
}

// A force of 0.4 N on one taxel: 1000 x 0.4 x share counts on each, growing by half with a time constant of 1 s.
TEST_F(CalibrateReadings, RemovesCreepAndSpread) {
  // Shares of a force on taxel (0, 0) by the kernel (e^-2, 1, e^-2) x (e^-2, 1, e^-2), in storage order.
  const double q = std::exp(-2.0), all = (1 + q) * (1 + q);
  const std::vector<double> shares{1 / all, q / all, 0, q / all, q * q / all, 0};
  std::ostringstream text;
  text << "time_s," << kSmallPadColumns;
  for (const double time : {10.0, 11.0, 13.0}) {
    text << time;
    for (const double share : shares) text << "," << std::round(400 * share * (1 + 0.5 * (1 - std::exp(-(time - 10)))));
    text << "\n";
  }
  const std::string table = write("raw.csv", text.str()), sensor = padWith("  creep: [{fraction: 0.5, time: 1}]\n");
  ASSERT_EQ(run(table, sensor, {"--remove", "creep", "--remove", "psf"}).status, 0);
  // Half a count on each of six taxels, at most doubled by the inverse of creep; the smallest gain of the spread is (0.787 - 0.213)^2.
  constexpr double kTolerance = 2.45 * 2 * 0.0005 / 0.329;
  for (const std::vector<double>& row : forces()) {
    EXPECT_NEAR(row[1], 0.4, kTolerance);
    for (std::size_t t = 2; t <= 6; ++t) EXPECT_NEAR(row[t], 0, kTolerance);
  }
  ASSERT_EQ(run(table, sensor).status, 0);
  EXPECT_NEAR(forces()[2][1], 0.4 / all * (1 + 0.5 * (1 - std::exp(-3.0))), 0.0006) << "nothing removed";
}

TEST_F(CalibrateReadings, RefusesBadTables) {
  const auto refused = [&](const std::string& text, const std::string& part, const std::vector<std::string>& more = {}) {
    expectRefused(run(write("raw.csv", text), at("pad.yaml"), more), part);
    EXPECT_FALSE(std::filesystem::exists(at("forces.csv")));
  };
  refused("r0_c0,r0_c1,r0_c2\n1,2,3\n", "missing column of taxel 3");
  refused(kSmallPadColumns + "1,2,3,4,5,nan\n", "raw.csv:2:11");
  refused(kSmallPadColumns + "1,2,3,4,5,6\n1,2,3,4,5,1024\n", "raw.csv:3:11: r1_c2: 1024 is not allowed");
  refused(kSmallPadColumns + "1,2,3,4,5,-1\n", "0 to 1023 counts");
  refused(kSmallPadColumns + "1,2,3,4,5\n", "5 values are not allowed");
  refused(kSmallPadColumns + "1,2,3,4,5,6\n", "missing column of the time", {"--remove", "creep"});
  refused(kSmallPadColumns + "1,2,3,4,5,6\n", "--remove", {"--remove", "noise"});
  refused("time_s," + kSmallPadColumns + "1,1,2,3,4,5,6\n1,1,2,3,4,5,6\n", "raw.csv:3:1: time_s");
  expectRefused(run(at("none.csv"), at("pad.yaml")), "none.csv");
  expectRefused(run(write("raw.csv", kSmallPadColumns + "1,2,3,4,5,6\n"), at("none.yaml")), "none.yaml");
  expectRefused(run(at("raw.csv"), std::string(TAXELSIM_SOURCE_DIR) + "/scenes/sensors/fingertip_sphere.yaml"), "missing --taxel-columns");
}

TEST_F(CalibrateReadings, WritesAllOrNothing) {
  const std::string text = kSmallPadColumns + "1,2,3,4,5,6\n", table = write("raw.csv", text);
  for (const std::string& input : {table, at("pad.yaml")}) {
    const std::string before = contentOf(input);
    expectRefused(runTaxelsim({"calibrate-readings", table, "--sensor", at("pad.yaml"), "-o", input}), "it would overwrite");
    EXPECT_EQ(contentOf(input), before);
  }
  const Outcome unwritable = runTaxelsim({"calibrate-readings", table, "--sensor", at("pad.yaml"), "-o", at("none/forces.csv")});
  EXPECT_EQ(unwritable.status, 1) << unwritable.err;
  EXPECT_EQ(std::count(unwritable.err.begin(), unwritable.err.end(), '\n'), 1) << unwritable.err;

  write("forces.csv", "as before\n");
  write("raw.csv", text + "1,2,3,4,5,x\n");
  expectRefused(run(table, at("pad.yaml")), "raw.csv:3:11");
  EXPECT_EQ(contentOf(at("forces.csv")), "as before\n");
  write("raw.csv", text);
  ASSERT_EQ(run(table, at("pad.yaml")).status, 0);
  EXPECT_EQ(forces().size(), 1u);
  for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(at("")).parent_path())) {
    EXPECT_EQ(entry.path().filename().string().find(".tmp"), std::string::npos) << entry.path();
  }
}

}  // namespace
}  // namespace taxelsim::testing
