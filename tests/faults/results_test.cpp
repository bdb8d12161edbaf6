// A lost or hung device, and refused pipelines, in the commands that print results: each ends with one line. `evaluate` prints the
// controllers that were complete, as an undisturbed run prints them; nothing else is printed, and no file is written in part.
#include <sys/resource.h>

#include <csignal>
#include <iostream>
#include <nlohmann/json.hpp>

#include "cli/small_task.h"
#include "faults/failing.h"
#include "support/cases.h"
#include "support/test.h"

namespace taxelsim::testing {
namespace {

const std::string kExperiment = std::string("format_version: 1\nname: small\nexperiment: static\nreference: ") + TAXELSIM_SOURCE_DIR +
                                "/scenes/sensors/wts0614_soft_cover.yaml\nsensors: [{sensor: " + TAXELSIM_SOURCE_DIR +
                                "/scenes/sensors/wts0614_soft_cover.yaml}]\nobjects:\n  - {name: ball, sphere: {radius_mm: 10}}\n"
                                "yaw_deg: [0, 45]\nloads: [1, 4]\n";

class FaultsOfResults : public ::testing::Test {
 protected:
  FaultsOfResults() {
    writeSmallTask(root_ / "task.yaml");
    std::ofstream(root_ / "experiment.yaml") << kExperiment;
  }

  Outcome evaluate(const std::vector<std::string>& arguments, const RunOptions& options = {}) {
    std::vector<std::string> all{"--log-level", "error", "evaluate", root_ / "task.yaml"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    return runTaxelsim(all, options);
  }

  Outcome experiment(const RunOptions& options = {}) {
    return runTaxelsim({"--log-level", "error", "experiment", root_ / "experiment.yaml", "--json", "-o", root_ / "figures"}, options);
  }

  // Runs with a failure at each `stride`-th call until the run ends before the failure. Returns the number of failures.
  template <typename Run, typename Check>
  static int failAtEach(int stride, const std::string& variable, Run run, Check check) {
    int num_failures = 0;
    for (int n = 1; n < kManyFaults; n += stride) {
      SCOPED_TRACE(variable + "=" + std::to_string(n));
      const Outcome outcome = run(failing(variable, n));
      if (outcome.status == 0) break;
      if (outcome.status == 2) return ADD_FAILURE() << outcome.err, 0;  // not what is tested
      expectDeviceError(outcome, variable == "TAXELSIM_FAIL_SUBMIT" ? "the device was lost during" : "failed: ErrorInitializationFailed");
      check(outcome);
      ++num_failures;
    }
    std::cout << num_failures << " failures with " << variable << std::endl;
    return num_failures;
  }

  void expectNoFigures() { EXPECT_TRUE(!std::filesystem::exists(root_ / "figures") || std::filesystem::is_empty(root_ / "figures")); }

  TemporaryDirectory root_;
};

TEST_F(FaultsOfResults, EvaluatedControllersSurviveALostDevice) {
  const nlohmann::json complete = nlohmann::json::parse(evaluate({"--json"}).out)["controllers"];
  std::size_t kept = 0;
  const int num_lost = failAtEach(
      support::numCases(90, 9), "TAXELSIM_FAIL_SUBMIT", [&](const RunOptions& lost) { return evaluate({"--json"}, lost); },
      [&](const Outcome& outcome) {
        const nlohmann::json found = outcome.out.empty() ? nlohmann::json::array() : nlohmann::json::parse(outcome.out)["controllers"];
        ASSERT_LE(found.size(), complete.size());
        EXPECT_GE(found.size(), kept) << "less than before an earlier loss";
        kept = found.size();
        for (std::size_t c = 0; c < kept; ++c) EXPECT_EQ(found[c], complete[c]);
      });
  EXPECT_GE(num_lost, 3) << "the layer has no effect";
  EXPECT_EQ(kept, 1u) << "the second controller is lost";
}

TEST_F(FaultsOfResults, PartOfAnEvaluationIsWrittenWholeOrNotAtAll) {
  const std::filesystem::path out = root_ / "parts";
  const int num_lost = failAtEach(
      support::numCases(150, 15), "TAXELSIM_FAIL_SUBMIT",
      [&](const RunOptions& lost) {
        return evaluate({"--part", "1/2", "-o", out}, lost);
      },
      [&](const Outcome& outcome) {
        EXPECT_EQ(outcome.out, "");
        EXPECT_FALSE(std::filesystem::exists(out));
      });
  EXPECT_GE(num_lost, 2);
  EXPECT_EQ(evaluate({"--part", "1/2", "-o", out}).status, 0);
}

TEST_F(FaultsOfResults, ExperimentOnALostDeviceDrawsNothing) {
  const auto run = [&](const RunOptions& lost) { return experiment(lost); };
  const auto check = [&](const Outcome& outcome) {
    EXPECT_EQ(outcome.out, "");
    expectNoFigures();
  };
  EXPECT_GE(failAtEach(support::numCases(3, 1), "TAXELSIM_FAIL_SUBMIT", run, check), 1);
  std::filesystem::remove_all(root_ / "figures");
  EXPECT_GE(failAtEach(support::numCases(4, 1), "TAXELSIM_FAIL_PIPELINE", run, check), 1);
}

TEST_F(FaultsOfResults, PictureOnAFullDiskIsWrittenWholeOrNotAtAll) {
  const std::filesystem::path png = root_ / "picture.png";
  const std::vector<std::string> command{
      "--log-level", "error", "frame", "--sensor", TAXELSIM_SOURCE_DIR "/scenes/sensors/wts0614_soft_cover.yaml", "--object", "sphere:0.01",
      "--load",      "1",     "--png", png};
  expectDeviceError(runTaxelsim(command, {.limits = {{RLIMIT_FSIZE, 4096}}}), "cannot write");
  EXPECT_FALSE(std::filesystem::exists(png));
}

TEST_F(FaultsOfResults, HungDeviceIsLeftByCtrlC) {
  RunOptions options = failing("TAXELSIM_HANG_SUBMIT", 2);
  options.signal = SIGINT;
  options.signal_after = 1;  // s, until the device hangs, or earlier on a slow machine: the program ends as well
  options.num_signals = 2;
  const Outcome evaluated = evaluate({"--part", "1/2", "-o", root_ / "parts"}, options);
  EXPECT_EQ(evaluated.status, 128 + SIGINT) << evaluated.err;
  EXPECT_FALSE(std::filesystem::exists(root_ / "parts"));
  options.num_signals = 1;  // it keeps nothing that the first one could wait for
  EXPECT_EQ(experiment(options).status, 128 + SIGINT);
  expectNoFigures();
}

}  // namespace
}  // namespace taxelsim::testing
