// Policies of the caller in generate().
#include "episodes/example_scene.h"
#include "support/input_error.h"
#include "support/test.h"
#include "taxelsim/error.h"
#include "taxelsim/generate.h"

namespace taxelsim {
namespace {

using ::testing::HasSubstr;

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

GenerateOptions options(const Policy& policy, int batch_size, int num_slices) {
  return {.batch_size = batch_size, .num_slices = num_slices, .on_progress = {}, .stop = nullptr, .policy = policy};
}

void expectSameShards(const std::filesystem::path& a, const std::filesystem::path& b) {
  for (int shard = 0; shard < 5; ++shard) {
    const std::string name = "shard-00000" + std::to_string(shard) + ".h5";
    EXPECT_TRUE(testing::contentOf(a / name) == testing::contentOf(b / name)) << name;
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
  EXPECT_THAT(reader.readAsDouble("meta/controller", 0, scene.num_episodes), ::testing::Each(-1.0));
  EXPECT_THAT(reader.readAsText("meta/controller_name", 0, scene.num_episodes), ::testing::Each(""));
  const std::vector<double> force = reader.readAsDouble("data/total_force", 0, reader.numFrames());
  const std::vector<double> angle = reader.readAsDouble("data/edge_angle", 0, reader.numFrames());
  const std::vector<double> action = reader.readAsDouble("data/action", 0, reader.numFrames());
  for (std::size_t row = 0; row < reader.numFrames(); ++row) {
    const std::size_t tick = row - row % 7 % 2;  // 7 frames per episode, a tick in every second one
    EXPECT_NEAR(action[6 * row + 2], 1e-3 * (2 - force[tick]), 1e-9) << row;
    EXPECT_NEAR(action[6 * row + 5], angle[tick], 1e-6) << row;
  }
}

// The rows of contact features that a policy observes are those that the data set records.
TEST(GeneratePolicy, RefusesAnotherNumberOfRegionsThanTheScene) {
  const TestDirectory directory;
  Policy policy = policyWithId("abc");
  policy.outputs.contact_features = true;
  policy.max_regions = 1;
  EXPECT_THAT(support::inputError([&] { generate(Device::open(), exampleScene(), directory.path() / "d", options(policy, 4, 1)); }),
              HasSubstr("policy press: max_regions: 1 is not allowed: the scene records contact features with 2"));
  EXPECT_FALSE(std::filesystem::exists(directory.path() / "d/shard-000000.h5"));
}

// Every row of the columns in `part` must be that of the same episode in `whole`.
void expectRowsOf(const DatasetReader& whole, const DatasetReader& part, const std::vector<std::uint64_t>& episodes) {
  const std::uint64_t num_frames = whole.numFrames() / whole.numEpisodes();
  for (const Column& column : whole.manifest().columns) {
    const std::uint64_t rows = column.per_episode ? 1 : num_frames;
    for (std::size_t k = 0; k < episodes.size(); ++k) {
      EXPECT_TRUE(part.read(column.name, k * rows, rows) == whole.read(column.name, episodes[k] * rows, rows)) << column.name << ", " << k;
    }
  }
}

TEST(GenerateEpisodes, HaveTheRowsOfTheWholeDataSet) {
  Scene scene = exampleScene();
  scene.task = Task{.hold = 0.02};
  (*scene.task)[TaskMeasure::kTotalForce] = TaskCriterion{.tolerance = 0.3};
  const Device device = Device::open();
  const TestDirectory directory;
  const std::vector<std::uint64_t> episodes{21, 3, 0, 14, 15, 16, 8};  // two shards; more than the batch
  for (const bool has_policy : {true, false}) {
    GenerateOptions requested = options(policyWithId("abc"), 5, 2);
    if (!has_policy) requested.policy.reset();
    const std::filesystem::path folder = directory.path() / (has_policy ? "policy" : "servo");
    ASSERT_TRUE(generate(device, scene, folder / "whole", requested).complete);
    requested.episodes = episodes;
    const GenerateResult result = generate(device, scene, folder / "part", requested);
    ASSERT_TRUE(result.complete);
    EXPECT_EQ(result.progress.num_episodes, 7u);
    const DatasetReader whole(folder / "whole"), part(folder / "part");
    EXPECT_EQ(part.manifest().episodes, episodes);
    ASSERT_EQ(part.numEpisodes(), 7u);
    expectRowsOf(whole, part, episodes);
    EXPECT_THAT(part.readAsDouble("meta/episode", 0, 7), ::testing::ElementsAre(21, 3, 0, 14, 15, 16, 8));
    EXPECT_EQ(generate(device, scene, folder / "part", requested).progress.episodes_resumed, 7u);
  }
}

TEST(GenerateEpisodes, RefusesOtherEpisodesOnResumeAndTwiceTheSame) {
  const Scene scene = exampleScene();
  const Device device = Device::open();
  const TestDirectory directory;
  const auto refusal = [&](std::vector<std::uint64_t> episodes) {
    return support::refusal([&] {
      generate(device, scene, directory.path(), {.on_progress = {}, .stop = nullptr, .policy = {}, .episodes = std::move(episodes)});
    });
  };
  EXPECT_EQ(refusal({4, 9, 4}), "episodes: 4 found twice");
  EXPECT_FALSE(std::filesystem::exists(directory.path()));
  EXPECT_EQ(refusal({4, 9}), "no refusal");
  EXPECT_EQ(refusal({4, 9}), "no refusal");
  for (const std::vector<std::uint64_t>& other : {std::vector<std::uint64_t>{9, 4}, {4, 9, 2}, {}}) {
    EXPECT_THAT(refusal(other), HasSubstr("holds a data set of other episodes: choose another directory"));
  }
}

TEST(GeneratePolicy, AnotherPolicyDoesNotResume) {
  const Scene scene = exampleScene();
  const Device device = Device::open();
  const TestDirectory directory;
  const auto refusal = [&](const GenerateOptions& requested, const char* folder) {
    return support::refusal([&] { generate(device, scene, directory.path() / folder, requested); });
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
