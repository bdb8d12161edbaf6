// Errors in a scene file: position, key, value found, what is allowed.
#include "bad_scene.h"

namespace taxelsim {
namespace {

TEST(BadScenes, Versions) {
  expectRefusals(
      {BadScene{"format_version: 1", "format_version: 2", ":1:17: format_version: version 2 is newer than this program: it reads up to 1"},
       BadScene{"format_version: 1\n", "", ":1:1: missing `format_version: 1`"},
       BadScene{"format_version: 1", "format_version: 0", ":1:17: format_version: 0 is not allowed: a whole number from 1"},
       BadScene{"format_version: 1", "format_version: one", ":1:17: format_version: one is not allowed: a whole number from 1"},
       BadScene{"format_version: 1", "format_version: 9\nfuture: x", ":1:17: format_version: version 9 is newer"}});
}

TEST(BadScenes, Keys) {
  expectRefusals(
      {BadScene{"weight: 2", "wieght: 2", ":17:5: objects[0].wieght: unknown key, did you mean 'weight'?; allowed: mesh, sphere,"},
       BadScene{"thickness_mm: 2", "thicknes_mm: 2",
                ":9:10: sensor.skin.thicknes_mm: unknown key, did you mean 'thickness_mm'?; allowed: thickness[_mm], law"},
       BadScene{"seed: 7", "zebra: 7",
                ":28:26: data_set.zebra: unknown key; allowed: episodes, seed, episodes_per_shard, compression, chunk_bytes"},
       BadScene{"kind: servo\n", "kind: servo\nkind: servo\n", ":4:1: duplicate key 'kind': already given on line 3"},
       BadScene{"seed: 7", "seed: 7, seed: 8", ":28:35: duplicate key 'seed': already given on line 28"},
       BadScene{"  pitch_mm: 3.4\n", "  pitch_mm: 3.4\n  pitch: 0.0034\n", ":8:13: sensor.pitch_mm: given twice, as pitch and pitch_mm"},
       BadScene{"  pitch_mm: 3.4\n", "", ":5:3: sensor: pitch[_mm] is missing: a number > 0 m"},
       BadScene{"name: small_scene\n", "", ":1:1: name is missing: a name"},
       BadScene{"kind: servo\n", "", ":1:1: kind is missing: servo | contacts"},
       BadScene{"  load: [0.5, 5]\n", "", ":22:3: randomization: load is missing"},
       BadScene{"  load: [0.5, 5]\n", "  load: 1\n  depth_mm: 1\n",
                ":25:13: randomization.depth_mm: conflicts with `load`: give only one of them"},
       BadScene{"thickness_mm: 2, ", "", ":9:9: sensor.skin: thickness[_mm] is missing: a number > 0 m"},
       BadScene{"num_steps: 20, ", "", ":20:10: episode: num_steps is missing: a whole number from 1 to 1000000"}});
}

TEST(BadScenes, Numbers) {
  expectRefusals(
      {BadScene{"load: [0.5, 5]", "load: -1", ":24:9: randomization.load: -1 is not allowed: a number from 0 to 1e+06 N"},
       BadScene{"load: [0.5, 5]", "load: [0.5, .nan]", ":24:15: randomization.load[1]: .nan is not allowed: a number from 0 to 1e+06 N"},
       BadScene{"load: [0.5, 5]", "load: [0.5, nan]", ":24:15: randomization.load[1]: nan is not allowed"},
       BadScene{"load: [0.5, 5]", "load: inf", ":24:9: randomization.load: inf is not allowed"},
       BadScene{"load: [0.5, 5]", "load: [5, 0.5]", ":24:9: randomization.load: [min, max] is not allowed with min > max"},
       BadScene{"load: [0.5, 5]", "load: [1, 2, 3]", ":24:9: randomization.load: a list of 3 is not allowed: a list of 2 numbers"},
       BadScene{"load: [0.5, 5]", "load: {min: 1}", ":24:9: randomization.load: a mapping is not allowed: a number from 0"},
       BadScene{"load: [0.5, 5]", "load: heavy", ":24:9: randomization.load: heavy is not allowed: a number from 0"},
       BadScene{"load: [0.5, 5]", "load: \"1\"", ":24:9: randomization.load: \"1\" is not allowed: a number from 0"},
       BadScene{"load: [0.5, 5]", "load: 1 N", ":24:9: randomization.load: 1 N is not allowed"},
       BadScene{"load: [0.5, 5]", "load: 0x10", ":24:9: randomization.load: 0x10 is not allowed"},
       BadScene{"load: [0.5, 5]", "load:", ":24:3: randomization.load: nothing is not allowed"},
       BadScene{"load: [0.5, 5]", "load: 1e999", ":24:9: randomization.load: 1e999 is not allowed"},
       BadScene{"1.73e8", "1e31",
                ":9:53: sensor.skin.normal_contact_stiffness: 1e31 is not allowed: a number > 0 Pa/m^normal_exponent, its size 0 or 1e-30"},
       BadScene{"1.73e8", "1e-320", ":9:53: sensor.skin.normal_contact_stiffness: 1e-320 is not allowed"},
       BadScene{"1.73e8", "0", ":9:53: sensor.skin.normal_contact_stiffness: 0 is not allowed: a number > 0"},
       BadScene{"yaw_deg: 30", "yaw_deg: 400", ":23:12: randomization.yaw_deg: 400 is not allowed: a number from -360 to 360 deg"},
       BadScene{"yaw_deg: 30", "tilt_deg: -1", ":23:13: randomization.tilt_deg: -1 is not allowed: a number from 0 to 90 deg"},
       BadScene{"x_mm: [-2, 2]", "x_mm: [-2, 2000]", ":22:14: randomization.x_mm[1]: 2000 is not allowed: a number from -1000 to 1000 mm"},
       BadScene{"yaw_deg: 30", "gain: 0", ":23:9: randomization.gain: 0 is not allowed: a number > 0 and <= 1000"},
       BadScene{"yaw_deg: 30", "noise: -3", ":23:10: randomization.noise: -3 is not allowed: a number from 0 to 65535 counts"},
       BadScene{"num_rows: 3", "num_rows: 0", ":6:13: sensor.num_rows: 0 is not allowed: a whole number from 1 to 128"},
       BadScene{"num_rows: 3", "num_rows: 129", ":6:13: sensor.num_rows: 129 is not allowed"},
       BadScene{"pitch_mm: 3.4", "pitch_mm: 3.4\n  samples_per_taxel: 17",
                ":9:22: sensor.samples_per_taxel: 17 is not allowed: a whole number from 1 to 16"},
       BadScene{"num_rows: 3", "num_rows: 3.5", ":6:13: sensor.num_rows: 3.5 is not allowed"},
       BadScene{"pitch_mm: 3.4", "pitch_mm: [3.4, 0]", ":8:19: sensor.pitch_mm[1]: 0 is not allowed: a number > 0 mm"},
       BadScene{"kp: 0.78", "kp: 0.78, reference_deg: -90",
                ":26:57: controller.tactile_servo.edge_angle.reference_deg: -90 is not allowed: a number > -90 and <= 90 deg"},
       BadScene{"kp: 0.78", "kp: -1", ":26:36: controller.tactile_servo.edge_angle.kp: -1 is not allowed: a number >= 0 1/s"},
       BadScene{"kp: 0.78", "kp: .nan", ":26:36: controller.tactile_servo.edge_angle.kp: .nan is not allowed"},
       BadScene{"kp: 0.78", "ki: 1", ":26:31: controller.tactile_servo.edge_angle: kp is missing"},
       BadScene{"kp: 0.78", "kp: 1, kd: 1", ":26:43: controller.tactile_servo.edge_angle.kd: 1 is not allowed: a number >= 0 and < 1"},
       BadScene{"kp: 0.78", "kp: 1, error_limit_deg: 0",
                ":26:56: controller.tactile_servo.edge_angle.error_limit_deg: 0 is not allowed: a number > 0 deg"},
       BadScene{"edge_angle: {kp: 0.78}", "min_confidence: 0.5",
                ":26:18: controller.tactile_servo: no feature to control: at least one of center_x"},
       BadScene{"edge_angle: {kp: 0.78}", "center_across: {kp: 1}, center_y: {kp: 1}",
                ":26:53: controller.tactile_servo.center_y: conflicts with `center_across`: both control the same coordinate"},
       BadScene{"{kp: 0.78}", "{kp: 0.78}, max_angular_velocity_deg: 0",
                ":26:69: controller.tactile_servo.max_angular_velocity_deg: 0 is not allowed: a number > 0 deg/s"},
       BadScene{"{kp: 0.78}", "{kp: 0.78}, min_confidence: 1.5",
                ":26:59: controller.tactile_servo.min_confidence: 1.5 is not allowed: a number from 0 to 1"},
       BadScene{"control_rate: 50", "control_rate: 30",
                ":20:62: episode.control_rate: 30 Hz is not allowed: simulation_rate (100 Hz) divided by a whole number"},
       BadScene{"control_rate: 50", "control_rate: 200", ":20:62: episode.control_rate: 200 Hz is not allowed"},
       BadScene{"simulation_rate: 100", "simulation_rate: 0",
                ":20:43: episode.simulation_rate: 0 is not allowed: a number > 0 and <= 1e+06 Hz"},
       BadScene{"seed: 7", "seed: -7", ":28:32: data_set.seed: -7 is not allowed: a whole number from 0 to 18446744073709551615"},
       BadScene{"seed: 7", "seed: 18446744073709551616", ":28:32: data_set.seed: 18446744073709551616 is not allowed"},
       BadScene{"episodes: 10", "episodes: 0", ":28:22: data_set.episodes: 0 is not allowed: a whole number from 1"},
       BadScene{"seed: 7", "compression: 10", ":28:39: data_set.compression: 10 is not allowed: a whole number from 0 to 9"},
       BadScene{"seed: 7", "chunk_bytes: 1000", ":28:39: data_set.chunk_bytes: 1000 is not allowed: a whole number from 1024 to 67108864"},
       BadScene{"seed: 7", "episodes_per_shard: 0", ":28:46: data_set.episodes_per_shard: 0 is not allowed"}});
}

TEST(BadScenes, RobotPoses) {
  expectRefusals({BadScene{"free_flying: {}", "pan_tilt: {base: {rotation: [1, 1, 0, 0]}}",
                           ":14:37: robot.pan_tilt.base.rotation: length 1.4142135623730951 is not allowed: a unit quaternion"},
                  BadScene{"free_flying: {}", "pan_tilt: {base: {rotation: [1, 0, 0]}}",
                           ":14:37: robot.pan_tilt.base.rotation: a list of 3 is not allowed: a list of 4 numbers"},
                  BadScene{"free_flying: {}", "pan_tilt: {base: {rpy: [0, 0, 0], rotation: [1, 0, 0, 0]}}",
                           ":14:53: robot.pan_tilt.base.rotation: given twice, as rotation and rpy"}});
}

TEST(BadSceneFiles, RejectsDelayInScenesOfContacts) {
  std::string text = edited(edited(kScene, "kind: servo", "kind: contacts"), "num_steps: 20, ", "");
  text = edited(text, "controller:\n  tactile_servo: {edge_angle: {kp: 0.78}}\n", "");
  EXPECT_EQ(refusalOf(text), "was accepted");
  EXPECT_THAT(refusalOf(edited(text, "trigger: 0.02", "delay: 0.01")),
              ::testing::StartsWith(":5:3: sensor: readout.delay 0.01 s is not allowed: 0 in a scene of kind contacts"));
}

TEST(BadScenes, Objects) {
  expectRefusals(
      {BadScene{kSphere, "mesh: missing.obj", ":16:11: objects[0].mesh: missing.obj is not there, or not a file"},
       BadScene{kSphere, "mesh: .", ":16:11: objects[0].mesh: "},
       BadScene{kSphere, "mesh: not_a_mesh.obj", ":16:11: objects[0].mesh: not_a_mesh.obj"},
       BadScene{kSphere, "mesh: other.gltf", ":16:11: objects[0].mesh: a .gltf keeps its geometry in other files"},
       BadScene{kSphere, "mesh: OTHER.GLTF", ":16:11: objects[0].mesh: a .gltf keeps its geometry in other files"},
       BadScene{"sphere: {radius_mm: 5}\n", "mesh: mesh.obj\n    scale: 0\n",
                ":17:12: objects[0].scale: 0 is not allowed: a number > 0 m per unit"},
       BadScene{"sphere: {radius_mm: 5}\n", "mesh: mesh.obj\n    up_axis: w\n", ":17:14: objects[0].up_axis: w is not allowed: x | y | z"},
       BadScene{"sphere: {radius_mm: 5}\n", "mesh: mesh.obj\n    max_depth_error_mm: -1\n",
                ":17:25: objects[0].max_depth_error_mm: -1 is not allowed: a number >= 0 mm"},
       BadScene{"sphere: {radius_mm: 5}\n", "mesh: mesh.obj\n    max_depth_error: .inf\n",
                ":17:22: objects[0].max_depth_error: .inf is not allowed: a number >= 0 m"},
       BadScene{"sphere: {radius_mm: 5}\n", "mesh: mesh.obj\n    max_depth_error: small\n",
                ":17:22: objects[0].max_depth_error: small is not allowed: a number >= 0 m"},
       BadScene{"sphere: {radius_mm: 5}\n", "mesh: mesh.obj\n    max_depth_error: 0\n    max_depth_error_mm: 0\n",
                ":18:25: objects[0].max_depth_error_mm: given twice, as max_depth_error and max_depth_error_mm"},
       BadScene{"weight: 2", "max_depth_error_mm: 0", ":17:25: objects[0].max_depth_error_mm: belongs to a mesh, not to a sphere"},
       BadScene{"sphere: {radius_mm: 5}\n", "mesh: mesh.obj\n    sha256: 00\n", ":17:13: objects[0].sha256: not the SHA-256 of mesh.obj"},
       BadScene{kSphere, "sphere: {radius_mm: 0}", ":16:25: objects[0].sphere.radius_mm: 0 is not allowed: a number > 0 mm"},
       BadScene{kSphere, "sphere: {}", ":16:13: objects[0].sphere: radius[_mm] is missing: a number > 0 m"},
       BadScene{kSphere, "half_space: {radius: 1}", ":16:18: objects[0].half_space.radius: unknown key; no key is allowed here"},
       BadScene{kSphere, "torus: {major_radius_mm: 1, minor_radius_mm: 2}", ":16:5: objects[0]: "},
       BadScene{kSphere, "name: a", ":16:5: objects[0]: exactly one of mesh | sphere"},
       BadScene{"    weight: 2\n", "    box: {size: [1, 1, 1]}\n",
                ":17:10: objects[0].box: conflicts with `sphere`: exactly one of mesh | sphere"},
       BadScene{"weight: 2", "scale: 2", ":17:12: objects[0].scale: belongs to a mesh, not to a sphere"},
       BadScene{"weight: 2", "weight: -2", ":17:13: objects[0].weight: -2 is not allowed: a number >= 0"},
       BadScene{"weight: 2\n  - cylinder: {radius_mm: 8, length_mm: 40}",
                "weight: 0\n  - weight: 0\n    cylinder: {radius_mm: 8, length_mm: 40}", ":16:3: objects: every weight is 0"},
       BadScene{"weight: 2\n  - cyl", "name: a\n  - name: a\n    cyl", ":18:11: objects[1].name: an earlier object has this name"},
       BadScene{kRotation, "{rotation: [0, 0, 0, 0]}", ":19:29: objects[1].orientation.rotation: length 0 is not allowed"},
       BadScene{kRotation, "{position: [0, 0, 0]}", ":19:19: objects[1].orientation.position: unknown key"}});
}

TEST(BadScenes, Scenes) {
  expectRefusals(
      {BadScene{"kind: servo", "kind: walk", ":3:7: kind: walk is not allowed: servo | contacts"},
       BadScene{"name: small_scene", "name: \"\"", ":2:7: name: \"\" is not allowed: a name"},
       BadScene{"name: small_scene", "name: \"a\\nb\"", ":2:7: name: \"a b\" is not allowed: a name on one line"},
       BadScene{"name: small_scene", "name: [a]", ":2:7: name: a list of 1 is not allowed: a name"},
       BadScene{"kind: servo", "kind: contacts", ":20:22: episode.num_steps: 20 is not allowed: a whole number from 1 to 1"},
       BadScene{kEpisode, "fast", ":20:10: episode: fast is not allowed: a mapping of num_steps"},
       BadScene{"[tactile_image, features]", "[tactile_image, taste]",
                ":27:25: record[1]: taste is not allowed: tactile_image | taxel_counts | features | ground_truth"},
       BadScene{"[tactile_image, features]", "[poses, poses]", ":27:17: record[1]: poses is given twice"},
       BadScene{"[tactile_image, features]", "[]", ":27:9: record: a list of 0 is not allowed: a list of at least one of tactile_image"},
       BadScene{"[tactile_image, features]", "[contact_features]\nmax_regions: 9",
                ":28:14: max_regions: 9 is not allowed: a whole number from 0 to 8"},
       BadScene{"[tactile_image, features]", "[taxel_counts]", ":27:9: record: taxel_counts needs readout.three_axis of the sensor"},
       BadScene{"[tactile_image, features]", "[features]\nmax_regions: 1",
                ":28:14: max_regions: needs contact_features or clean_contact_features in record"},
       BadScene{"{edge_angle: {kp: 0.78}}", "{}\n  pid: {}", ":27:3: controller.pid: unknown key; allowed: tactile_servo"},
       BadScene{"name: small_scene", "name: &a b", ":2:7: an anchor"}, BadScene{"name: small_scene", "name: *a", ":2:7: "},
       BadScene{"name: small_scene", "name: !!str b", ":2:7: a tag"}, BadScene{"name: small_scene", "name: {", ":4:7: not YAML: "},
       BadScene{"  load:", "\tload:", ":24:1: a tab before the text of a line: indent with spaces"},
       BadScene{"record:", "---\nrecord:", ":27:1: a second document"}});
}

TEST(BadSceneFiles, RejectsEmptyListsOfObjects) {
  const std::string text(kScene);
  const std::size_t begin = text.find("objects:");
  const std::size_t end = text.find("episode:");
  const auto with = [&](const std::string& objects) { return text.substr(0, begin) + objects + text.substr(end); };
  EXPECT_THAT(refusalOf(with("objects: []\n")),
              ::testing::StartsWith(":15:10: objects: a list of 0 is not allowed: a list of at least one object"));
  EXPECT_THAT(refusalOf(with("objects: mesh.obj\n")), ::testing::StartsWith(":15:10: objects: mesh.obj is not allowed: a list"));
  EXPECT_THAT(refusalOf(with("")), ::testing::StartsWith(":1:1: objects is missing: a list"));
}

TEST(BadSceneFiles, ReportsPositionsInTheSensorFile) {
  const std::string text(kScene);
  const auto with = [&](const std::string& sensor) {
    return text.substr(0, text.find("sensor:")) + sensor + text.substr(text.find("robot:"));
  };
  EXPECT_THAT(refusalOf(with("sensor: nowhere.yaml\n")), ::testing::StartsWith(":4:9: sensor: nowhere.yaml is not there, or not a file"));
  EXPECT_THAT(refusalOf(with("sensor: sensor.yaml\n")),
              ::testing::StartsWith("sensor.yaml:3:11: num_rows: 0 is not allowed: a whole number from 1 to 128"));
  EXPECT_THAT(refusalOf(with("sensor: [a]\n")), ::testing::StartsWith(":4:9: sensor: a list of 1 is not allowed: a sensor file"));
  EXPECT_THAT(refusalOf(with("sensor: {format_version: 1}\n")), ::testing::StartsWith(":4:10: sensor.format_version: unknown key"));
}

TEST(BadSceneFiles, RejectsControllerAndActionsInScenesOfContacts) {
  const std::string contacts = edited(edited(kScene, "kind: servo", "kind: contacts"), "num_steps: 20, ", "");
  EXPECT_THAT(refusalOf(contacts), ::testing::StartsWith(":26:3: controller: a scene of kind contacts has no controller"));
  const std::string without = edited(contacts, "controller:\n  tactile_servo: {edge_angle: {kp: 0.78}}\n", "");
  EXPECT_EQ(refusalOf(without), "was accepted");
  EXPECT_THAT(refusalOf(edited(without, "[tactile_image, features]", "[actions]")),
              ::testing::StartsWith(":25:10: record[0]: a scene of kind contacts has no actions"));
}

TEST(BadSceneFiles, RejectsOverridesOutOfRange) {
  const testing::TemporaryDirectory directory;
  const std::filesystem::path file = directory.write("scene.yaml", kScene);
  EXPECT_THAT(refusal(file, [&] { loadScene(file, {.num_episodes = 0, .seed = 1}); }),
              ::testing::StartsWith("episodes: 0 is not allowed: a whole number from 1"));
}

}  // namespace
}  // namespace taxelsim
