// `evaluate`: table, JSON and figure of a small task, independence of the batch size, and refusals.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "cli/command_line.h"
#include "cli/picture.h"

namespace taxelsim::testing {
namespace {

const std::string kText = std::string("format_version: 1\nname: small\nkind: servo\nsensor: ") + TAXELSIM_SOURCE_DIR +
                          R"(/scenes/sensors/wts0614.yaml
objects: [{cylinder: {radius_mm: 5, length_mm: 100}, orientation: {rpy_deg: [90, 0, 0]}, edge: [0, 0, 1]}]
episode: {num_steps: 60}
randomization: {yaw_deg: [-40, 40], load: [1, 3]}
controllers:
  - {name: fast, tactile_servo: {edge_angle: {reference_deg: 90, kp: 10}, max_angular_velocity: 20}}
  - {name: none, tactile_servo: {edge_angle: {reference_deg: 90, kp: 0}}}
task: {edge_angle: {reference_deg: 90, tolerance_deg: 3}, hold: 0.1}
data_set: {episodes: 40, seed: 3}
)";

class Evaluate : public ::testing::Test {
 protected:
  Evaluate() { std::ofstream(scene_) << kText; }

  TemporaryDirectory root_;
  std::filesystem::path scene_ = root_ / "small.yaml";
};

TEST_F(Evaluate, JsonAndPicture) {
  const Outcome outcome = runTaxelsim({"evaluate", scene_, "--json", "--png", root_ / "small.png"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const nlohmann::json json = nlohmann::json::parse(outcome.out);
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

TEST_F(Evaluate, DoesNotDependOnTheBatchSize) {
  const Outcome whole = runTaxelsim({"evaluate", scene_, "--json"});
  const Outcome cut = runTaxelsim({"evaluate", scene_, "--json", "--batch-size", "7"});
  EXPECT_EQ(whole.out, cut.out);
}

TEST_F(Evaluate, TableOfOneController) {
  const Outcome outcome = runTaxelsim({"evaluate", scene_, "--controller", "none", "--episodes", "10"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("none"), std::string::npos);
  EXPECT_EQ(outcome.out.find("fast"), std::string::npos);
  EXPECT_NE(outcome.out.find("success (95 %)"), std::string::npos);
}

TEST_F(Evaluate, RejectsUnknownControllersAndScenesWithoutTask) {
  expectRefused(runTaxelsim({"evaluate", scene_, "--controller", "slow"}), "--controller slow: not in this scene; it has fast, none");
  expectRefused(runTaxelsim({"evaluate", std::string(TAXELSIM_SOURCE_DIR) + "/scenes/edge_servo.yaml"}),
                "this scene has no `task`, which `evaluate` needs");
  expectRefused(runTaxelsim({"evaluate", scene_, "--episodes", "0"}), "--episodes");
  expectRefused(runTaxelsim({"evaluate", scene_, "--episodes", "1000000000"}), "at most 16777216 allowed in one evaluation");
}

TEST_F(Evaluate, ConditionsOverrideTheScene) {
  std::ofstream(scene_, std::ios::app) << "conditions: {straight: {randomization: {yaw_deg: 90}}}\n";
  const Outcome outcome = runTaxelsim({"evaluate", scene_, "--condition", "straight", "--json", "--controller", "none"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const nlohmann::json json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json["condition"], "straight");
  EXPECT_EQ(json["controllers"][0]["total"]["success_rate"], 0);  // its edges begin across the reference
  EXPECT_EQ(runTaxelsim({"evaluate", scene_, "--condition", "straight"}).out.substr(0, 16), "small (straight)");
  expectRefused(runTaxelsim({"evaluate", scene_, "--condition", "bent"}), "condition bent: not in this scene; it has nominal, straight");
}

}  // namespace
}  // namespace taxelsim::testing
