// `experiment` on servo files: outputs of short loops, and refusals. Numbers against theory: tests/experiments/.
#include <nlohmann/json.hpp>

#include "cli/command_line.h"
#include "cli/picture.h"
#include "support/test.h"

namespace taxelsim::testing {
namespace {

const std::string kScenes = std::string(TAXELSIM_SOURCE_DIR) + "/scenes";

std::string sceneText(
    const std::string& controllers =
        "  - name: exact\n"
        "    tactile_servo: {edge_angle: {reference_deg: 90, kp: 5}, edge_angle_source: exact, max_angular_velocity: 1000}\n"
        "  - name: measured\n"
        "    tactile_servo: {edge_angle: {reference_deg: 90, kp: 5}, max_angular_velocity: 10}\n"
        "  - name: all\n"
        "    tactile_servo:\n"
        "      edge_angle: {reference_deg: 90, kp: 5, ki: 1}\n"
        "      total_force: {reference: 4, kp: 5}\n"
        "      center_across: {kp: 5}\n") {
  return "format_version: 1\nname: scene\nkind: servo\nsensor: " + kScenes +
         "/sensors/wts0614_soft_cover.yaml\nobjects:\n"
         "  - {name: bar, cylinder: {radius_mm: 10, length_mm: 100}, orientation: {rpy_deg: [90, 0, 0]}, edge: [0, 0, 1]}\n"
         "  - {name: waved, cylinder: {radius_mm: 10, length_mm: 100}, orientation: {rpy_deg: [90, 0, 0]}, edge: [0, 0, 1],\n"
         "     motion: {sinusoid: {axis: [0, 0, 1], angle_deg: 5, frequency: 1}}}\n"
         "episode: {num_steps: 60, simulation_rate: 100}\nrandomization: {yaw_deg: -30, load: 3}\ncontrollers:\n" +
         controllers;
}

std::string experimentText(const std::string& runs, const std::string& rest = "") {
  return "format_version: 1\nname: small\nexperiment: servo\nscene: scene.yaml\nsteady: 0.1\nruns:\n" + runs + rest;
}

const std::string kRuns =
    "  - {name: alone, controller: exact, object: bar, theory: closed_form}\n"
    "  - {name: sensed, controller: measured, object: bar, theory: characteristic}\n"
    "  - {name: \"on a platform, all\", group: robots, controller: all, object: waved, robot: {pan_tilt: {}}}\n";
const std::string kSweeps = "sweeps:\n  - {name: sweep, controller: exact, object: bar, yaw_deg: 0.5, num_steps: 30, gains: [1.9, 2.1]}\n";

class ServoExperimentCommand : public ::testing::Test {
 protected:
  std::filesystem::path written(const std::string& name, const std::string& text) const {
    std::ofstream(root_ / name) << text;
    return root_ / name;
  }

  TemporaryDirectory root_;
};

TEST_F(ServoExperimentCommand, JsonHasEveryNumber) {
  written("scene.yaml", sceneText());
  const nlohmann::json json = jsonOf({"experiment", written("x.yaml", experimentText(kRuns, kSweeps)), "--json"});
  EXPECT_EQ(json["experiment"], "small");
  EXPECT_EQ(json["band"], 0.02);
  ASSERT_EQ(json["runs"].size(), 3u);

  const nlohmann::json& alone = json["runs"][0];
  EXPECT_EQ(alone["run"], "alone");
  EXPECT_EQ(alone["controller"], "exact");
  EXPECT_EQ(alone["object"], "bar");
  ASSERT_EQ(alone["features"].size(), 1u);
  EXPECT_EQ(alone["features"][0]["feature"], "edge_angle");
  EXPECT_EQ(alone["features"][0]["error"].size(), 60u);
  EXPECT_TRUE(alone["features"][0]["settling_time"].is_null()) << "0.6 s at 5 / s leave 5 %";
  EXPECT_NEAR(alone["theory"]["settling_time"].get<double>(), 0.01 * std::log(50) / -std::log(0.95), 1e-9);
  EXPECT_EQ(alone["theory"]["error"].size(), 60u);
  EXPECT_LT(alone["theory"]["largest_deviation"].get<double>(), 1e-6);
  EXPECT_TRUE(alone["robot"]["limit_margin"].is_null()) << "free-flying";
  EXPECT_FALSE(alone.contains("characteristic"));
  EXPECT_EQ(json["runs"][1]["characteristic"]["measured"].size(), json["runs"][1]["characteristic"]["error"].size());

  const nlohmann::json& all = json["runs"][2];
  EXPECT_EQ(all["group"], "robots");
  EXPECT_EQ(all["features"].size(), 3u);
  EXPECT_FALSE(all.contains("theory"));
  EXPECT_GT(all["robot"]["limit_margin"].get<double>(), 1);
  const nlohmann::json& frames = all["frames"];
  for (const char* name : {"time", "true_angle", "edge_angle", "total_force", "center_of_pressure", "sensor_position", "sensor_rotation",
                           "object_position", "object_rotation", "joint_positions", "robot_status"}) {
    EXPECT_EQ(frames[name].size(), 60u) << name;
  }
  EXPECT_EQ(frames["joint_positions"][0].size(), 2u);
  EXPECT_NE(frames["object_rotation"][0], frames["object_rotation"][25]) << "the object turns";

  ASSERT_EQ(json["sweeps"].size(), 1u);
  EXPECT_NEAR(json["sweeps"][0]["limit"].get<double>(), 2, 0.01);
  EXPECT_EQ(json["sweeps"][0]["growth"].size(), 2u);
}

TEST_F(ServoExperimentCommand, TableAndFigures) {
  written("scene.yaml", sceneText());
  const std::filesystem::path figures = root_ / "figures";
  const Outcome outcome = succeed({"experiment", written("x.yaml", experimentText(kRuns, kSweeps)), "-o", figures});
  EXPECT_THAT(outcome.err, ::testing::HasSubstr("info: wrote 7 figures to " + figures.string()));
  for (const char* part :
       {"small: settling", "edge_angle", "total_force", "center_across", "on a platform, all", "diverges", "stable up to 2."})
    EXPECT_THAT(outcome.out, ::testing::HasSubstr(part)) << part << "\n" << outcome.out;
  // Three groups, each whole and near its reference, in two columns; two other features in one row; three images in a row.
  const Picture angle(figures / "angle.png"), features(figures / "features.png"), robot(figures / "robot.png"),
      theory(figures / "theory.png"), images(figures / "alone.png");
  EXPECT_GT(angle.height(), 2.4 * features.height());
  EXPECT_EQ(angle.width(), features.width());
  EXPECT_LT(robot.width(), angle.width()) << "joints, and no path: a platform only rotates";
  EXPECT_EQ(theory.width(), angle.width());
  EXPECT_GT(images.width(), 3 * images.height());
  // Edge and reference on each image, and in the legend.
  EXPECT_GT(images.of(0xe5322d).count, 1000);
  EXPECT_GT(images.of(0x18a35a).count, 1000);
  EXPECT_TRUE(std::filesystem::exists(figures / "on_a_platform_all.png"));
}

TEST_F(ServoExperimentCommand, Refusals) {
  written("scene.yaml", sceneText());
  const auto refused = [&](const std::string& text, const std::string& part) {
    expectRefused(runTaxelsim({"experiment", written("x.yaml", text)}), part);
  };
  const std::string run = "  - {name: a, controller: exact, object: bar";
  refused(experimentText(run + ", zebra: 1}\n"), "x.yaml:7:47: runs[0].zebra: unknown key");
  refused(experimentText("  - {name: a, controller: none, object: bar}\n"), "controller: none is not allowed: exact | measured | all");
  refused(experimentText("  - {name: a, controller: exact, object: egg}\n"), "object: egg is not allowed: bar | waved");
  refused(experimentText("  - {name: a, controller: exact}\n"), "runs[0]: object is missing");
  refused(experimentText("  - {controller: exact, object: bar}\n"), "name is missing");
  refused(experimentText(run + "}\n" + run + "}\n"), "an earlier run has the name a");
  refused(experimentText(run + ", control_rate: 33}\n"),
          "control_rate: 33 Hz is not allowed: simulation_rate (100 Hz) divided by a whole number");
  refused(experimentText(run + ", num_steps: 1}\n"), "num_steps: 1 is not allowed");
  refused(experimentText(run + ", load: -1}\n"), "load: -1 is not allowed");
  refused(experimentText(run + ", robot: none.yaml}\n"), "none.yaml is not there");
  refused(experimentText(run + ", theory: perhaps}\n"), "theory: perhaps is not allowed: none | closed_form | characteristic");
  refused(experimentText(run + ", theory: characteristic}\n"),
          "runs[0].theory: characteristic is of a controller that measures its edge angle");
  refused(experimentText("  - {name: a, controller: measured, object: bar, theory: closed_form}\n"), "edge_angle_source exact");
  refused(experimentText("  - {name: a, controller: all, object: bar, theory: characteristic}\n"), "holds edge_angle alone, by kp alone");
  refused(experimentText("  - {name: a, controller: exact, object: waved, theory: closed_form}\n"), "an object at rest that has an edge");
  refused(experimentText(run + ", robot: {pan_tilt: {delay: 2}}, theory: closed_form}\n"),
          "of a robot without delay, or with one of a control period (1)");
  refused(experimentText(run + "}\n", "sweeps:\n  - {name: s, controller: measured, object: bar, gains: [1]}\n"),
          "edge_angle_source exact");
  refused(experimentText(run + "}\n", "sweeps:\n  - {name: s, controller: exact, object: bar, gains: [2, 1]}\n"),
          "the gains do not ascend");
  refused(experimentText(run + "}\n", "sweeps:\n  - {name: s, controller: exact, object: bar, gains: []}\n"), "gains");
  refused(experimentText(run + "}\n", "band: 0\n"), "band: 0 is not allowed");
  refused(experimentText(run + "}\n", "steady: 0\n"), "steady");
  refused("format_version: 1\nname: x\nexperiment: servo\nscene: scene.yaml\nruns: []\n", "runs: a list of 0 is not allowed");
  refused("format_version: 1\nname: x\nexperiment: servo\nscene: none.yaml\nruns:\n" + run + "}\n", "none.yaml");
  refused("format_version: 1\nname: x\nexperiment: dance\n", "experiment: dance is not allowed: static | servo");
  refused("format_version: 1\nname: x\n", "experiment is missing: static | servo");
  refused("format_version: 1\n", "experiment is missing");
  refused("[1]\n", "x.yaml:1:1");
  written("scene.yaml",
          "format_version: 1\nname: scene\nkind: servo\nsensor: " + kScenes +
              "/sensors/wts0614_soft_cover.yaml\nobjects: [{sphere: {radius_mm: 10}}]\nepisode: {num_steps: 5}\nrandomization: {load: 1}\n"
              "controllers: [{name: p, tactile_servo: {edge_angle: {kp: 1}}}]\n");
  refused(experimentText("  - {name: a, controller: p, theory: characteristic}\n"), "an object at rest that has an edge");
  written("scene.yaml", "format_version: 1\nname: scene\nkind: contacts\nsensor: " + kScenes +
                            "/sensors/wts0614_soft_cover.yaml\nobjects: [{sphere: {radius_mm: 10}}]\nrandomization: {load: 1}\n");
  refused(experimentText(run + "}\n"), "is a scene of kind contacts: one of kind servo");
}

}  // namespace
}  // namespace taxelsim::testing
