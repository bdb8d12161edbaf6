// Every fuzz target on the inputs of corpus/, the shipped files of seeds.txt, and random changes of both.
#include <glob.h>

#include "base/text.h"
#include "fuzz/targets.h"
#include "support/test.h"

namespace taxelsim::fuzz {
namespace {

namespace fs = std::filesystem;

constexpr int kNumMutations = 40;       // of one target, spread over its inputs
constexpr std::size_t kMaxSplice = 64;  // bytes that are copied, moved or removed at once

struct Input {
  std::string name;
  std::string bytes;
};

Input inputOf(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {file.string(), std::string(std::istreambuf_iterator<char>(stream), {})};
}

std::vector<Input> inputsOf(std::string_view target) {
  const fs::path root = TAXELSIM_SOURCE_DIR, corpus = root / "tests/fuzz/corpus" / target;
  std::vector<Input> inputs;
  if (fs::exists(corpus)) {
    for (const auto& entry : fs::directory_iterator(corpus)) inputs.push_back(inputOf(entry.path()));
  }
  std::ifstream seeds(root / "tests/fuzz/seeds.txt");
  for (std::string line; std::getline(seeds, line);) {
    std::istringstream words(line);
    std::string name, pattern;
    words >> name >> pattern;
    if (name != target) continue;
    glob_t found{};
    EXPECT_EQ(::glob((root / pattern).c_str(), 0, nullptr, &found), 0) << line;
    for (std::size_t i = 0; i < found.gl_pathc; ++i) inputs.push_back(inputOf(found.gl_pathv[i]));
    ::globfree(&found);
  }
  std::ranges::sort(inputs, {}, &Input::name);
  return inputs;
}

// One to four changes of bytes: a flipped bit, a byte replaced, a piece removed, a piece copied elsewhere.
std::string mutatedBytes(std::string_view input, std::mt19937& random) {
  std::string bytes(input);
  const auto below = [&](std::size_t end) { return random() % end; };
  for (std::size_t change = 1 + below(4); change > 0 && !bytes.empty(); --change) {
    const std::size_t at = below(bytes.size()), length = 1 + below(kMaxSplice);
    switch (below(4)) {
      case 0:
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(8)));
        break;
      case 1:
        bytes[at] = "0123456789-.eE,:[]{}\n\0\xff"[below(24)];
        break;
      case 2:
        bytes.erase(at, length);
        break;
      default:
        bytes.insert(below(bytes.size()), bytes.substr(at, length));
    }
  }
  return bytes;
}

class FuzzTarget : public ::testing::TestWithParam<Target> {
 protected:
  const std::vector<Input> inputs_ = inputsOf(GetParam().name);
};

TEST_P(FuzzTarget, AcceptsOrRefusesStoredInputs) {
  ASSERT_FALSE(inputs_.empty());
  for (const Input& input : inputs_) EXPECT_NO_THROW(GetParam().read(input.bytes)) << input.name;
  EXPECT_NO_THROW(GetParam().read("")) << "empty";
}

TEST_P(FuzzTarget, AcceptsOrRefusesMutations) {
  std::mt19937 random(1);
  const Mutate mutate = GetParam().mutate != nullptr ? GetParam().mutate : mutatedBytes;
  for (int i = 0; i < kNumMutations; ++i) {
    const Input& input = inputs_[random() % inputs_.size()];
    const std::string bytes = mutate(input.bytes, random);
    EXPECT_NO_THROW(GetParam().read(bytes)) << input.name << ", changed to: " << messageLine(bytes);
  }
}

INSTANTIATE_TEST_SUITE_P(All, FuzzTarget, ::testing::ValuesIn(allTargets()),
                         [](const auto& target) { return std::string(target.param.name); });

}  // namespace
}  // namespace taxelsim::fuzz
