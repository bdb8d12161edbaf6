// `evaluate` of a scene of kind grasp: table, JSON and figure, gains, and refusals. `experiment` with one.
#include <nlohmann/json.hpp>

#include "cli/command_line.h"
#include "cli/picture.h"
#include "cli/small_task.h"
#include "support/test.h"

namespace taxelsim::testing {
namespace {

using ::testing::HasSubstr;

const std::string kScene = std::string(TAXELSIM_SOURCE_DIR) + "/scenes/gripper_grasp.yaml";

TEST(EvaluateGraspScene, JsonAndPicture) {
  const TemporaryDirectory root;
  const nlohmann::json json =
      jsonOf({"evaluate", kScene, "--episodes", "3", "--gain", "20", "--gain", "5", "--json", "--png", root / "grasp.png"});
  EXPECT_EQ(json["success"], "success: in every frame of the last 0.5 s, the force of each finger within 10 % of its target");
  ASSERT_EQ(json["gains"].size(), 2u);
  const nlohmann::json& fast = json["gains"][0];
  EXPECT_EQ(fast["gain"], 20);
  EXPECT_EQ(json["gains"][1]["gain"], 5);
  EXPECT_EQ(fast["total"]["name"], "all fingers");
  EXPECT_EQ(fast["total"]["success_rate"], 1);
  EXPECT_LT(fast["total"]["force_error"]["max"], 0.1);
  EXPECT_EQ(fast["by_finger"][1]["name"], "below");
  ASSERT_EQ(fast["episodes"].size(), 3u);
  EXPECT_EQ(fast["episodes"][2]["fingers"]["left"]["target_force"], json["gains"][1]["episodes"][2]["fingers"]["left"]["target_force"]);
  const Picture picture(root / "grasp.png");
  EXPECT_GT(picture.width(), picture.height());
}

TEST(EvaluateGraspScene, TableHasARowPerFinger) {
  const Outcome outcome = succeed({"evaluate", kScene, "--episodes", "2"});
  for (const char* const text : {"gripper_grasp: 2 episodes per gain\n", "success (95 %)", "all fingers", "left ", "below "})
    EXPECT_THAT(outcome.out, HasSubstr(text)) << text << outcome.out;
}

TEST(EvaluateGraspScene, PartsTogetherPrintWhatOneProcessPrints) {
  const TemporaryDirectory root;
  const std::vector<std::string> words{"evaluate", kScene, "--episodes", "3", "--gain", "20", "--gain", "5"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), words.begin(), words.end());
    return more;
  };
  for (const char* const part : {"1/2", "2/2", "2/2"}) succeed(with({"--part", part, "-o", root / "out"}));
  EXPECT_EQ(succeed(with({"--merge", root / "out", "--json"})).out, succeed(with({"--json"})).out);
}

TEST(EvaluateGraspScene, RefusesOptionsOfOtherScenes) {
  const TemporaryDirectory root;
  const std::vector<std::vector<std::string>> all{
      {"--controller", "a"}, {"--merge", root / "out"}, {"--episode-range", "0..64", "-o", root / "out"}, {"--gain", "0"}};
  for (const std::vector<std::string>& options : all) {
    std::vector<std::string> words{"evaluate", kScene};
    words.insert(words.end(), options.begin(), options.end());
    const Outcome outcome = runTaxelsim(words);
    EXPECT_EQ(outcome.status, 2) << options[0];
    EXPECT_THAT(outcome.err, HasSubstr(options[0] == "--gain" ? "gain" : options[0] == "--merge" ? "is not a directory" : options[0]));
    EXPECT_EQ(outcome.err.find('\n'), outcome.err.size() - 1) << outcome.err;
  }
  writeSmallTask(root / "small.yaml");
  const Outcome servo = runTaxelsim({"evaluate", root / "small.yaml", "--gain", "5"});
  EXPECT_EQ(servo.status, 2);
  EXPECT_THAT(servo.err, HasSubstr("--gain is for scenes of kind grasp"));
}

TEST(GraspExperimentFile, TableJsonAndFigure) {
  const TemporaryDirectory root;
  const std::string file = std::string(TAXELSIM_SOURCE_DIR) + "/scenes/experiments/gripper_gains.yaml";
  const Outcome table = succeed({"experiment", file, "-o", root / "figures"});
  for (const char* const text : {"gripper_gains: settling", "decay per frame", "in theory", "left", "below"})
    EXPECT_THAT(table.out, HasSubstr(text)) << text << table.out;
  const Picture picture(root / "figures/forces.png");
  EXPECT_GT(picture.width(), picture.height());
  const nlohmann::json json = nlohmann::json::parse(runTaxelsim({"experiment", file, "--json"}).out);
  ASSERT_EQ(json["runs"].size(), 3u);
  EXPECT_EQ(json["runs"][1]["gain"], 10);
  EXPECT_EQ(json["runs"][1]["fingers"][0]["force"].size(), 150u);
}

TEST(GraspExperimentFile, RefusesBadFiles) {
  const TemporaryDirectory root;
  const auto refused = [&](const std::string& scene, const std::string& rest, const std::string& expected) {
    std::ofstream(root / "e.yaml") << "format_version: 1\nname: e\nexperiment: grasp\nscene: " + scene + "\n" + rest;
    const Outcome outcome = runTaxelsim({"experiment", root / "e.yaml"});
    EXPECT_EQ(outcome.status, 2);
    EXPECT_THAT(outcome.err, HasSubstr(expected));
    EXPECT_EQ(outcome.err.find('\n'), outcome.err.size() - 1) << outcome.err;
  };
  const std::string scenes = std::string(TAXELSIM_SOURCE_DIR) + "/scenes/";
  refused(scenes + "edge_servo.yaml", "gains: [10]\n", "is a scene of kind servo: one of kind grasp");
  refused(kScene, "gains: [101]\n", "gains[0]: 101 is not allowed: a number > 0 and <= 100 1/s");
  refused(kScene, "", "gains is missing");
  refused(kScene, "gains: [10]\nruns: []\n", "unknown key");
}

}  // namespace
}  // namespace taxelsim::testing
