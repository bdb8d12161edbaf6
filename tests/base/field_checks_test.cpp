#include "base/field_checks.h"
#include "support/test.h"

namespace taxelsim {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Settings {
  double length = 1;
  int count = 2;
  std::uint64_t seed = 3;
  std::optional<double> reference = {};
  std::array<double, 2> band{1, 2};
  double limit = kInfinity;
};

constexpr std::array kFields{
    Field<Settings>{"length[_mm]", &Settings::length, Allowed::above(0, "m")},
    Field<Settings>{"count", &Settings::count, Allowed::within(1, 4, "")},
    Field<Settings>{"seed", &Settings::seed, Allowed::within(0, 10, "")},
    Field<Settings>{"reference", &Settings::reference, Allowed::within(-1, 1, "m")},
    Field<Settings>{"band", &Settings::band, Allowed::above(0, "Hz")},
    Field<Settings>{"limit", &Settings::limit, Allowed::above(0, "N"), kUnlimited},
};

std::string errorOf(const Settings& settings) {
  try {
    checkFields("pad.", kFields, settings);
  } catch (const Error& error) {
    EXPECT_EQ(error.what(), error.field() + ": " + error.reason());
    return error.what();
  }
  return "";
}

TEST(CheckFields, AcceptsTheDefaults) {
  EXPECT_EQ(errorOf({}), "");
  EXPECT_EQ(errorOf({.seed = 10, .reference = -1, .limit = 0.5}), "");
}

TEST(CheckFields, NamesPathValueAndRangeForEveryTypeOfMember) {
  EXPECT_EQ(errorOf({.length = 0}), "pad.length: 0 is not allowed: a number > 0 m");
  EXPECT_EQ(errorOf({.length = kInfinity}), "pad.length: inf is not allowed: a number > 0 m");
  EXPECT_EQ(errorOf({.count = -1}), "pad.count: -1 is not allowed: a whole number from 1 to 4");
  EXPECT_EQ(errorOf({.count = 5}), "pad.count: 5 is not allowed: a whole number from 1 to 4");
  EXPECT_EQ(errorOf({.seed = 11}), "pad.seed: 11 is not allowed: a whole number from 0 to 10");
  EXPECT_EQ(errorOf({.reference = 2}), "pad.reference: 2 is not allowed: a number from -1 to 1 m");
  EXPECT_EQ(errorOf({.band = {1, 0}}), "pad.band[1]: 0 is not allowed: a number > 0 Hz");
  EXPECT_EQ(errorOf({.limit = 0}), "pad.limit: 0 is not allowed: a number > 0 N");
  EXPECT_EQ(errorOf({.limit = -kInfinity}), "pad.limit: -inf is not allowed: a number > 0 N");
}

TEST(CheckBelow, PrependsThePathOfTheStruct) {
  try {
    checkBelow("finger", [] { checkFields("pad.", kFields, Settings{.length = -1}); });
    ADD_FAILURE() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.field(), "finger.pad.length");
  }
}

}  // namespace
}  // namespace taxelsim
