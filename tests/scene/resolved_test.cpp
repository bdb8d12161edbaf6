// The canonical text of a scene: independent of directory and spelling, different if any setting differs.
#include <clocale>

#include "scene_text.h"
#include "support/test.h"
#include "taxelsim/scene.h"

namespace taxelsim {
namespace {

std::string resolved(std::string_view text, const SceneOverrides& overrides = {}) {
  const testing::TemporaryDirectory directory;
  return loadScene(directory.write("scene.yaml", text), overrides).resolved;
}

class WorkingDirectory {
 public:
  explicit WorkingDirectory(const std::filesystem::path& path) : before_(std::filesystem::current_path()) {
    std::filesystem::current_path(path);
  }
  ~WorkingDirectory() { std::filesystem::current_path(before_); }

 private:
  std::filesystem::path before_;
};

TEST(Resolved, IsAValidSceneThatResolvesToItself) {
  const std::string text = resolved(kScene);
  EXPECT_EQ(resolved(text), text);
  const std::string with_friction = resolved(edited(kScene, "1.73e8}", "1.73e8, friction_coefficient: 0.5, tangential_stiffness: 1e8}"));
  EXPECT_EQ(resolved(with_friction), with_friction);
  EXPECT_NE(with_friction, text);
}

TEST(Resolved, DoesNotDependOnTheDirectory) {
  const testing::TemporaryDirectory one;
  const testing::TemporaryDirectory two;
  const std::string scene = edited(kScene, "sphere: {radius_mm: 5}", "mesh: mesh.obj");
  for (const testing::TemporaryDirectory* directory : {&one, &two}) {
    directory->write("mesh.obj", kMeshText);
    directory->write("scene.yaml", scene);
  }
  const std::string expected = loadScene(one.path() / "scene.yaml").resolved;
  EXPECT_EQ(loadScene(two.path() / "scene.yaml").resolved, expected);
  EXPECT_EQ(expected.find(one.path().string()), std::string::npos);
  const WorkingDirectory inside(one.path());
  EXPECT_EQ(loadScene("scene.yaml").resolved, expected);
  EXPECT_EQ(loadScene("./../" + one.path().filename().string() + "/scene.yaml").resolved, expected);
}

TEST(Resolved, DoesNotDependOnWhereSensorAndMeshAre) {
  const testing::TemporaryDirectory directory;
  directory.write("deep/down/mesh.obj", kMeshText);
  directory.write("mesh.obj", kMeshText);
  const std::string text(kScene);
  const std::size_t begin = text.find("sensor:\n") + std::string_view("sensor:\n").size();
  std::string block = text.substr(begin, text.find("robot:") - begin);
  std::string sensor = "format_version: 1\n";
  for (std::size_t at = 0; at < block.size();) {
    const std::size_t end = block.find('\n', at) + 1;
    sensor += block.substr(at + 2, end - at - 2);
    at = end;
  }
  directory.write("sensors/s.yaml", sensor);
  const std::string with_file = text.substr(0, text.find("sensor:")) + "sensor: sensors/s.yaml\n" + text.substr(text.find("robot:"));
  EXPECT_EQ(loadScene(directory.write("a.yaml", with_file)).resolved, resolved(kScene));

  const auto with_mesh = [&](const std::string& mesh) {
    return loadScene(directory.write("b.yaml", edited(kScene, "sphere: {radius_mm: 5}", "mesh: " + mesh))).resolved;
  };
  EXPECT_EQ(with_mesh("mesh.obj"), with_mesh("deep/down/mesh.obj"));
}

TEST(Resolved, HasTheHashOfAMesh) {
  const testing::TemporaryDirectory directory;
  const std::filesystem::path file = directory.write("scene.yaml", edited(kScene, "sphere: {radius_mm: 5}", "mesh: mesh.obj"));
  directory.write("mesh.obj", kMeshText);
  const std::string before = loadScene(file).resolved;
  // The output of sha256sum for kMeshText.
  EXPECT_THAT(before, ::testing::HasSubstr("sha256: \"af72715adabcffe1822c22ec53986be67d1430b62f4f8ff6cd0e5f329e8ada39\""));
  directory.write("resolved.yaml", before);
  EXPECT_EQ(loadScene(directory.path() / "resolved.yaml").resolved, before);
  std::string commented(kMeshText);
  commented += "# a comment\n";
  directory.write("mesh.obj", commented);
  EXPECT_NE(loadScene(file).resolved, before);
  EXPECT_THAT(refusal(directory.path() / "resolved.yaml", [&] { loadScene(directory.path() / "resolved.yaml"); }),
              ::testing::HasSubstr("not the SHA-256 of"));
}

TEST(Resolved, HasTheDepthErrorOfSimplifiedMeshes) {
  const testing::TemporaryDirectory directory;
  directory.write("mesh.obj", kMeshText);
  const auto with = [&](const std::string& setting) {
    return loadScene(directory.write("scene.yaml", edited(kScene, "sphere: {radius_mm: 5}", "mesh: mesh.obj" + setting))).resolved;
  };
  EXPECT_THAT(with(""), ::testing::HasSubstr("\n    max_depth_error: 1e-05\n"));
  EXPECT_EQ(with("\n    max_depth_error_mm: 0.01"), with(""));
  EXPECT_THAT(with("\n    max_depth_error_mm: 0.02"), ::testing::HasSubstr("\n    max_depth_error: 2e-05\n"));
  EXPECT_THAT(with("\n    max_depth_error: 0"), ::testing::HasSubstr("\n    max_depth_error: 0\n"));
  const std::string text = with("\n    max_depth_error_mm: 0.02");
  EXPECT_EQ(loadScene(directory.write("resolved.yaml", text)).resolved, text);
  EXPECT_THAT(resolved(kScene), ::testing::Not(::testing::HasSubstr("max_depth_error")));
}

TEST(Resolved, DoesNotDependOnTheLocale) {
  const std::string expected = resolved(kScene);
  const std::string before = std::setlocale(LC_ALL, nullptr);
  for (const char* name : {"de_DE.UTF-8", "C.UTF-8", "C"}) {
    std::setlocale(LC_ALL, name);
    EXPECT_EQ(resolved(kScene), expected) << name;
  }
  std::setlocale(LC_ALL, before.c_str());
}

TEST(Resolved, DoesNotDependOnSpelling) {
  const std::string expected = resolved(kScene);
  const std::vector<std::pair<std::string_view, std::string_view>> same = {
      {"pitch_mm: 3.4", "pitch: 0.0034"},
      {"pitch_mm: 3.4", "pitch: [0.0034, 3.4e-3]"},
      {"{counts_per_newton: 2400}", "{coefficients: [2.4e3]}"},
      {"weight: 2", "weight: +2.0"},
      {"x_mm: [-2, 2]", "x: [-0.002, 0.002]"},
      {"x_mm: [-2, 2]", "x_mm: [-2, 2]\n  y: -0"},
      {"yaw_deg: 30", "yaw_deg: [30, 30]"},
      {"{rotation: [1, 0, 0, 0]}", "{}"},
      {"[tactile_image, features]", "[features, tactile_image]"},
      {"name: small_scene", "name: \"small_scene\"  # a comment"},
      {"load: [0.5, 5]", "load: [0.5,\n    5.0]\n  gain: 1"},
      {"randomization:", "randomisation:"},
  };
  for (const auto& [from, to] : same) EXPECT_EQ(resolved(edited(kScene, from, to)), expected) << to;
}

using Edits = std::vector<std::pair<std::string_view, std::string_view>>;

// All edits of kScene give different texts.
void expectDistinct(const Edits& edits) {
  std::set<std::string> texts = {resolved(kScene)};
  for (const auto& [from, to] : edits) EXPECT_TRUE(texts.insert(resolved(edited(kScene, from, to))).second) << to;
}

TEST(Resolved, HasEverySettingOfTheSensor) {
  expectDistinct({
      {"name: small_scene", "name: other"},
      {"name: small\n", "name: tiny\n"},
      {"num_rows: 3", "num_rows: 4"},
      {"num_cols: 4", "num_cols: 5"},
      {"pitch_mm: 3.4", "pitch_mm: 3.5"},
      {"pitch_mm: 3.4", "pitch_mm: [3.4, 3.5]"},
      {"  pitch_mm: 3.4\n", "  pitch_mm: 3.4\n  pose: {position_mm: [1, 0, 0]}\n"},
      {"  pitch_mm: 3.4\n", "  pitch_mm: 3.4\n  pose: {rpy_deg: [1, 0, 0]}\n"},
      {"  pitch_mm: 3.4\n", "  pitch_mm: 3.4\n  samples_per_taxel: 5\n"},
      {"  pitch_mm: 3.4\n", "  pitch_mm: 3.4\n  depth_sampling: area\n"},
      {"  pitch_mm: 3.4\n", "  pitch_mm: 3.4\n  frame_rate: 50\n"},
      {"thickness_mm: 2", "thickness_mm: 3"},
      {"1.73e8", "1.73000000000001e8"},
      {"1.73e8}", "1.73e8, normal_exponent: 2}"},
      {"1.73e8}", "1.73e8, normal_damping: 1}"},
      {"1.73e8}", "1.73e8, relaxation: [{fraction: 0.1, time: 1}]}"},
      {"1.73e8}", "1.73e8, relaxation: [{fraction: 0.1, time: 1}, {fraction: 0.1, time: 8}]}"},
      {"sigma: 0.5", "sigma: 0.6"},
      {"size: 3", "size: 5"},
      {"size: 3}}", "size: 3}, normalization: none}"},
      {"{gaussian: {sigma: 0.5, size: 3}}", "{kernel: [[2]]}"},
      {"counts_per_newton: 2400", "counts_per_newton: 2401"},
      {"counts_per_newton: 2400", "coefficients: [2400, 1]"},
      {"counts_per_newton: 2400", "points: [[0.5, 1200], [1, 2400]]"},
      {"counts_per_newton: 2400", "points: [[0.5, 1200], [1, 2401]]"},
  });
}

TEST(Resolved, HasEverySettingOfTheReadout) {
  expectDistinct({
      {"trigger: 0.02", "trigger: 0.03"},
      {"trigger: 0.02", "trigger: 0.02\n    output_scale: 1.5"},
      {"trigger: 0.02", "trigger: 0.02\n    adc_bits: 13"},
      {"trigger: 0.02", "trigger: 0.02\n    saturation: 4000"},
      {"trigger: 0.02", "trigger: 0.02\n    noise: 1"},
      {"trigger: 0.02", "trigger: 0.02\n    taxel_gain: [1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 2]"},
      {"trigger: 0.02", "trigger: 0.02\n    taxel_trigger: [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0.1]"},
      {"trigger: 0.02", "trigger: 0.02\n    hysteresis_strength: 0.1\n    hysteresis_width: 0.2"},
      {"trigger: 0.02", "trigger: 0.02\n    hysteresis_strength: [0.1, 0.2]\n    hysteresis_width: [0.2, 0.3]"},
      {"trigger: 0.02", "trigger: 0.02\n    creep: [{fraction: 0.1, time: 1}]"},
      {"trigger: 0.02", "trigger: 0.02\n    creep: [{fraction: 0.1, time: 1}, {fraction: 0.1, time: 8}]"},
      {"trigger: 0.02", "trigger: 0.02\n    low_pass_time: 0.1"},
      {"trigger: 0.02", "trigger: 0.02\n    delay: 0.1"},
      {"trigger: 0.02", "trigger: 0.02\n    jitter: 0.001\n  frame_rate: 50"},
      {"trigger: 0.02", "trigger: 0.02\n    bias: 1"},
      {"trigger: 0.02", "trigger: 0.02\n    random_walk: 1"},
      {"trigger: 0.02", "trigger: 0.02\n    gain_spread: 0.1"},
      {"trigger: 0.02", "trigger: 0.02\n    press_gain_spread: 0.1"},
      {"trigger: 0.02", "trigger: 0.02\n    dead_taxel_probability: 0.1"},
  });
}

TEST(Resolved, HasEverySettingOfObjectsAndEpisodes) {
  expectDistinct({
      {"free_flying: {}", "pan_tilt: {}"},
      {"free_flying: {}", "pan_tilt: {base: {position_mm: [1, 2, 4]}}"},
      {"radius_mm: 5", "radius_mm: 6"},
      {"sphere: {radius_mm: 5}", "capsule: {radius_mm: 5, length: 0}"},
      {"weight: 2", "weight: 3"},
      {"weight: 2", "weight: 2\n    name: ball"},
      {"length_mm: 40", "length_mm: 41"},
      {"rotation: [1, 0, 0, 0]", "rotation: [0, 1, 0, 0]"},
      {"num_steps: 20", "num_steps: 21"},
      {"simulation_rate: 100", "simulation_rate: 200"},
      {"control_rate: 50", "control_rate: 100"},
      {"x_mm: [-2, 2]", "x_mm: [-2, 3]"},
      {"x_mm: [-2, 2]", "y_mm: [-2, 2]"},
      {"yaw_deg: 30", "yaw_deg: 31"},
      {"yaw_deg: 30", "yaw_deg: 30\n  tilt_deg: 1"},
      {"yaw_deg: 30", "yaw_deg: 30\n  gain: [1, 1.1]"},
      {"yaw_deg: 30", "yaw_deg: 30\n  gain_spread: 0.1"},
      {"yaw_deg: 30", "yaw_deg: 30\n  noise: 1"},
      {"load: [0.5, 5]", "load: [0.5, 6]"},
      {"load: [0.5, 5]", "depth: [0.5, 0.6]"},
  });
}

TEST(Resolved, HasEverySettingOfControllersAndDataSet) {
  expectDistinct({
      {"kp: 0.78", "kp: 0.79"},
      {"kp: 0.78", "kp: 0.78, ki: 0.1"},
      {"kp: 0.78", "kp: 0.78, kd: 0.1"},
      {"kp: 0.78", "kp: 0.78, reference: 1"},
      {"kp: 0.78", "kp: 0.78, reference: 0"},
      {"kp: 0.78", "kp: 0.78, error_limit: 1"},
      {"kp: 0.78", "kp: 0.78, integral_limit: 1"},
      {"kp: 0.78", "kp: 0.78, derivative_limit: 1"},
      {"{kp: 0.78}", "{kp: 0.78}, total_force: {kp: 1}"},
      {"{kp: 0.78}", "{kp: 0.78}, center_across: {kp: 2}"},
      {"{kp: 0.78}", "{kp: 0.78}, center_x: {kp: 2}"},
      {"{kp: 0.78}", "{kp: 0.78}, exploration_velocity: 1"},
      {"{kp: 0.78}", "{kp: 0.78}, max_angular_velocity: 2"},
      {"{kp: 0.78}", "{kp: 0.78}, max_linear_velocity: 1"},
      {"{kp: 0.78}", "{kp: 0.78}, min_confidence: 0"},
      {"[tactile_image, features]", "[tactile_image]"},
      {"seed: 7", "seed: 8"},
      {"seed: 7", "seed: 7, episodes_per_shard: 2"},
      {"seed: 7", "seed: 7, compression: 1"},
      {"seed: 7", "seed: 7, chunk_bytes: 4096"},
  });
}

TEST(Resolved, HasTheOverriddenSeed) {
  EXPECT_EQ(resolved(kScene, {.num_episodes = {}, .seed = 5}), resolved(edited(kScene, "seed: 7", "seed: 5")));
}

TEST(Resolved, HasNotTheNumberOfEpisodes) {
  EXPECT_EQ(resolved(edited(kScene, "episodes: 10", "episodes: 11")), resolved(kScene));
  EXPECT_EQ(resolved(kScene, {.num_episodes = 99, .seed = {}}), resolved(kScene));
}

TEST(Resolved, QuotesNamesThatYamlWouldReadAsOtherTypes) {
  for (const std::string_view name : {"\"yes\"", "\"1.5\"", "\"a: b\"", "\"a \\\"b\\\" \\\\ #c\"", "\"\xC3\xA9\"", "y"}) {
    const std::string text = resolved(edited(kScene, "name: small_scene", "name: " + std::string(name)));
    EXPECT_EQ(resolved(text), text) << name;
  }
}

}  // namespace
}  // namespace taxelsim
