// Mutated scenes: each either loads or is refused with a message of one line; no crash, no hang. This oracle is weak, because it accepts
// both outcomes. Therefore the canonical text of a scene that loads must also load, and give the same canonical text.
// Must follow gtest.h: it uses its macros.
#include "scene_text.h"
#include "support/test.h"
#include "taxelsim/scene.h"

namespace taxelsim {
namespace {

void loadOrRefuse(const testing::TemporaryDirectory& directory, const std::string& text) {
  const std::filesystem::path file = directory.write("scene.yaml", text);
  std::string resolved;
  try {
    resolved = loadScene(file).resolved;
  } catch (const Error& error) {
    const std::string message = error.what();
    RC_ASSERT(!message.empty());
    RC_ASSERT(message.find('\n') == std::string::npos);
    RC_ASSERT(message.find(directory.path().string()) != std::string::npos);
    return;
  }
  RC_ASSERT(loadScene(directory.write("resolved.yaml", resolved)).resolved == resolved);
}

RC_GTEST_PROP(FuzzedScene, CutAnywhere, ()) {
  static const testing::TemporaryDirectory directory;
  const auto length = *rc::gen::inRange<std::size_t>(0, kScene.size());
  loadOrRefuse(directory, std::string(kScene.substr(0, length)));
}

RC_GTEST_PROP(FuzzedScene, BytesFlipped, ()) {
  static const testing::TemporaryDirectory directory;
  std::string text(kScene);
  const int count = *rc::gen::inRange(1, 4);
  for (int i = 0; i < count; ++i) {
    const auto at = *rc::gen::inRange<std::size_t>(0, text.size());
    text[at] = static_cast<char>(text[at] ^ (1 << *rc::gen::inRange(0, 8)));
  }
  loadOrRefuse(directory, text);
}

// Mutations with YAML punctuation reach more of the parser than random bytes.
RC_GTEST_PROP(FuzzedScene, PunctuationStirredIn, ()) {
  static const testing::TemporaryDirectory directory;
  static constexpr std::string_view kPunctuation = "[]{}:,-?&*!|>'\"%@`#~ \n\t\r01.eE<=";
  std::string text(kScene);
  const int count = *rc::gen::inRange(1, 6);
  for (int i = 0; i < count; ++i) {
    const auto at = *rc::gen::inRange<std::size_t>(0, text.size());
    const char c = kPunctuation[*rc::gen::inRange<std::size_t>(0, kPunctuation.size())];
    if (*rc::gen::arbitrary<bool>()) {
      text.insert(at, 1, c);
    } else {
      text[at] = c;
    }
  }
  loadOrRefuse(directory, text);
}

RC_GTEST_PROP(FuzzedScene, LinesExchangedOrLost, ()) {
  static const testing::TemporaryDirectory directory;
  std::vector<std::string> lines;
  std::istringstream stream{std::string(kScene)};
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  const auto a = *rc::gen::inRange<std::size_t>(0, lines.size());
  const auto b = *rc::gen::inRange<std::size_t>(0, lines.size());
  std::swap(lines[a], lines[b]);
  if (*rc::gen::arbitrary<bool>()) lines.erase(lines.begin() + static_cast<std::ptrdiff_t>(a));
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  loadOrRefuse(directory, text);
}

RC_GTEST_PROP(FuzzedScene, BinaryGarbage, (const std::string& text)) {
  static const testing::TemporaryDirectory directory;
  loadOrRefuse(directory, text);
}

}  // namespace
}  // namespace taxelsim
