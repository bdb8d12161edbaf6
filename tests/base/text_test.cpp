#include "base/text.h"

#include "support/test.h"
#include "taxelsim/error.h"

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

TEST(Text, OneLineEscapesControlCharacters) {
  EXPECT_EQ(oneLine("a\nb\tc\x1b[31m\x7f"), "a b c\\x1b[31m\\x7f");
  EXPECT_EQ(oneLine("C1: \xc2\x9b"
                    "31m"),
            "C1: \\xc2\\x9b31m")
      << "U+009B begins a control sequence, as ESC [";
  EXPECT_EQ(oneLine("8 bits: \x9b, cut: \xe2\x82"), "8 bits: \\x9b, cut: \\xe2\\x82") << "not UTF-8";
  EXPECT_EQ(oneLine("right to left: \xe2\x80\xae"), "right to left: \\xe2\\x80\\xae");
  EXPECT_EQ(oneLine("\xc2\xb0 \xc3\xa9 \xe2\x82\xac \xf0\x9f\x98\x80"), "\xc2\xb0 \xc3\xa9 \xe2\x82\xac \xf0\x9f\x98\x80");
  EXPECT_EQ(printable("a\nb\r\x1b"), "a\nb\\x0d\\x1b") << "keeps newlines";
}

TEST(Text, MessagesAreCutInTheMiddle) {
  const std::string whole(kMaxMessageBytes, 'a');
  EXPECT_EQ(messageLine(whole), whole);
  const std::string cut = messageLine("file.yaml: " + std::string(1000, 'a') + " is not allowed: 1 to 2");
  EXPECT_EQ(cut.size(), kMaxMessageBytes);
  EXPECT_TRUE(cut.starts_with("file.yaml: aaa"));
  EXPECT_TRUE(cut.ends_with("aaa is not allowed: 1 to 2"));
  std::string euros;
  for (int i = 0; i < 1000; ++i) euros += "\xe2\x82\xac";
  EXPECT_EQ(printable(messageLine("a" + euros)), messageLine("a" + euros)) << "cut between characters";
  EXPECT_LE(messageLine(euros).size(), kMaxMessageBytes);
}

TEST(Text, ErrorsHaveOneLineWithoutControlCharacters) {
  EXPECT_STREQ(Error(ErrorKind::kInput, "a\x1b]0;title\x07\nb").what(), "a\\x1b]0;title\\x07 b");
  EXPECT_EQ(Error("field", std::string(1000, 'a')).reason().size(), kMaxMessageBytes);
}

TEST(Text, ParseNumberRejectsAllButOneFiniteNumber) {
  double value = 0;
  for (const char* text : {"", " 1", "1 ", "1,5", "1.5.5", "nan", "inf", "1e999", "0x10", "+1"})
    EXPECT_FALSE(parseNumber(text, value)) << text;
}

}  // namespace
}  // namespace taxelsim
