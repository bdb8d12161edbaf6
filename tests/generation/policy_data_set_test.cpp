// Policies of the caller in generate().
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <stdexcept>

#include "episodes/example_scene.h"
#include "taxelsim/error.h"
#include "taxelsim/generate.h"

namespace taxelsim {
namespace {

using testing::HasSubstr;

// Presses and turns by its reading.
Policy policyWithId(const std::string& id) {
  Policy policy{.name = "press", .id = id};
  policy.act = [](const PolicyInput& input, std::span<Twist> twists) {
    for (const int i : input.instances) {
      const auto row = static_cast<std::size_t>(i);
      twists[row] = {.v = {0, 0, 1e-3 * (2 - input.view.frame.total_force[row])}, .w = {0, 0, input.view.frame.edge_angle[row]}};
    }
  };
  return policy;
}

std::string contentOf(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

GenerateOptions options(const Policy& policy, int batch_size, int num_slices) {
  return {.batch_size = batch_size, .num_slices = num_slices, .on_progress = {}, .stop = nullptr, .policy = policy};
}

void expectSameShards(const std::filesystem::path& a, const std::filesystem::path& b) {
  for (int shard = 0; shard < 5; ++shard) {
    const std::string name = "shard-00000" + std::to_string(shard) + ".h5";
    EXPECT_TRUE(contentOf(a / name) == contentOf(b / name)) << name;
  }
}

TEST(GeneratePolicy, ActsInsteadOfTheControllers) {
  const Scene scene = exampleScene();
  const Device device = Device::open();
  const TestDirectory directory;
  ASSERT_TRUE(generate(device, scene, directory.path() / "whole", options(policyWithId("abc"), 23, 1)).complete);
  ASSERT_TRUE(generate(device, scene, directory.path() / "cut", options(policyWithId("abc"), 4, 2)).complete);
  expectSameShards(directory.path() / "whole", directory.path() / "cut");

  const DatasetReader reader(directory.path() / "whole");
  EXPECT_EQ(reader.manifest().policy, "abc");
  EXPECT_THAT(reader.readAsDouble("meta/controller", 0, scene.num_episodes), testing::Each(-1.0));
  EXPECT_THAT(reader.readAsText("meta/controller_name", 0, scene.num_episodes), testing::Each(""));
  const std::vector<double> force = reader.readAsDouble("data/total_force", 0, reader.numFrames());
  const std::vector<double> angle = reader.readAsDouble("data/edge_angle", 0, reader.numFrames());
  const std::vector<double> action = reader.readAsDouble("data/action", 0, reader.numFrames());
  for (std::size_t row = 0; row < reader.numFrames(); ++row) {
    const std::size_t tick = row - row % 7 % 2;  // 7 frames per episode, a tick in every second one
    EXPECT_NEAR(action[6 * row + 2], 1e-3 * (2 - force[tick]), 1e-9) << row;
    EXPECT_NEAR(action[6 * row + 5], angle[tick], 1e-6) << row;
  }
}

TEST(GeneratePolicy, AnotherPolicyDoesNotResume) {
  const Scene scene = exampleScene();
  const Device device = Device::open();
  const TestDirectory directory;
  const auto refusal = [&](const GenerateOptions& requested, const char* folder) {
    try {
      generate(device, scene, directory.path() / folder, requested);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kInput);
      return std::string(error.what());
    }
    return std::string("no refusal");
  };
  ASSERT_TRUE(generate(device, scene, directory.path() / "policy", options(policyWithId("abc"), 23, 1)).complete);
  EXPECT_THAT(refusal(options(policyWithId("def"), 23, 1), "policy"),
              HasSubstr("holds a data set with another policy (abc there, def requested): choose another directory"));
  const GenerateOptions none{.on_progress = {}, .stop = nullptr};
  EXPECT_THAT(refusal(none, "policy"), HasSubstr("another policy (abc there, none requested)"));
  EXPECT_EQ(refusal(options(policyWithId("abc"), 23, 1), "policy"), "no refusal");
  EXPECT_THAT(refusal(options(policyWithId(""), 23, 1), "empty"), HasSubstr("policy press: the id is empty, which a data set needs"));
  EXPECT_FALSE(std::filesystem::exists(directory.path() / "empty"));
}

TEST(GeneratePolicy, ExceptionsKeepCompleteShards) {
  const Scene scene = exampleScene();
  const Device device = Device::open();
  const TestDirectory directory;
  Policy policy = policyWithId("abc");
  ASSERT_TRUE(generate(device, scene, directory.path() / "whole", options(policy, 23, 1)).complete);
  Policy broken = policy;
  broken.act = [&](const PolicyInput& input, std::span<Twist> twists) {
    if (input.view.episodes[0] == 15) throw std::runtime_error("out of memory");
    policy.act(input, twists);
  };
  EXPECT_THROW(generate(device, scene, directory.path() / "cut", options(broken, 5, 1)), std::runtime_error);
  EXPECT_TRUE(std::filesystem::exists(directory.path() / "cut" / "shard-000000.h5"));
  EXPECT_FALSE(std::filesystem::exists(directory.path() / "cut" / "shard-000003.h5"));
  const GenerateResult resumed = generate(device, scene, directory.path() / "cut", options(policy, 5, 1));
  EXPECT_TRUE(resumed.complete);
  EXPECT_GE(resumed.progress.episodes_resumed, 5u);
  expectSameShards(directory.path() / "whole", directory.path() / "cut");
}

}  // namespace
}  // namespace taxelsim
