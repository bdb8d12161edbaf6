#include "base/allowed.h"
#include "support/test.h"

namespace taxelsim {
namespace {

TEST(Allowed, IncludesOrExcludesItsBounds) {
  EXPECT_TRUE(isAllowed(0, Allowed::within(0, 1, "")));
  EXPECT_TRUE(isAllowed(1, Allowed::within(0, 1, "")));
  EXPECT_FALSE(isAllowed(0, Allowed::aboveUpTo(0, 1, "")));
  EXPECT_TRUE(isAllowed(1, Allowed::aboveUpTo(0, 1, "")));
  const Allowed below{.min = 0, .max = 1, .below_max = true};
  EXPECT_TRUE(isAllowed(0, below));
  EXPECT_FALSE(isAllowed(1, below));
}

TEST(Allowed, ExcludesWhatIsNotFinite) {
  EXPECT_FALSE(isAllowed(std::numeric_limits<double>::quiet_NaN(), Allowed::any("")));
  EXPECT_FALSE(isAllowed(std::numeric_limits<double>::infinity(), Allowed::above(0, "")));
}

TEST(Allowed, DescribesNumbers) {
  EXPECT_EQ(describe(Allowed::any("m")), "a number m");
  EXPECT_EQ(describe(Allowed::above(0, "m")), "a number > 0 m");
  EXPECT_EQ(describe(Allowed::within(0, 1, "")), "a number from 0 to 1");
  EXPECT_EQ(describe(Allowed::aboveUpTo(0, 1, "s")), "a number > 0 and <= 1 s");
  EXPECT_EQ(describe({.min = 0, .max = 1, .below_max = true}), "a number >= 0 and < 1");
}

TEST(Allowed, DescribesWholeNumbersWithAllDigits) {
  EXPECT_EQ(describeWhole(Allowed::within(1, 1e6, "")), "a whole number from 1 to 1000000");
  EXPECT_EQ(describeWhole(Allowed::atLeast(0, "")), "a whole number from 0 to 18446744073709551615");
}

}  // namespace
}  // namespace taxelsim
