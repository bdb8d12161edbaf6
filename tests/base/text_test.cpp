#include "base/text.h"

#include <gtest/gtest.h>

#include <limits>

namespace taxelsim {
namespace {

TEST(Text, NumberTextParsesToTheSameDouble) {
  for (const double value : {0.1, 1.0 / 3, 5e-324, -2.5, std::numeric_limits<double>::max()}) {
    double parsed = 0;
    ASSERT_TRUE(parseNumber(numberText(value), parsed));
    EXPECT_EQ(parsed, value);
  }
  EXPECT_EQ(numberText(0.1), "0.1");
}

TEST(Text, OneLineReplacesControlCharacters) {
  EXPECT_EQ(oneLine("a\nb\tc\x1b[31m\x7f"), "a b c [31m ");
}

TEST(Text, ParseNumberRejectsAllButOneFiniteNumber) {
  double value = 0;
  for (const char* text : {"", " 1", "1 ", "1,5", "1.5.5", "nan", "inf", "1e999", "0x10", "+1"})
    EXPECT_FALSE(parseNumber(text, value)) << text;
}

}  // namespace
}  // namespace taxelsim
