// Checks of files before keys are read: invalid YAML, and YAML that would exhaust time or memory.
#include "base/yaml_parse.h"
#include "scene_text.h"
#include "support/test.h"
#include "taxelsim/scene.h"

namespace taxelsim {
namespace {

std::string parseRefusal(const std::string& text) {
  return refusal("x.yaml", [&] { parseYaml(text, "x.yaml"); });
}

std::string repeated(std::string_view piece, std::size_t count) {
  std::string text;
  for (std::size_t i = 0; i < count; ++i) text += piece;
  return text;
}

TEST(ReadYamlFile, RejectsOtherThanRegularFiles) {
  const testing::TemporaryDirectory directory;
  const std::filesystem::path missing = directory.path() / "missing.yaml";
  EXPECT_EQ(refusal(missing, [&] { loadScene(missing); }), ": no such file");
  EXPECT_EQ(refusal(directory.path(), [&] { loadScene(directory.path()); }), ": a directory, not a file");
  EXPECT_EQ(refusal(directory.path(), [&] { loadSensor(directory.path()); }), ": a directory, not a file");
  EXPECT_EQ(refusal("/dev/zero", [&] { loadScene("/dev/zero"); }), ": not a regular file");
}

TEST(ReadYamlFile, RejectsLargeFilesBeforeReading) {
  const testing::TemporaryDirectory directory;
  const std::filesystem::path file = directory.write("large.yaml", "");
  std::filesystem::resize_file(file, kMaxYamlBytes + 1);
  EXPECT_EQ(refusal(file, [&] { loadScene(file); }), ": 16777217 bytes are too many: at most 16777216");
}

TEST(ParseYaml, RejectsBytesThatAreNotText) {
  EXPECT_EQ(parseRefusal(""), ":1:1: the file is empty");
  EXPECT_EQ(parseRefusal("# only a comment\n"), ":1:1: the file is empty");
  EXPECT_EQ(parseRefusal(std::string("a: 1\nb\0: 2", 10)), ":2:2: not a YAML file: control character 0");
  EXPECT_EQ(parseRefusal("a: \xFF\xFE"), ":1:4: not a YAML file: the text is not UTF-8");
  EXPECT_EQ(parseRefusal("a: \xC0\xAF"), ":1:4: not a YAML file: the text is not UTF-8");
  EXPECT_EQ(parseRefusal("a: \xED\xA0\x80"), ":1:4: not a YAML file: the text is not UTF-8");
  EXPECT_EQ(parseRefusal("a: b: c"), ":1:5: not YAML: illegal map value");
  EXPECT_EQ(parseRefusal("a:\n\tb: 1"), ":2:1: a tab before the text of a line: indent with spaces");
  EXPECT_THAT(parseRefusal("a: [1, 2"), ::testing::StartsWith(":1:1: not YAML: "));
  EXPECT_THAT(parseRefusal("a: \"open"), ::testing::StartsWith(":1:9: not YAML: "));
}

TEST(ParseYaml, RejectsAnchorsAliasesAndTags) {
  EXPECT_THAT(parseRefusal("a: &x [1, 1]\nb: [*x, *x]"), ::testing::StartsWith(":1:4: an anchor"));
  EXPECT_THAT(parseRefusal("a: &x 1"), ::testing::StartsWith(":1:4: an anchor"));
  EXPECT_THAT(parseRefusal("a: !!binary x"), ::testing::StartsWith(":1:4: a tag"));
  EXPECT_THAT(parseRefusal("a: 1\n---\nb: 1"), ::testing::StartsWith(":2:1: a second document"));
  EXPECT_EQ(parseRefusal(std::string("[").append(repeated("1,", kMaxYamlNodes + 1)).append("]")),
            ":1:2000000: more than 1000000 values in one file");
}

TEST(ParseYaml, RejectsDeepNestingInEveryForm) {
  constexpr std::size_t kDeep = 10'000;  // overflows the stack of a recursive parser
  const std::string expected = "nested deeper than 64 levels";
  EXPECT_THAT(parseRefusal(repeated("[", kDeep) + repeated("]", kDeep)), ::testing::HasSubstr(expected));
  EXPECT_THAT(parseRefusal(repeated("[a: ", kDeep) + repeated("]", kDeep)), ::testing::HasSubstr(expected));
  EXPECT_THAT(parseRefusal(repeated("- ", kDeep) + "1"), ::testing::HasSubstr(expected));
  EXPECT_THAT(parseRefusal(repeated("{a: ", kDeep) + "1" + repeated("}", kDeep)), ::testing::HasSubstr(expected));
  // Without their closing brackets yaml-cpp takes these for keys.
  EXPECT_EQ(parseRefusal(repeated("[", kDeep)), ":1:1: a key must be a word");
  EXPECT_EQ(parseRefusal(repeated("[a: ", kDeep)), ":1:1: a key must be a word");
  EXPECT_EQ(parseRefusal(repeated("{", kDeep)), ":1:1: a key must be a word");
  EXPECT_EQ(parseRefusal(repeated("? ", kDeep)), ":1:3: a key must be a word");
  std::string block;
  for (std::size_t i = 0; i < 2000; ++i) block += std::string(i, ' ') + "a:\n";
  EXPECT_THAT(parseRefusal(block), ::testing::HasSubstr(expected));
}

TEST(ParseYaml, AcceptsSixtyFourLevels) {
  EXPECT_EQ(parseRefusal(repeated("[", kMaxYamlDepth) + repeated("]", kMaxYamlDepth)), "was accepted");
  EXPECT_NE(parseRefusal(repeated("[", kMaxYamlDepth + 1) + repeated("]", kMaxYamlDepth + 1)), "was accepted");
}

TEST(ParseYaml, RejectsDuplicateKeys) {
  EXPECT_EQ(parseRefusal("a: 1\nb: 2\na: 3"), ":3:1: duplicate key 'a': already given on line 1");
  EXPECT_EQ(parseRefusal("[a]: 1"), ":1:1: a key must be a word");
  EXPECT_EQ(parseRefusal("~: 1"), ":1:1: a key must be a word");
}

TEST(ParseYaml, HasPositionsOfKeysAndValues) {
  const YamlTree tree = parseYaml("a: 1\nb:\n  - x\n  - \"2\"\nc:\n", "x.yaml");
  ASSERT_EQ(tree.kind, YamlTree::Kind::kMap);
  ASSERT_EQ(tree.keys.size(), 3u);
  EXPECT_EQ(tree.keys[1].text, "b");
  EXPECT_EQ(tree.keys[1].line, 2);
  EXPECT_EQ(tree.keys[1].column, 1);
  ASSERT_EQ(tree.children[1].children.size(), 2u);
  const YamlTree& quoted = tree.children[1].children[1];
  EXPECT_EQ(quoted.text, "2");
  EXPECT_TRUE(quoted.quoted);
  EXPECT_FALSE(tree.children[1].children[0].quoted);
  EXPECT_EQ(quoted.line, 4);
  EXPECT_EQ(quoted.column, 5);
  EXPECT_EQ(tree.children[2].kind, YamlTree::Kind::kNull);
}

TEST(ParseYaml, AcceptsByteOrderMarkAndWindowsLines) {
  const YamlTree tree = parseYaml(
      "\xEF\xBB\xBF"
      "a: 1\r\nb: x y\r\n",
      "x.yaml");
  ASSERT_EQ(tree.keys.size(), 2u);
  EXPECT_EQ(tree.children[0].text, "1");
  EXPECT_EQ(tree.children[1].text, "x y");
  EXPECT_EQ(tree.keys[1].line, 2);
  EXPECT_EQ(tree.keys[1].column, 1);
}

}  // namespace
}  // namespace taxelsim
