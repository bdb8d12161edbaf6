#include "dataset/scene_difference.h"
#include "support/test.h"

namespace taxelsim::dataset {
namespace {

constexpr std::string_view kScene =
    "name: pad\n"
    "objects:\n"
    "  - name: ball\n"
    "    sphere:\n"
    "      radius: 0.01\n"
    "  - name: bar\n"
    "    cylinder:\n"
    "      radius: 0.02\n"
    "      length: 0.1\n"
    "randomization:\n"
    "  load: [0.5, 5]\n";

std::string edited(std::string_view part, std::string_view other) {
  std::string text(kScene);
  return text.replace(text.find(part), part.size(), other);
}

TEST(SceneDifference, IsEmptyForEqualScenes) {
  EXPECT_EQ(describeSceneDifference(kScene, kScene), "");
}

TEST(SceneDifference, NamesKeyPathAndBothValues) {
  EXPECT_EQ(describeSceneDifference(kScene, edited("[0.5, 5]", "[1, 5]")), "randomization.load: [0.5, 5] there, [1, 5] requested");
  EXPECT_EQ(describeSceneDifference(kScene, edited("radius: 0.02", "radius: 0.03")),
            "objects[1].cylinder.radius: 0.02 there, 0.03 requested");
  EXPECT_EQ(describeSceneDifference(kScene, edited("name: bar", "name: rod")), "objects[1].name: bar there, rod requested");
}

TEST(SceneDifference, NamesBothKeysIfTheyDiffer) {
  EXPECT_EQ(describeSceneDifference(edited("randomization", "randomisation"), kScene), "randomisation there, randomization requested");
  EXPECT_EQ(describeSceneDifference(kScene, edited("      length: 0.1\n", "")),
            "objects[1].cylinder.length: 0.1 there, randomization requested");
}

TEST(SceneDifference, NamesAdditionalLines) {
  std::string longer(kScene);
  longer += "max_regions: 4\n";
  EXPECT_EQ(describeSceneDifference(kScene, longer), "nothing more there, max_regions: 4 requested");
  EXPECT_EQ(describeSceneDifference(kScene, ""), "name: pad there, nothing more requested");
}

TEST(SceneDifference, ShortensLongValuesAroundTheDifference) {
  const std::string zeros(300, '0');
  const auto kernel = [&](char middle) { return std::string("kernel: ").append(zeros).append(1, middle).append(zeros); };
  const std::string difference = describeSceneDifference(kernel('1'), kernel('2'));
  EXPECT_LT(difference.size(), 200u);
  EXPECT_NE(difference.find("00100"), std::string::npos) << difference;
  EXPECT_NE(difference.find("00200"), std::string::npos) << difference;
}

TEST(SceneDifference, StaysOnOneLineForAnyText) {
  const std::string difference = describeSceneDifference("- \x1b[31m: :\n\n: \n", "   -\r\n");
  EXPECT_EQ(difference.find_first_of("\n\r\x1b"), std::string::npos) << difference;
}

}  // namespace
}  // namespace taxelsim::dataset
