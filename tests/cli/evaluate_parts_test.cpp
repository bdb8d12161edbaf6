// `evaluate --part`, `--episode-range` and `--merge`: the same table as one process, and refusals.
#include "cli/command_line.h"
#include "cli/small_task.h"
#include "support/test.h"

namespace taxelsim::testing {
namespace {

class EvaluateParts : public ::testing::Test {
 protected:
  EvaluateParts() { writeSmallTask(scene_); }

  Outcome run(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), {"--log-level", "error", "evaluate", scene_});
    return runTaxelsim(arguments);
  }

  TemporaryDirectory root_;
  const std::string scene_ = root_ / "small.yaml", out_ = root_ / "out";
};

TEST_F(EvaluateParts, PrintWhatOneProcessPrints) {
  for (const auto& arguments : {std::vector<std::string>{"--part", "1/3"}, {"--part", "3/3"}, {"--episode-range", "10..30"}}) {
    std::vector<std::string> command{"-o", out_};
    command.insert(command.end(), arguments.begin(), arguments.end());
    const Outcome outcome = run(command);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_NE(outcome.out.find(" episodes per controller; `taxelsim evaluate --merge " + out_ + "`"), std::string::npos) << outcome.out;
  }
  EXPECT_EQ(run({"--merge", out_, "--json"}).out, run({"--json"}).out);
  EXPECT_EQ(run({"--merge", out_}).out, run({}).out);
  EXPECT_NE(run({"--part", "1/3", "-o", out_}).out.find("14 episodes per controller found on disk"), std::string::npos);

  const std::string part = out_ + "/episodes-00000000-00000013.json";
  for (const char* command : {"--merge", "-o"}) {
    const std::vector<std::string> more =
        command == std::string("-o") ? std::vector<std::string>{"--part", "1/3"} : std::vector<std::string>{};
    const auto refuse = [&](std::vector<std::string> arguments, const std::string& message) {
      arguments.insert(arguments.end(), {command, out_});
      arguments.insert(arguments.end(), more.begin(), more.end());
      expectRefused(run(arguments), part + ": " + message);
    };
    refuse({"--seed", "4"}, "has another seed (3 there, 4 expected)");
    refuse({"--controller", "none"}, "has the controllers fast, none, none requested");
    if (more.empty()) refuse({"--episodes", "41"}, "has another number of episodes (40 there, 41 expected)");
  }
  std::filesystem::remove(part);
  expectRefused(run({"--merge", out_}), "episodes 0..9 are missing in the parts of the evaluation; 10 of 40 are missing in all");
  std::ofstream(part) << contentOf(out_ + "/episodes-00000010-00000030.json").substr(0, 2000);
  expectRefused(run({"--merge", out_}), part + ": is not part of an evaluation by taxelsim");
}

TEST_F(EvaluateParts, ArgumentsThatAreNoneAreRefused) {
  for (const char* value : {"5..2", "1-2", "..3", "-1..3"}) {
    expectRefused(run({"-o", out_, "--episode-range", value}), "is not FIRST..LAST");
  }
  for (const char* value : {"0/3", "4/3", "3"}) expectRefused(run({"-o", out_, "--part", value}), "is not K/N");
  expectRefused(run({"-o", out_, "--episode-range", "30..40"}), "--episode-range: 30..40 is not allowed: the scene has episodes 0 to 39");
  expectRefused(run({"-o", out_}), "--output: needs --episode-range or --part");
  expectRefused(run({"--part", "1/2"}), "--output");
  expectRefused(run({"--merge", root_ / "missing"}), "missing: is not a directory");
  expectRefused(run({"--merge", root_ / ""}), "has no part of an evaluation (episodes-*.json)");
  EXPECT_EQ(run({"--merge", out_, "-o", out_}).status, 2);
  const Outcome empty = run({"--part", "50/50", "-o", out_});
  EXPECT_EQ(empty.status, 0) << empty.err;
  EXPECT_NE(empty.out.find("part 50/50 of 40 episodes is empty"), std::string::npos) << empty.out;
  EXPECT_FALSE(std::filesystem::exists(out_));
}

}  // namespace
}  // namespace taxelsim::testing
