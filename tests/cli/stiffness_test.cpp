// `stiffness`: blocks that a sensor file accepts, numbers of the library, refused options.
#include <nlohmann/json.hpp>

#include "cli/command_line.h"
#include "support/test.h"
#include "taxelsim/sensor.h"
#include "taxelsim/stiffness.h"

namespace taxelsim::testing {
namespace {

using Words = std::vector<std::string>;

const Words kPaperPin{"--pin-force", "2", "--pin-depth", "0.001", "--pin-diameter", "0.001"};

Outcome runStiffness(Words words, const Words& more = {}) {
  words.insert(words.begin(), "stiffness");
  words.insert(words.end(), more.begin(), more.end());
  return runTaxelsim(words);
}

Outcome runAtTwoMillimetres(Words words) {
  return runStiffness(std::move(words), {"--thickness", "0.002"});
}

// A sensor file without its skin.
const std::string kPad =
    "format_version: 1\nname: pad\nnum_rows: 4\nnum_cols: 4\npitch_mm: 4\nreadout: {curve: {counts_per_newton: 1000}}\npsf: {kernel: "
    "[[1]]}\n";

// The YAML documents of the output, which begins with a comment.
Words documentsOf(const std::string& text) {
  Words documents;
  for (std::size_t begin = text.find("---\n"); begin != std::string::npos;) {
    const std::size_t end = text.find("---\n", begin + 4);
    documents.push_back(text.substr(begin + 4, end - begin - 4));
    begin = end;
  }
  return documents;
}

Skin skinOf(const std::string& document) {
  const TemporaryDirectory root;
  const std::string file = root / "pad.yaml";
  std::ofstream(file) << kPad << document;
  return loadSensor(file).skin;
}

TEST(StiffnessCommand, PrintsABlockForEveryLaw) {
  const Outcome outcome = runAtTwoMillimetres({"--shore-a", "30", "--poisson-ratio", "0.45", "--friction-coefficient", "0.7"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  const std::vector<Skin> expected =
      skinsOf(skinStiffness({.thickness = 0.002, .poisson_ratio = 0.45, .stiffness = KnownModulus{shoreAModulus(30)}}), 0.7);
  const Words documents = documentsOf(outcome.out);
  ASSERT_EQ(documents.size(), expected.size());
  constexpr double kPrinted = 1e-5;  // six significant digits
  for (std::size_t n = 0; n < documents.size(); ++n) {
    const Skin skin = skinOf(documents[n]);
    EXPECT_EQ(skin.law.index(), n);
    EXPECT_EQ(skin.thickness, 0.002);
    EXPECT_EQ(skin.margin, expected[n].margin);
    EXPECT_EQ(skin.friction.friction_coefficient, expected[n].friction.friction_coefficient) << n;
    EXPECT_NEAR(skin.friction.tangential_stiffness, expected[n].friction.tangential_stiffness,
                kPrinted * expected[n].friction.tangential_stiffness);
    EXPECT_NEAR(pinForce(skin, 0.003, 0.001) / pinForce(expected[n], 0.003, 0.001), 1, kPrinted) << n;
  }
  // All lines before the blocks are comments.
  for (std::size_t begin = 0; outcome.out.compare(begin, 4, "---\n") != 0; begin = outcome.out.find('\n', begin) + 1) {
    ASSERT_EQ(outcome.out[begin], '#') << outcome.out.substr(begin, 80);
  }
}

TEST(StiffnessCommand, PrintsOneLaw) {
  for (const std::string law : {"winkler", "elastic_layer"}) {
    const Outcome outcome = runAtTwoMillimetres({"--youngs-modulus", "1e6", "--law", law});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const Words documents = documentsOf(outcome.out);
    ASSERT_EQ(documents.size(), 1u);
    EXPECT_NE(documents[0].find("law: " + law + "\n"), std::string::npos);
    EXPECT_NE(outcome.out.find("springs  elastic_layer"), std::string::npos) << "no predictions";
  }
}

// Figure 6b of the paper.
TEST(StiffnessCommand, PinOfThePaper) {
  const Outcome outcome = runStiffness(kPaperPin, {"--thickness", "0.002", "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const nlohmann::json json = nlohmann::json::parse(outcome.out);
  EXPECT_NEAR(json["area_stiffness"].get<double>(), 2.546e9, 1e6);
  EXPECT_NEAR(json["elastic_modulus"].get<double>(), 1.117e6, 1e3);
  ASSERT_EQ(json["pins"].size(), 3u);
  EXPECT_NEAR(json["pins"][0]["springs_pin_force"].get<double>(), 2, 1e-9);
  EXPECT_NEAR(json["pins"][0]["elastic_layer_pin_force"].get<double>(), 2, 1e-9);
  EXPECT_NEAR(json["pins"][1]["springs_pin_force"].get<double>(), 8, 1e-9);
  EXPECT_NEAR(json["hexagon"]["springs_depth"].get<double>(), 15.5e-6, 0.05e-6);
  ASSERT_EQ(json["skins"].size(), 6u);
  EXPECT_EQ(json["skins"][0]["law"], "winkler");
  EXPECT_EQ(json["skins"][0]["normal_contact_stiffness"], json["area_stiffness"]);
  EXPECT_EQ(json["skins"][3]["sensitivity"], json["area_stiffness"]);
  EXPECT_EQ(json["skins"][4]["elastic_modulus"], json["elastic_modulus"]);
  EXPECT_EQ(json["skins"][4]["iterations"], 10);
}

double areaStiffness(const Words& words) {
  const Outcome outcome = runStiffness(words, {"--thickness", "0.002", "--json"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  return outcome.status == 0 ? nlohmann::json::parse(outcome.out)["area_stiffness"].get<double>() : 0;
}

TEST(StiffnessCommand, TakesEverySource) {
  EXPECT_DOUBLE_EQ(areaStiffness({"--area-stiffness", "1.5e8"}), 1.5e8);
  EXPECT_DOUBLE_EQ(areaStiffness({"--taxel-stiffness", "2000", "--pitch", "0.002,0.004"}), 2.5e8);
  EXPECT_DOUBLE_EQ(areaStiffness({"--taxel-stiffness", "2000", "--pitch", "0.002"}), 5e8);
  EXPECT_DOUBLE_EQ(areaStiffness({"--youngs-modulus", "1e6", "--poisson-ratio", "0"}), 5e8);
  EXPECT_DOUBLE_EQ(areaStiffness({"--youngs-modulus", "1e6", "--match-pin-diameter", "0.002"}),
                   layerPinStiffness({1e6}, 0.002, 0.002) / (3.141592653589793 * 1e-6));
}

// Pins go 1 mm deep, or to the base.
TEST(StiffnessCommand, PinsInAThinSkin) {
  const Outcome outcome = runStiffness({"--youngs-modulus", "1e6", "--thickness", "0.0005", "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const nlohmann::json pin = nlohmann::json::parse(outcome.out)["pins"][1];
  EXPECT_EQ(pin["pin_depth"], 0.0005);
  EXPECT_NEAR(pin["elastic_layer_pin_force"].get<double>(), layerPinStiffness({1e6}, 0.0005, 0.002) * 0.0005, 1e-9);
}

// Deeper than the skin is thick is no depth.
TEST(StiffnessCommand, LoadOutOfReach) {
  const Outcome outcome = runAtTwoMillimetres({"--youngs-modulus", "100"});
  EXPECT_NE(outcome.out.find("out of reach"), std::string::npos);
  const Outcome json = runAtTwoMillimetres({"--youngs-modulus", "100", "--json"});
  EXPECT_TRUE(nlohmann::json::parse(json.out)["hexagon"]["elastic_layer_depth"].is_null());
}

TEST(StiffnessCommand, RefusesValues) {
  for (const char* bad : {"0", "-1", "nan", "inf"}) {
    expectRefused(runAtTwoMillimetres({"--youngs-modulus", bad}),
                  std::string("--youngs-modulus: ") + bad + " is not allowed: a number > 0 Pa");
    expectRefused(runAtTwoMillimetres({"--area-stiffness", bad}),
                  std::string("--area-stiffness: ") + bad + " is not allowed: a number > 0 N/m^3");
    expectRefused(runStiffness({"--shore-a", "30", "--thickness", bad}),
                  std::string("--thickness: ") + bad + " is not allowed: a number from");
  }
  expectRefused(runAtTwoMillimetres({"--shore-a", "10"}), "--shore-a: 10 is not allowed: a number from 20 to 90 Shore A");
  expectRefused(runAtTwoMillimetres({"--shore-a", "95"}), "--shore-a: 95 is not allowed: a number from 20 to 90 Shore A");
  for (const char* bad : {"0.5", "-0.1", "nan"}) {
    expectRefused(runAtTwoMillimetres({"--shore-a", "30", "--poisson-ratio", bad}),
                  std::string("--poisson-ratio: ") + bad + " is not allowed: a number >= 0 and < 0.5");
  }
  expectRefused(runAtTwoMillimetres({"--pin-force", "2", "--pin-depth", "0.003", "--pin-diameter", "0.001"}),
                "--pin-depth: 0.003 is not allowed: a number > 0 and <= 0.002 m, the thickness");
  expectRefused(runAtTwoMillimetres({"--shore-a", "30", "--match-pin-diameter", "1"}),
                "--match-pin-diameter: 1 is not allowed: > 0 and at most 128");
  expectRefused(runAtTwoMillimetres({"--shore-a", "30", "--friction-coefficient", "-1"}), "--friction-coefficient: -1 is not allowed");
  expectRefused(runAtTwoMillimetres({"--youngs-modulus", "5MPa"}), "--youngs-modulus: 5MPa is not a number");
  for (const char* bad : {"0", "3,x", "1,2,3", "nan", "-1,1"}) {
    expectRefused(runAtTwoMillimetres({"--taxel-stiffness", "1", std::string("--pitch=") + bad}), "--pitch");
  }
  expectRefused(runAtTwoMillimetres({"--youngs-modulus", "1e308", "--law", "lugre"}), "that follows");
  expectRefused(runAtTwoMillimetres({"--shore-a", "30", "--law", "hertz"}), "--law");
}

TEST(StiffnessCommand, RefusesCombinations) {
  expectRefused(runAtTwoMillimetres({}), "the stiffness is missing: give one of --youngs-modulus, --shore-a, --pin-force");
  expectRefused(runStiffness({"--shore-a", "30"}), "--thickness is required");
  expectRefused(runAtTwoMillimetres({"--shore-a", "30", "--youngs-modulus", "1e6"}),
                "--youngs-modulus and --shore-a: not allowed together");
  expectRefused(runStiffness(kPaperPin, {"--thickness", "0.002", "--area-stiffness", "1e8"}),
                "--pin-force and --area-stiffness: not allowed together");
  expectRefused(runAtTwoMillimetres({"--shore-a", "30", "--pin-depth", "0.001"}), "--shore-a and --pin-depth: not allowed together");
  expectRefused(runAtTwoMillimetres({"--pin-force", "2", "--pin-diameter", "0.001"}), "--pin-depth is missing: --pin-force needs it");
  expectRefused(runAtTwoMillimetres({"--pin-depth", "0.001"}), "--pin-force is missing: --pin-depth needs it");
  expectRefused(runAtTwoMillimetres({"--taxel-stiffness", "2000"}), "--pitch is missing: --taxel-stiffness needs it");
  expectRefused(runAtTwoMillimetres({"--area-stiffness", "1e8", "--pitch", "0.003"}), "--pitch: only allowed with --taxel-stiffness");
  expectRefused(runAtTwoMillimetres({"--area-stiffness", "1e8", "--match-pin-diameter", "0.003"}),
                "--match-pin-diameter: only allowed with --youngs-modulus or --shore-a");
}

}  // namespace
}  // namespace taxelsim::testing
