// Numbers and units of single nodes.
#include "scene/yaml_reader.h"

#include <charconv>

#include "scene_text.h"
#include "support/test.h"

namespace taxelsim {
namespace {

double read(const std::string& text, const Allowed& allowed) {
  const std::string file = "x.yaml";
  const YamlTree tree = parseYaml(text, file);
  Canonical canonical;
  const YamlMap map(YamlNode(tree, file), {"length[_mm]", "angle[_deg]", "plain"}, canonical);
  const double value = map.number(map.has("length") ? "length" : map.has("angle") ? "angle" : "plain", allowed);
  return value;
}

double parsed(const std::string& text) {
  double value = 0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

TEST(YamlNumbers, MillimetresEqualMetresBitForBit) {
  for (int tenths = 1; tenths <= 2000; ++tenths) {
    const std::string digits = std::to_string(tenths);
    const double expected = parsed(digits + "e-4");
    EXPECT_EQ(read("length_mm: " + digits + "e-1", Allowed::any("m")), expected) << digits;
    EXPECT_EQ(read("length_mm: -" + std::to_string(tenths / 10) + "." + std::to_string(tenths % 10), Allowed::any("m")), -expected)
        << digits;
  }
}

TEST(YamlNumbers, ReadsMillimetresInEveryDecimalForm) {
  for (const char* text : {"3.4", "+3.4", "34e-1", "0.34E+1", ".034e2", "3.40000"}) {
    EXPECT_EQ(read(std::string("length_mm: ") + text, Allowed::any("m")), 0.0034) << text;
  }
  EXPECT_EQ(read("length_mm: 0e99999999999", Allowed::any("m")), 0);
  EXPECT_EQ(read("length_mm: -0", Allowed::any("m")), 0);
}

TEST(YamlNumbers, RoundDegreesReachTheirBounds) {
  constexpr double kPi = std::numbers::pi;
  for (const int degrees : {30, 45, 90, 180, 360}) {
    const double bound = degrees / 180.0 * kPi;
    const std::string text = std::to_string(degrees);
    EXPECT_LE(read("angle_deg: " + text, Allowed::within(-bound, bound, "rad")), bound);
    EXPECT_GE(read("angle_deg: -" + text, Allowed::within(-bound, bound, "rad")), -bound);
  }
  EXPECT_EQ(read("angle_deg: 180", Allowed::any("rad")), kPi);
}

TEST(YamlNumbers, ReadsDecimalForms) {
  const std::vector<std::pair<std::string, double>> forms = {{"1", 1},  {"+1", 1},     {"-1", -1},      {"1.50", 1.5}, {".5", 0.5},
                                                             {"5.", 5}, {"1e3", 1000}, {"1E-3", 0.001}, {"007", 7},    {"0", 0}};
  for (const auto& [text, value] : forms) EXPECT_EQ(read("plain: " + text, Allowed::any("")), value) << text;
  EXPECT_FALSE(std::signbit(read("plain: -0.0", Allowed::any(""))));
}

TEST(YamlNumbers, RefusesOtherText) {
  for (const char* text : {"1,5", "1_000", "0x1p3", "1 2",   "--1", "+-1",  "++1",  "1e",       "e1",  ".",        "-",   "+", "true",
                           "~",   "1e31",  "-1e31", "1e-31", "NaN", "-inf", ".inf", "Infinity", "'1'", "|\n  1\n", "[1]", "{}"}) {
    EXPECT_THROW(read(std::string("plain: ") + text, Allowed::any("")), Error) << text;
  }
}

TEST(YamlNumbers, BoundsAreAllowedUnlessExcluded) {
  EXPECT_EQ(read("plain: 2", Allowed::within(1, 2, "")), 2);
  EXPECT_EQ(read("plain: 1", Allowed::within(1, 2, "")), 1);
  EXPECT_EQ(read("plain: 0", Allowed::atLeast(0, "")), 0);
  EXPECT_THROW(read("plain: 0", Allowed::above(0, "")), Error);
  EXPECT_THROW(read("plain: 2.0000001", Allowed::within(1, 2, "")), Error);
  EXPECT_THROW(read("plain: 0.9999999", Allowed::within(1, 2, "")), Error);
}

TEST(Canonical, NumbersReadBackAsTheSameBits) {
  for (const double value : {0.1, 1.0 / 3, 1.73e8, 2.2250738585072014e-308, 1.7976931348623157e308, 123456789012345680.0}) {
    EXPECT_EQ(parsed(canonicalNumber(value)), value);
  }
  EXPECT_EQ(canonicalNumber(0.0034), "0.0034");
}

}  // namespace
}  // namespace taxelsim
