// Controllers, edges and the task of a scene: the values read, and the message of each error.
#include "scene_text.h"
#include "support/test.h"
#include "taxelsim/scene.h"

namespace taxelsim {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kRounding = 1e-15;
constexpr std::string_view kController = "controller:\n  tactile_servo: {edge_angle: {kp: 0.78}}\n";
constexpr std::string_view kRing = "# a triangle\nx_m,y_m,z_m\n0,0,0\n 0.1 ,0,0\n0,0.1,0.02\n";

// kScene with edges of its objects, followed by `rest`.
std::string sceneText(std::string_view rest) {
  std::string text = edited(kScene, "    weight: 2\n", "    contour: {file: ring.csv}\n");
  text = edited(text, "    orientation: {rotation: [1, 0, 0, 0]}\n", "    edge: [0, 3, 4]\n    anchor_mm: [1, 2, 3]\n");
  return text + std::string(rest);
}

Scene loaded(const std::string& text) {
  const testing::TemporaryDirectory directory;
  directory.write("ring.csv", kRing);
  return loadScene(directory.write("scene.yaml", text));
}

std::string refusalOf(const std::string& text, std::string_view ring = kRing) {
  const testing::TemporaryDirectory directory;
  directory.write("ring.csv", ring);
  const std::filesystem::path file = directory.write("scene.yaml", text);
  return refusal(file, [&] { loadScene(file); });
}

TEST(TaskFile, ReadsEverySetting) {
  const Scene scene =
      loaded(edited(sceneText("task: {edge_angle: {reference_deg: 90, tolerance_deg: 5}, total_force: {reference: 2, tolerance: 0.5},"
                              " center: {tolerance_mm: 3}, hold: 0.1, travel_mm: 7}\n"),
                    "[0.5, 5]",
                    "[0.5, 5]\n  exploration_velocity_mm: [1, 2]\n  linear_action_noise_mm: 3\n"
                    "  angular_action_noise_deg: [0, 180]"));
  ASSERT_TRUE(scene.task);
  const Task& task = *scene.task;
  EXPECT_NEAR(*task[TaskMeasure::kEdgeAngle]->reference, 90 * kDegree, kRounding);
  EXPECT_NEAR(task[TaskMeasure::kEdgeAngle]->tolerance, 5 * kDegree, kRounding);
  EXPECT_EQ(task[TaskMeasure::kTotalForce]->reference, 2);
  EXPECT_EQ(task[TaskMeasure::kCenter]->tolerance, 0.003);
  EXPECT_FALSE(task[TaskMeasure::kContour]);
  EXPECT_EQ(task.hold, 0.1);
  EXPECT_EQ(task.travel, 0.007);
  EXPECT_EQ(scene.objects[0].contour.size(), 3u);
  EXPECT_EQ(scene.objects[0].contour[2], (Vector3{0, 0.1, 0.02}));
  constexpr Vector3 kEdge{0, 0.6, 0.8};
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR((*scene.objects[1].edge)[k], kEdge[k], kRounding);
  EXPECT_EQ(*scene.objects[1].anchor, (Vector3{0.001, 0.002, 0.003}));
  EXPECT_EQ(scene.randomization.exploration_velocity->max, 0.002);
  EXPECT_EQ(scene.randomization.linear_action_noise.min, 0.003);
  EXPECT_NEAR(scene.randomization.angular_action_noise.max, std::numbers::pi, kRounding);
}

TEST(TaskFile, ReadsNamesAndWeightsOfControllers) {
  const Scene scene =
      loaded(edited(sceneText(""), kController,
                    "controllers:\n  - name: a\n    tactile_servo: {edge_angle_source: window, contact: largest_region, "
                    "tilt_x: {kp: 2, reference_deg: 1}, center_x: {kp: 1, rolling_radius_mm: 20}, exploration_direction_deg: 90}\n"
                    "  - {name: b, weight: 3, tactile_servo: {edge_angle_source: exact, edge_angle: {kp: 1}}}\n"
                    "  - {name: c, tactile_servo: {edge_angle_source: ridge, edge_angle: {kp: 1}}}\n"));
  ASSERT_EQ(scene.controllers.size(), 3u);
  EXPECT_EQ(scene.controllers[0].name, "a");
  EXPECT_EQ(scene.controllers[0].weight, 1);
  EXPECT_EQ(scene.controllers[1].weight, 3);
  const TactileServo& servo = scene.controllers[0].servo;
  EXPECT_EQ(servo.edge_angle_source, EdgeAngleSource::kWindow);
  EXPECT_EQ(servo.contact, ServoContact::kLargestRegion);
  EXPECT_NEAR(*servo[ServoFeature::kTiltX].reference, kDegree, kRounding);
  EXPECT_EQ(servo[ServoFeature::kCenterX].rolling_radius, 0.02);
  EXPECT_NEAR(servo.exploration_direction, 90 * kDegree, kRounding);
  EXPECT_EQ(scene.controllers[1].servo.edge_angle_source, EdgeAngleSource::kExact);
  EXPECT_EQ(scene.controllers[2].servo.edge_angle_source, EdgeAngleSource::kRidge);
}

TEST(TaskFile, ResolvedSceneResolvesToItself) {
  const testing::TemporaryDirectory directory;
  directory.write("ring.csv", kRing);
  const std::string text = edited(sceneText("task: {contour: {tolerance_mm: 1}, laps: 0}\n"),
                                  "  - cylinder: {radius_mm: 8, length_mm: 40}\n    edge: [0, 3, 4]\n    anchor_mm: [1, 2, 3]\n", "");
  const Scene scene = loadScene(directory.write("scene.yaml", text));
  EXPECT_EQ(loadScene(directory.write("again.yaml", scene.resolved)).resolved, scene.resolved);
}

TEST(TaskFile, RejectsBadTasks) {
  const auto expect = [](const std::string& text, const std::string& part, std::string_view ring = kRing) {
    SCOPED_TRACE(text);
    EXPECT_THAT(refusalOf(text, ring), ::testing::HasSubstr(part));
  };
  const auto task = [](const std::string& what) { return sceneText("task: " + what + "\n"); };
  expect(task("{}"), "task: no success criterion: at least one of edge_angle, total_force, center, contour");
  expect(task("{center: {tolerance_mm: 0}}"), "task.center.tolerance_mm: 0 is not allowed");
  expect(task("{center: {}}"), "task.center: tolerance[_mm] is missing");
  expect(task("{center: {tolerance_mm: 1}, hold: 0.5}"), "task.hold: 0.5 is not allowed");
  expect(task("{edge_angle: {tolerance_deg: 91}}"), "task.edge_angle.tolerance_deg: 91 is not allowed");
  expect(task("{contour: {tolerance_mm: 1}}"), "task.contour: needs a contour of every object of the scene");
  expect(task("{center: {tolerance_mm: 1}, laps: 1}"), "task.laps: needs a contour of every object of the scene");
  expect(std::string(kScene) + "task: {edge_angle: {tolerance_deg: 5}}\n", "needs an edge or a contour of every object of the scene");
  expect(edited(kScene, "{edge_angle: {kp: 0.78}}", "{edge_angle_source: exact, edge_angle: {kp: 1}}"),
         "edge_angle_source exact needs an edge or a contour");
  expect(edited(sceneText(""), "edge: [0, 3, 4]", "edge: [0, 0, 0]"), "edge: [0, 0, 0] is not allowed: a direction");
  expect(edited(sceneText(""), "anchor_mm: [1, 2, 3]", "contour: {file: ring.csv}"),
         "contour: conflicts with `edge`: give only one of them");
  expect(sceneText(""), "ring.csv: 2 points found, a closed contour needs at least 3", "x_m,y_m,z_m\n0,0,0\n1,0,0\n");
  expect(sceneText(""), "ring.csv:4:1: repeats the previous or the first point", "x_m,y_m,z_m\n0,0,0\n1,0,0\n1,0,0\n0,1,0\n");
  expect(sceneText(""), "ring.csv:3:3: y_m: \"nan\" is not allowed", "x_m,y_m,z_m\n0,0,0\n1,nan,0\n");
  const auto controllers = [](const std::string& list) { return edited(sceneText(""), kController, "controllers: " + list + "\n"); };
  expect(controllers("[]"), "controllers: a list of 0 is not allowed: a list of at least one controller");
  expect(controllers("[{name: a, tactile_servo: {edge_angle: {kp: 1}}}, {name: a, tactile_servo: {edge_angle: {kp: 1}}}]"),
         "controllers[1].name: an earlier controller has this name");
  expect(controllers("[{name: a, weight: 0, tactile_servo: {edge_angle: {kp: 1}}}]"), "controllers: every weight is 0");
  expect(controllers("[{name: a}]"), "tactile_servo is missing");
  expect(controllers("[{name: a, tactile_servo: {edge_angle: {kp: 1, rolling_radius: 1}}}]"), "rolling_radius: unknown key");
  expect(sceneText("controllers: [{name: a, tactile_servo: {edge_angle: {kp: 1}}}]\n"),
         "controller: conflicts with `controllers`: give only one of them");
}

}  // namespace
}  // namespace taxelsim
