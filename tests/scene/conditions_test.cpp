// Conditions of a scene: what they override, what is refused.
#include "scene_text.h"
#include "support/test.h"
#include "taxelsim/scene.h"

namespace taxelsim {
namespace {

constexpr std::string_view kOtherSensor = R"(format_version: 1
name: other
num_rows: 3
num_cols: 4
pitch_mm: 3.4
skin: {thickness_mm: 1, normal_contact_stiffness: 9e8}
readout: {curve: {counts_per_newton: 100}}
)";

constexpr std::string_view kConditions = R"(conditions:
  noisy: {randomization: {noise: [3, 4], yaw: 1, depth_mm: 0.5}}
  other: {sensor: other.yaml}
)";

std::string withConditions(std::string_view conditions = kConditions) {
  return std::string(kScene) + std::string(conditions);
}

Scene loaded(const std::string& text, const std::string& condition) {
  const testing::TemporaryDirectory directory;
  directory.write("other.yaml", kOtherSensor);
  return loadScene(directory.write("scene.yaml", text), {.condition = condition});
}

std::string refusalOf(const std::string& text, const std::string& condition = "nominal") {
  const testing::TemporaryDirectory directory;
  directory.write("other.yaml", kOtherSensor);
  directory.write("wide.yaml", edited(kOtherSensor, "num_cols: 4", "num_cols: 5"));
  directory.write("fine.yaml", edited(kOtherSensor, "pitch_mm: 3.4", "pitch_mm: 3.3"));
  const std::filesystem::path file = directory.write("scene.yaml", text);
  return refusal(file, [&] { loadScene(file, {.condition = condition}); });
}

TEST(SceneConditions, NominalIsTheSceneWithoutThem) {
  const Scene plain = loaded(std::string(kScene), "nominal");
  EXPECT_TRUE(plain.conditions.empty());
  const Scene scene = loaded(withConditions(), "nominal");
  EXPECT_EQ(scene.resolved, plain.resolved);
  EXPECT_EQ(scene.condition, kNominalCondition);
  EXPECT_EQ(loaded(withConditions(), "").condition, kNominalCondition);
  EXPECT_THAT(scene.conditions, ::testing::ElementsAre("noisy", "other"));
}

TEST(SceneConditions, ReplaceSingleKeysOfTheRandomization) {
  const Scene scene = loaded(withConditions(), "noisy");
  EXPECT_EQ(scene.condition, "noisy");
  EXPECT_EQ(scene.randomization.noise.min, 3);
  EXPECT_EQ(scene.randomization.yaw.max, 1);  // instead of yaw_deg
  EXPECT_EQ(scene.randomization.depth->max, 0.0005);
  EXPECT_FALSE(scene.randomization.load);  // depth takes its place
  EXPECT_EQ(scene.randomization.x.max, 0.002);
  EXPECT_EQ(scene.sensor.name, "small");
}

TEST(SceneConditions, ReplaceTheSensor) {
  const Scene scene = loaded(withConditions(), "other");
  EXPECT_EQ(scene.sensor.name, "other");
  EXPECT_EQ(scene.randomization.load->max, 5);
}

TEST(SceneConditions, ResolvedTextIsThatOfASceneWrittenSo) {
  const Scene scene = loaded(withConditions(), "noisy");
  EXPECT_EQ(scene.resolved.find("conditions"), std::string::npos);
  const std::string written = edited(edited(kScene, "  yaw_deg: 30\n", "  yaw: 1\n"), "load: [0.5, 5]", "depth_mm: 0.5\n  noise: [3, 4]");
  EXPECT_EQ(scene.resolved, loaded(written, "nominal").resolved);
  EXPECT_EQ(loaded(scene.resolved, "nominal").resolved, scene.resolved);
}

TEST(SceneConditions, UnknownNamesAreAnsweredWithThoseThatExist) {
  EXPECT_EQ(refusalOf(withConditions(), "loud"), ": condition loud: not in this scene; it has nominal, noisy, other");
  EXPECT_EQ(refusalOf(std::string(kScene), "noisy"), ": condition noisy: not in this scene; it has nominal");
}

TEST(SceneConditions, AllAreCheckedWhicheverIsLoaded) {
  const auto refused = [](std::string_view conditions) { return refusalOf(withConditions(conditions)); };
  EXPECT_THAT(refused("conditions: [a]\n"), ::testing::StartsWith(":29:13: conditions: a list of 1 is not allowed: a mapping of names"));
  EXPECT_THAT(refused("conditions: {a: }\n"), ::testing::StartsWith(":29:14: conditions.a: nothing is not allowed"));
  EXPECT_THAT(refused("conditions: {nominal: {}}\n"),
              ::testing::HasSubstr("conditions.nominal: this name means the scene without overrides"));
  EXPECT_THAT(refused("conditions: {\"a b\": {}}\n"), ::testing::HasSubstr("a name has 1 to 40 letters, digits, _ and -"));
  EXPECT_THAT(refused("conditions: {a: {task: {}}}\n"),
              ::testing::StartsWith(":29:18: conditions.a.task: unknown key; allowed: sensor, randomization"));
  EXPECT_THAT(refused("conditions: {a: {randomization: 3}}\n"),
              ::testing::HasSubstr("conditions.a.randomization: 3 is not allowed: a mapping"));
  EXPECT_THAT(refused("conditions:\n  a:\n    randomization: {noise: -1}\n"),
              ::testing::StartsWith(":31:28: randomization.noise: -1 is not allowed"));
  EXPECT_THAT(refused("conditions: {a: {randomization: {nois: 1}}}\n"), ::testing::HasSubstr("randomization.nois: unknown key"));
  EXPECT_THAT(refused("conditions: {a: {randomization: {load: 1, depth: 0}}}\n"), ::testing::HasSubstr("conflicts with `load`"));
  EXPECT_THAT(refused("conditions: {a: {sensor: none.yaml}}\n"), ::testing::HasSubstr("none.yaml is not there, or not a file"));
  constexpr const char* kOtherTaxels = "in condition a its taxels are not those of the scene's own sensor";
  EXPECT_THAT(refused("conditions: {a: {sensor: wide.yaml}}\n"), ::testing::EndsWith(kOtherTaxels));
  EXPECT_THAT(refused("conditions: {a: {sensor: fine.yaml}}\n"), ::testing::EndsWith(kOtherTaxels));
}

TEST(SceneConditions, FormerSpellingOfTheRandomizationIsOverriddenToo) {
  const Scene scene = loaded(edited(withConditions(), "\nrandomization:", "\nrandomisation:"), "noisy");
  EXPECT_EQ(scene.randomization.noise.max, 4);
  EXPECT_EQ(scene.randomization.x.max, 0.002);
}

}  // namespace
}  // namespace taxelsim
