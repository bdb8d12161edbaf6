// `evaluate`: table, JSON and figure of a small task, and refusals.
#include <chrono>
#include <csignal>
#include <nlohmann/json.hpp>

#include "cli/command_line.h"
#include "cli/picture.h"
#include "cli/small_task.h"
#include "support/test.h"

namespace taxelsim::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class Evaluate : public ::testing::Test {
 protected:
  Evaluate() { writeSmallTask(scene_); }

  TemporaryDirectory root_;
  std::filesystem::path scene_ = root_ / "small.yaml";
};

TEST_F(Evaluate, JsonAndPicture) {
  const nlohmann::json json = jsonOf({"evaluate", scene_, "--json", "--png", root_ / "small.png"});
  ASSERT_EQ(json["controllers"].size(), 2u);
  const nlohmann::json &fast = json["controllers"][0], &none = json["controllers"][1];
  EXPECT_EQ(fast["controller"], "fast");
  EXPECT_EQ(fast["total"]["episodes"], 40);
  EXPECT_EQ(fast["total"]["success_rate"], 1);
  EXPECT_LT(none["total"]["success_rate"], 0.3);  // only those that start within 3 of 40 degrees
  EXPECT_EQ(fast["episodes"].size(), 40u);
  EXPECT_EQ(fast["episodes"][7]["start_error"], none["episodes"][7]["start_error"]);
  EXPECT_EQ(fast["by_object"][0]["name"], "cylinder");
  const Picture picture(root_ / "small.png");
  EXPECT_GT(picture.width(), picture.height());
}

TEST_F(Evaluate, TableOfOneController) {
  const Outcome outcome = succeed({"evaluate", scene_, "--controller", "none", "--episodes", "10"});
  EXPECT_THAT(outcome.out, HasSubstr("none"));
  EXPECT_THAT(outcome.out, Not(HasSubstr("fast")));
  EXPECT_THAT(outcome.out, HasSubstr("success (95 %)"));
}

TEST_F(Evaluate, PrintsItsSuccessRuleAndNamesItsSubsets) {
  const Outcome outcome = succeed({"evaluate", scene_, "--episodes", "10", "--png", root_ / "small.png"});
  EXPECT_THAT(outcome.out, HasSubstr("success: in every frame of the last 0.1 s, contact, edge_angle within 3 deg of 90 deg\n"));
  EXPECT_THAT(outcome.out, HasSubstr("deg at the start "));
  EXPECT_THAT(outcome.err, HasSubstr("info: wrote " + (root_ / "small.png").string()));
  const nlohmann::json json = nlohmann::json::parse(runTaxelsim({"evaluate", scene_, "--episodes", "10", "--json"}).out);
  EXPECT_EQ(json["success"], "success: in every frame of the last 0.1 s, contact, edge_angle within 3 deg of 90 deg");
  EXPECT_TRUE(json["controllers"][0]["by_start"][0]["name"].get<std::string>().starts_with("edge_angle error "));
}

TEST_F(Evaluate, SuccessRuleHasEveryCriterion) {
  std::string text = kSmallTask;
  const std::string task = "task: {edge_angle: {reference_deg: 90, tolerance_deg: 3}, hold: 0.1}";
  text.replace(text.find(task), task.size(), "task: {total_force: {tolerance: 0.5}, center: {tolerance_mm: 2}, hold: 0.2, travel_mm: 5}");
  std::ofstream(scene_) << text;
  const Outcome outcome = succeed({"evaluate", scene_, "--episodes", "2"});
  EXPECT_THAT(outcome.out,
              HasSubstr("success: in every frame of the last 0.2 s, contact, total_force within 0.5 N of the force at the start, center "
                        "within 2 mm of the middle of the array; a path of at least 5 mm over the object\n"));
}

// Stopped while the second of two controllers runs.
TEST_F(Evaluate, AnInterruptKeepsCompleteControllers) {
  const Outcome stopped = runTaxelsim({"evaluate", scene_, "--episodes", "1500", "--batch-size", "64"},
                                      {.signal = SIGINT, .signal_at = "controller fast evaluated (1 of 2)\n"});
  ASSERT_EQ(stopped.status, 130) << stopped.err;
  EXPECT_THAT(stopped.err, HasSubstr("warning: stopped: 1 of 2 controllers are evaluated\n"));
  EXPECT_THAT(stopped.out, HasSubstr("\nfast "));
  EXPECT_THAT(stopped.out, Not(HasSubstr("\nnone ")));
}

TEST_F(Evaluate, WarnsOfObjectsThatCannotCarryTheLoad) {
  std::string text = kSmallTask;
  text.replace(text.find("load: [1, 3]"), 12, "load: [1, 900]");
  std::ofstream(scene_) << text;
  const Outcome outcome = succeed({"evaluate", scene_, "--episodes", "20", "--controller", "none"});
  EXPECT_THAT(outcome.err, HasSubstr("warning: object cylinder: load out of reach in "));
  EXPECT_THAT(outcome.err, HasSubstr(" of its 20 episodes"));
}

TEST_F(Evaluate, RejectsUnknownControllersAndScenesWithoutTask) {
  expectRefused(runTaxelsim({"evaluate", scene_, "--controller", "slow"}), "controller slow: not in this scene; it has fast, none");
  expectRefused(runTaxelsim({"evaluate", std::string(TAXELSIM_SOURCE_DIR) + "/scenes/edge_servo.yaml"}),
                "this scene has no `task`, which `evaluate` needs");
  expectRefused(runTaxelsim({"evaluate", scene_, "--episodes", "0"}), "--episodes");
  expectRefused(runTaxelsim({"evaluate", scene_, "--episodes", "1000000000"}), "at most 16777216 in one evaluation");
}

TEST_F(Evaluate, ConditionsOverrideTheScene) {
  std::ofstream(scene_, std::ios::app) << "conditions: {straight: {randomization: {yaw_deg: 90}}}\n";
  const nlohmann::json json = jsonOf({"evaluate", scene_, "--condition", "straight", "--json", "--controller", "none"});
  EXPECT_EQ(json["condition"], "straight");
  EXPECT_EQ(json["controllers"][0]["total"]["success_rate"], 0);  // its edges begin across the reference
  EXPECT_EQ(runTaxelsim({"evaluate", scene_, "--condition", "straight"}).out.substr(0, 16), "small (straight)");
  expectRefused(runTaxelsim({"evaluate", scene_, "--condition", "bent"}), "condition bent: not in this scene; it has nominal, straight");
}

}  // namespace
}  // namespace taxelsim::testing
